"""`dropflow ramp`: the temperature ramp of a constant driving parameter."""

from pathlib import Path
from typing import Annotated

import typer

from dropflow.physics.material import MixtureProperties
from dropflow.physics.material_report import find_or_load
from dropflow.physics.ramp import Protocol, ramp_csv, temperature_ramp


def ramp(
    material: Annotated[
        str, typer.Option("--material", help="Name of a material or a .yaml file.", show_default=False)
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="CSV file of set points at 1 Hz.", show_default=False)],
    xi: Annotated[float | None, typer.Option("--xi", help="Driving parameter, 1/s. Give this or --duration-s.")] = None,
    duration_s: Annotated[float | None, typer.Option("--duration-s", help="How long the ramp takes, s.")] = None,
    start_c: Annotated[float, typer.Option("--start-c", help="Temperature at the beginning, °C.")] = 25.8,
    end_c: Annotated[float, typer.Option("--end-c", help="Temperature at the end, °C.")] = 50.0,
    has_protocol: Annotated[
        bool, typer.Option("--protocol", help="Begin with an hour of mixing and four of equilibration.")
    ] = False,
) -> None:
    """Compute a temperature ramp that keeps the driving parameter xi constant.

    Writes time_s, temperature_c and stage, one row a second.

    Example: `dropflow ramp --material water-isobutoxyethanol-illustrative --xi 1.05e-5 --output ramp.csv`
    """
    found = find_or_load(material)
    binodal = MixtureProperties(found).binodal
    made = temperature_ramp(binodal, start_c=start_c, end_c=end_c, driving_per_s=xi, duration_s=duration_s)
    protocol = Protocol() if has_protocol else None
    output.parent.mkdir(parents=True, exist_ok=True)
    with output.open("w", encoding="utf-8", newline="") as file:
        n_rows = -1  # the first line is the names of the columns
        for text in ramp_csv(made, protocol):
            file.write(text)
            n_rows += text.count("\n")
    typer.echo(
        f"{output}: {n_rows} set points, {start_c:g} to {end_c:g} °C in {made.duration_s / 3600:.2f} h, "
        f"xi {made.driving_per_s:.4g} 1/s, {found.label}"
    )
