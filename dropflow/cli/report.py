"""`dropflow report`: all figures and numbers of an analysis on one page."""

from pathlib import Path
from typing import Annotated

import typer

from dropflow.figures.static import ImageFormat
from dropflow.physics.temperature_log import read_temperature_log
from dropflow.report.page import write_report
from dropflow.results import open_results
from dropflow.statistics.oscillations import Signal


def report(
    results: Annotated[Path, typer.Argument(metavar="RESULTS", help="Folder of an analysis.", show_default=False)],
    output: Annotated[Path, typer.Option("--output", "-o", help="HTML file to write.")] = Path("report.html"),
    signal: Annotated[Signal, typer.Option("--signal", help="What to look for oscillations in.")] = Signal.N_DROPLETS,
    temperature_log: Annotated[
        Path | None, typer.Option("--temperature-log", help="CSV with time_s and temperature_c.")
    ] = None,
    images: Annotated[Path | None, typer.Option("--images", help="Folder for each figure as a file to print.")] = None,
    image_format: Annotated[ImageFormat, typer.Option("--image-format", help="Format of these.")] = ImageFormat.SVG,
) -> None:
    """Write one self-contained page with all figures, numbers, parameters, warnings and a methods paragraph.

    Example: `dropflow report results/ -o report.html`
    """
    temperature = None if temperature_log is None else read_temperature_log(temperature_log)
    printed = None if images is None else (images, image_format)
    warnings = write_report(open_results(results), output, signal=signal, temperature=temperature, images=printed)
    for text in warnings:
        typer.echo(f"warning: {text}", err=True)
    typer.echo(f"The report is in {output}")
