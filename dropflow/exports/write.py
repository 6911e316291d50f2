"""One way in for every kind of export."""

import shutil
from collections.abc import Callable
from pathlib import Path

from dropflow.errors import ResultsError
from dropflow.exports import arrays, tables, trackmate
from dropflow.exports.kinds import Kind
from dropflow.results import Results

_WRITERS: dict[Kind, Callable[[Results, Path], None]] = {
    Kind.CSV: tables.write_csv,
    Kind.PARQUET: tables.write_parquet,
    Kind.HDF5: arrays.write_hdf5,
    Kind.TRACKMATE: trackmate.write_trackmate,
    Kind.TRACKPY: tables.write_trackpy,
    Kind.NAPARI: tables.write_napari,
    Kind.NETCDF: arrays.write_netcdf,
    Kind.ZARR: arrays.write_zarr,
}


def export(results: Results, kind: Kind, output: Path) -> None:
    """Write results as `kind` to `output`, which appears whole or not at all.

    Raises
    ------
    ResultsError
        `output` is there already, or cannot be written.
    """
    if output.exists():
        raise ResultsError("This is there already.", code="results.exists", file=str(output), hint="Choose a new name.")
    unfinished = output.with_name(output.name + ".part")
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise ResultsError(f"The folder cannot be made ({problem.strerror}).", file=str(output.parent)) from None
    try:
        _WRITERS[kind](results, unfinished)
        unfinished.rename(output)
    except OSError as problem:
        raise ResultsError(f"The export cannot be written ({problem.strerror}).", file=str(output)) from None
    finally:
        if unfinished.is_dir():
            shutil.rmtree(unfinished)
        else:
            unfinished.unlink(missing_ok=True)
