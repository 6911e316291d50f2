"""The report as one HTML file that needs nothing from outside."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

import plotly.graph_objects as go
import plotly.io
import yaml
from plotly.offline import get_plotlyjs

from dropflow.figures.example import Example
from dropflow.physics.temperature_log import TemperatureLog
from dropflow.report.frames import FrameSource
from dropflow.report.images import ImageFormat, write_images
from dropflow.report.sections import Section, sections
from dropflow.report.words import Summary, methods_of, numbers_of, parameters_of, warnings_of
from dropflow.results import Results
from dropflow.statistics.findings import Findings
from dropflow.statistics.oscillations import Signal

_STYLE = """
body{font:16px/1.5 Helvetica,Arial,sans-serif;max-width:900px;margin:2rem auto;padding:0 1rem;color:#1f2328}
h1{margin-bottom:.2rem} table{border-collapse:collapse} td,th{padding:.15rem 1rem .15rem 0;text-align:left}
th{color:#555;font-weight:400} figure{margin:2.5rem 0;overflow-x:auto} figcaption{color:#444;max-width:46rem}
.warnings{background:#fff4d6;border-left:4px solid #d55e00;padding:.6rem 1rem;margin:1rem 0} pre{overflow-x:auto;
background:#f6f8fa;padding:1rem;font-size:13px} @media print{figure{break-inside:avoid}}
"""


@dataclass(frozen=True)
class Report:
    """An analysis as a page."""

    html: str
    warnings: list[str]
    """What a reader must know before trusting the figures."""
    figures: dict[str, go.Figure]
    """By their names in the catalogue."""


def make_report(found: Findings, summary: Summary, source: FrameSource) -> Report:
    """Draw and word everything.

    Parameters
    ----------
    found
        The statistics.
    summary
        What ``summary.json`` holds.
    source
        Where the figures of single frames come from.
    """
    warnings = warnings_of(found, summary)
    made = sections(found, source)
    html = _page(found, made, warnings, numbers_of(found, summary), methods_of(found, summary))
    return Report(html, warnings, {section.key: section.figure for section in made})


def write_report(
    results: Results,
    output: Path,
    *,
    signal: Signal = Signal.N_DROPLETS,
    temperature: TemperatureLog | None = None,
    images: tuple[Path, ImageFormat] | None = None,
    example: Example | None = None,
) -> list[str]:
    """Write the report of an analysis; return its warnings. The file appears whole or not at all.

    `images` names a folder, and the format in which each figure is to be written into it as well. `example` is the
    frame to show in place of the one in the middle of the film, which the analysis kept.
    """
    found = Findings(results.facts, results.condensed, signal=signal, temperature=temperature)
    report = make_report(
        found, results.summary, FrameSource(results.trajectories, results.flow, example or results.example)
    )
    output.parent.mkdir(parents=True, exist_ok=True)
    unfinished = output.with_name(output.name + ".part")
    unfinished.write_text(report.html, encoding="utf-8")
    unfinished.replace(output)
    if images is not None:
        write_images(report.figures, *images)
    return report.warnings


def _page(found: Findings, made: Sequence[Section], said: Sequence[str], numbers: dict[str, str], methods: str) -> str:
    experiment = found.facts.experiment
    name = escape(experiment.name)
    rows = "".join(
        f"<tr><th scope=row>{escape(key)}</th><td>{escape(value)}</td></tr>" for key, value in numbers.items()
    )
    warnings = "".join(f"<li>{escape(text)}</li>" for text in said)
    block = f'<div class="warnings"><strong>Before you trust it</strong><ul>{warnings}</ul></div>' if said else ""
    links = "".join(f'<li><a href="#{one.key}">{escape(_title(one))}</a></li>' for one in made)
    document = escape(yaml.safe_dump(parameters_of(found), sort_keys=False, allow_unicode=True))
    drawn = "".join(_figure(one) for one in made)
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{name}: droplets and flow</title>'
        f'<meta name="viewport" content="width=device-width,initial-scale=1"><style>{_STYLE}</style>'
        f"<script>{get_plotlyjs()}</script></head><body><h1>{name}</h1>"
        f"<p>{escape(experiment.notes)}</p>{block}<h2>Numbers</h2><table>{rows}</table>"
        f"<h2>Methods</h2><p>{escape(methods)}</p><h2>Figures</h2><ul>{links}</ul>{drawn}"
        f"<h2>Experiment and parameters</h2><pre>{document}</pre></body></html>"
    )


def _title(section: Section) -> str:
    return str(section.figure.layout.title.text)


def _figure(section: Section) -> str:
    drawn = plotly.io.to_html(
        section.figure,
        include_plotlyjs=False,
        full_html=False,
        div_id=f"plot-{section.key}",
        config={"displaylogo": False, "toImageButtonOptions": {"format": "svg", "filename": section.key}},
    )
    return f'<figure id="{section.key}">{drawn}<figcaption>{escape(section.how)}</figcaption></figure>'
