"""`dropflow export`: results in the forms that other programs read."""

from pathlib import Path
from typing import Annotated

import typer

from dropflow.exports.kinds import Kind


def export(
    results: Annotated[Path, typer.Argument(metavar="RESULTS", help="Folder of an analysis.", show_default=False)],
    kind: Annotated[Kind, typer.Option("--kind", help="Form of the export.", show_default=False)],
    output: Annotated[Path, typer.Option("--output", "-o", help="File to write.", show_default=False)],
) -> None:
    """Export trajectories (csv, parquet, trackmate, trackpy, napari), the flow (netcdf, zarr) or all (hdf5).

    Each carries its provenance inside.

    Example: `dropflow export results/ --kind trackmate --output tracks.xml`
    """
    # Imported here, for it takes seconds and `--help` and wrong options need none of it.
    from dropflow.exports.write import export as write_export
    from dropflow.results import open_results

    write_export(open_results(results), kind, output)
    typer.echo(f"The export is in {output}")
