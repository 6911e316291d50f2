"""`dropflow suggest`: parameters for a stack, with what they were measured from."""

from pathlib import Path
from typing import Annotated

import typer
import yaml

from dropflow.cli.compile import say_if_not_compiled
from dropflow.cli.options import ExperimentFile, Stack
from dropflow.experiment import load_experiment


def suggest(
    stack: Stack,
    experiment: ExperimentFile,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="YAML file to write the proposed parameters to.")
    ] = None,
) -> None:
    """Measure noise, contrast, blur, radii and displacement on some frames, and propose parameters.

    Example: `dropflow suggest frames/ --experiment experiment.yaml --output parameters.yaml`
    """
    # Imported here, for it takes seconds and `--help` and wrong options need none of it.
    from dropflow.analysis import flat_field_beside
    from dropflow.frames import Choice, open_frames
    from dropflow.suggest import suggest as suggest_for

    film = load_experiment(experiment)
    say_if_not_compiled()
    with open_frames(stack, Choice.of(film)) as frames:
        advice = suggest_for(frames, film, flat_field=flat_field_beside(film, experiment.parent))
    typer.echo(f"Measured on frames {', '.join(str(index) for index in advice.frames)}:")
    for one in advice.measurements:
        value = "not seen" if one.value is None else f"{one.value:.3g} {one.unit}".removesuffix(" 1")
        typer.echo(f"  {one.name:22} {value:22} {one.about}")
    typer.echo("Proposed:" if advice.suggestions else "Nothing to propose.")
    for suggestion in advice.suggestions:
        typer.echo(f"  {suggestion.field}: {suggestion.value:g} {suggestion.unit}".ljust(47) + f" {suggestion.reason}")
    for warning in advice.warnings:
        typer.echo(f"Careful: {warning}")
    if output is not None:
        document = advice.parameters().model_dump(mode="json", exclude_defaults=True)
        output.write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
        typer.echo(f"Parameters are in {output}")
