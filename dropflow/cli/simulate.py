"""`dropflow simulate`: a film with everything known about it."""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin

import typer

from dropflow.cli import progress
from dropflow.experiment import DropletTone
from dropflow.simulation.scenario import SCENARIOS, Scenario, changed, named_scenario

_SHOWN_FIRST = ("height_px", "width_px")
_PANEL = "Constants of the scenario (shown: the default of most scenarios)"


def _simulate(
    out: Annotated[Path, typer.Argument(metavar="OUT", help="Folder to make.", show_default=False)],
    scenario: Annotated[str, typer.Option(help=f"One of {', '.join(SCENARIOS)}, oscillating.")] = "easy",
    frames: Annotated[int, typer.Option(help="Number of frames.")] = 20,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same film.")] = 0,
    height: Annotated[int | None, typer.Option(help="Rows of a frame [default: 2058].")] = None,
    width: Annotated[int | None, typer.Option(help="Columns of a frame [default: 2448].")] = None,
    tables_only: Annotated[bool, typer.Option("--tables-only", help="Write the truth without images.")] = False,
    **constants: Any,
) -> None:
    """Simulate a film of droplets with known truth.

    Writes frames/*.tif, flat_field.tif, experiment.yaml, truth.parquet (every droplet in every frame), truth_flow.zarr
    (the exact flow), events.csv (births, coalescences, exits) and scenario.yaml (all constants). Frames of another
    size hold as many droplets per area. Every constant of the scenario is an option. The scenario "oscillating" is one
    of nucleation waves; four of them take 212 s.

    Example: `dropflow simulate film/ --scenario dense --frames 50 --seed 1 --height 512 --width 612`
    """
    # Imported here, for it takes seconds and `--help` and wrong options need none of it.
    from dropflow.simulation.film import Film
    from dropflow.simulation.oscillating import OSCILLATING, write_oscillating
    from dropflow.simulation.write import write_experiment

    changes = {name: value for name, value in constants.items() if value is not None}
    sizes = {"height_px": height, "width_px": width}
    changes |= {name: value for name, value in sizes.items() if value is not None}
    if scenario == OSCILLATING.name:
        waves = changed(OSCILLATING, changes)
        with progress.shown() as shown:
            write_oscillating(
                out, scenario=waves, n_frames=frames, seed=seed, with_images=not tables_only, progress=shown
            )
        typer.echo(f"The film is in {out}")
        return
    film = Film(changed(named_scenario(scenario), changes), seed)
    with progress.shown() as shown:
        write_experiment(out, film, frames, with_images=not tables_only, progress=shown)
    typer.echo(f"The film is in {out}")


def _with_constants(command: Callable[..., None]) -> Callable[..., None]:
    """Give the command one option for each constant of a scenario, with the constant's docstring as help."""
    signature = inspect.signature(command)
    named = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
    skipped = {"name", *_SHOWN_FIRST}
    options = [_option(name) for name in Scenario.model_fields if name not in skipped]
    command.__signature__ = signature.replace(parameters=named + options)  # type: ignore[attr-defined]
    command.__name__ = "simulate"
    return command


def _option(name: str) -> inspect.Parameter:
    field = Scenario.model_fields[name]
    kind: Any = field.annotation
    if get_origin(kind) is Literal:
        kind = type(get_args(kind)[0])
    default = field.default.value if isinstance(field.default, DropletTone) else field.default
    about = typer.Option(
        f"--{name.replace('_', '-')}", help=f"{field.description} [default: {default}]", rich_help_panel=_PANEL
    )
    annotation = Annotated[kind | None, about]
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=annotation)


simulate = _with_constants(_simulate)
