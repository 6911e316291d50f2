"""Options that several subcommands share."""

from pathlib import Path
from typing import Annotated

import typer

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
