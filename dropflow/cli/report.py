"""`dropflow report`: all figures and numbers of an analysis on one page."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dropflow.cli.options import frame_at
from dropflow.errors import ParametersError
from dropflow.report.images import ImageFormat
from dropflow.statistics.oscillations import Signal

if TYPE_CHECKING:
    from dropflow.figures.example import Example
    from dropflow.results import Results


def report(
    results: Annotated[Path, typer.Argument(metavar="RESULTS", help="Folder of an analysis.", show_default=False)],
    output: Annotated[Path, typer.Option("--output", "-o", help="HTML file to write.")] = Path("report.html"),
    signal: Annotated[Signal, typer.Option("--signal", help="What to look for oscillations in.")] = Signal.N_DROPLETS,
    temperature_log: Annotated[
        Path | None, typer.Option("--temperature-log", help="CSV with time_s and temperature_c.")
    ] = None,
    frame: Annotated[
        int | None, typer.Option("--frame", min=0, help="Of which frame the figures of one frame are; needs --stack.")
    ] = None,
    stack: Annotated[
        Path | None,
        typer.Option("--stack", help="The frames; files that the experiment names are looked for in their folder."),
    ] = None,
    images: Annotated[Path | None, typer.Option("--images", help="Folder for each figure as a file to print.")] = None,
    image_format: Annotated[ImageFormat, typer.Option("--image-format", help="Format of these.")] = ImageFormat.SVG,
) -> None:
    """Write one self-contained page with all figures, numbers, parameters, warnings and a methods paragraph.

    Figures of one frame show the one in the middle of the film, unless --frame and --stack say which.

    Example: `dropflow report results/ -o report.html`
    """
    if (frame is None) != (stack is None):
        raise ParametersError("Give --frame and --stack together: the results keep only the frame in the middle.")
    # Imported here, for it takes seconds and `--help` and wrong options need none of it.
    from dropflow.physics.temperature_log import read_temperature_log
    from dropflow.report.page import write_report
    from dropflow.results import open_results

    opened = open_results(results)
    example = None if frame is None or stack is None else _example_of(opened, stack, frame)
    temperature = None if temperature_log is None else read_temperature_log(temperature_log)
    printed = None if images is None else (images, image_format)
    warnings = write_report(opened, output, signal=signal, temperature=temperature, images=printed, example=example)
    for text in warnings:
        typer.echo(f"warning: {text}", err=True)
    typer.echo(f"The report is in {output}")


def _example_of(results: "Results", stack: Path, frame: int) -> "Example":
    """A frame of the stack, prepared as the analysis did."""
    # Imported here, for it takes seconds and a report of the frame that was kept needs none of it.
    from dropflow import pipeline
    from dropflow.analysis import flat_field_beside
    from dropflow.detections import DropletReader
    from dropflow.figures.example import make_example
    from dropflow.frames import Choice, open_frames

    experiment, parameters = results.experiment, results.parameters
    with open_frames(stack, Choice.of(experiment)) as frames:
        image = frame_at(frames, frame)
        flat_field = flat_field_beside(experiment, stack.parent)
        measured = pipeline.estimate(frames, experiment, parameters, flat_field=flat_field)
    reader = DropletReader(results.droplets)
    try:
        return make_example(image, frame, reader(frame), experiment, parameters, measured)
    finally:
        reader.close()
