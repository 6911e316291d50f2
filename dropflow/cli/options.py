"""Options that several subcommands share."""

from pathlib import Path
from typing import Annotated

import typer

from dropflow.errors import FramesError
from dropflow.frames.contract import Frame, Frames

Stack = Annotated[
    Path,
    typer.Argument(metavar="STACK", help="Folder of images, multi-page TIFF, or ZIP of images.", show_default=False),
]
ExperimentFile = Annotated[
    Path, typer.Option("--experiment", help="experiment.yaml: what was filmed.", show_default=False)
]
ParametersFile = Annotated[
    Path | None, typer.Option("--parameters", help="YAML file with parameters; what is left out has its default.")
]
Jobs = Annotated[int | None, typer.Option("--jobs", min=1, help="Processes [default: one a processor].")]


def frame_at(frames: Frames, index: int) -> Frame:
    """The frame that an option names."""
    if index >= len(frames):
        message = f"There is no frame {index}: the stack has frames 0 to {len(frames) - 1}."
        raise FramesError(message, code="frames.no_such_frame")
    return frames[index]
