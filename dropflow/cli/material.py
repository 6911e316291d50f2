"""`dropflow material`: the properties of a material, with units and sources."""

import json
from typing import Annotated

import typer

from dropflow.errors import ParametersError
from dropflow.physics.material_files import known_names
from dropflow.physics.material_report import describe, find_or_load


def material(
    name: Annotated[str, typer.Argument(help="Name of a material, or a material file (.yaml).", show_default=False)],
    temperature_c: Annotated[
        float | None, typer.Option("--temperature-c", help="Temperature, °C; needed by mixtures.")
    ] = None,
    composition: Annotated[
        float | None, typer.Option("--composition", help="Mass fraction of the second fluid, 0 to 1.")
    ] = None,
    is_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Print the properties of a material, each with its unit and where it comes from.

    Example: `dropflow material water-isobutoxyethanol-illustrative --temperature-c 40 --composition 0.3 --json`
    """
    found = find_or_load(name)
    if found.mixture is not None and temperature_c is None:
        raise ParametersError(f"The properties of {name} depend on temperature: give --temperature-c.")
    report = describe(found, temperature_c=temperature_c, composition=composition)
    if is_json:
        typer.echo(json.dumps(report, indent=2, allow_nan=False))
        return
    typer.echo(f"{found.label}: {found.title}")
    for key, entry in report["properties"].items():
        typer.echo(f"  {key:<42} {entry['value']:.6g} {entry['unit']}   ({entry['source']})")
    typer.echo(f"Known materials: {', '.join(known_names())}")
