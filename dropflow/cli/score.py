"""`dropflow score`: results against ground truth."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from dropflow.scoring import Report

_TITLES = {
    "detection": "Droplets (droplets.parquet)",
    "tracked": "Droplets in trajectories (trajectories.parquet)",
    "links": "Links",
    "isbi": "Tracks (ISBI 2012)",
    "flow": "Flow",
    "sizes_before": "Size distribution before tracking",
    "sizes_after": "Size distribution after tracking",
}


def score(
    results: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Folder that analyse wrote, or one table of droplets.", show_default=False),
    ],
    truth: Annotated[Path, typer.Option("--truth", help="truth.parquet that simulate wrote.", show_default=False)],
    is_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Score results against ground truth.

    Scores what is there of droplets.parquet, trajectories.parquet and flow.zarr, and says what was missing.
    truth_flow.zarr and events.csv are looked for beside the truth.

    Example: `dropflow score results/ --truth film/truth.parquet`
    """
    # Imported here, for it takes seconds and `--help` and wrong options need none of it.
    from dropflow.scoring import score_results

    report = score_results(results, truth)
    if is_json:
        typer.echo(json.dumps(report.to_json(), indent=2))
        return
    console = Console()
    console.print(_table(report))
    if report.missing:
        console.print(f"Not there, so not scored: {', '.join(report.missing)}")


def _table(report: "Report") -> Table:
    table = Table("score", "value", title_justify="left")
    table.columns[1].justify = "right"
    scores = report.to_json()
    for part, title in _TITLES.items():
        if scores[part] is not None:
            table.add_section()
            table.add_row(f"[bold]{title}[/bold]", "")
            for name, value in _flat(scores[part]).items():
                table.add_row(name.replace("_", " "), _text(value))
    return table


def _flat(score: dict[str, Any]) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in score.items():
        if isinstance(value, dict):
            flat |= {f"{name} {key}": part for key, part in value.items()}
        else:
            flat[name] = value
    return flat


def _text(value: float | int | None) -> str:
    if value is None:
        return "-"
    return str(value) if isinstance(value, int) else f"{value:.4g}"
