"""`dropflow preview`: one frame with what is found in it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dropflow.cli.compile import say_if_not_compiled
from dropflow.cli.options import ExperimentFile, ParametersFile, Stack, frame_at
from dropflow.experiment import load_experiment
from dropflow.parameters import Parameters, load_parameters

if TYPE_CHECKING:
    from dropflow.preprocess import StackEstimate


def preview(
    stack: Stack,
    experiment: ExperimentFile,
    output: Annotated[Path, typer.Option("--output", "-o", help="PNG file to write.", show_default=False)],
    frame: Annotated[int, typer.Option("--frame", min=0, help="Which frame, counted from 0.")] = 0,
    parameters: ParametersFile = None,
    rejected: Annotated[
        bool, typer.Option("--rejected", help="Draw also what was not accepted, thin and red.")
    ] = False,
    steps: Annotated[
        Path | None, typer.Option("--steps", help="Folder for a picture of each step of preparing the frame.")
    ] = None,
    scale: Annotated[int, typer.Option("--scale", min=1, max=8, help="Enlarge the picture this many times.")] = 1,
) -> None:
    """Detect the droplets of one frame and draw them on it.

    Example: `dropflow preview frames/ --experiment experiment.yaml --frame 3 --output overlay.png`
    """
    # Imported here, for it takes seconds and `--help` and wrong options need none of it.
    from dropflow import pipeline
    from dropflow.analysis import flat_field_beside
    from dropflow.detection import make_detector
    from dropflow.detection.preview import preview as preview_of
    from dropflow.figures.overlay import draw_overlay, write_picture
    from dropflow.frames import Choice, open_frames

    film, knobs = load_experiment(experiment), load_parameters(parameters) if parameters else Parameters()
    say_if_not_compiled()
    with open_frames(stack, Choice.of(film)) as frames:
        image = frame_at(frames, frame)
        measured = pipeline.estimate(frames, film, knobs, flat_field=flat_field_beside(film, experiment.parent))
        shown = preview_of(image, make_detector(film, knobs, measured))
    found, others = shown.detection.droplets, shown.detection.rejected.droplets
    picture = draw_overlay(
        shown.frame, found, rejected=others if rejected else None, pixel_size_um=film.pixel_size_um, scale=scale
    )
    write_picture(output, picture)
    if steps is not None:
        _write_flat_field(steps, measured)
        for number, step in enumerate(shown.steps, start=1):
            picture = draw_overlay(step.image, found[:0], pixel_size_um=film.pixel_size_um)
            write_picture(steps / f"{number}-{step.name}.png", picture)
    told = ", ".join(f"{number} {reason}" for reason, number in shown.n_rejected.items()) or "none"
    typer.echo(f"{len(found)} droplets in frame {frame}; candidates not accepted: {told}")
    typer.echo(f"The picture is {output}")


def _write_flat_field(folder: Path, measured: "StackEstimate") -> None:
    """The stack's flat field, given or estimated, and the dirt in it."""
    if measured.flat_field is None:
        return
    from dropflow.droplets import Droplets
    from dropflow.figures.overlay import draw_overlay, write_picture
    from dropflow.preprocess.background import dirt_map

    dirt = dirt_map(measured.flat_field).astype("uint8")
    for name, image in (("flat_field_of_the_stack", measured.flat_field), ("dirt_map", dirt)):
        write_picture(folder / f"0-{name}.png", draw_overlay(image, Droplets.empty()))
