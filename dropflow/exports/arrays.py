"""Results as HDF5, and the flow field as NetCDF or Zarr: chunk by chunk."""

import json
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow.parquet as pq
import zarr

from dropflow.exports.tables import trajectory_rows
from dropflow.results import Results

if TYPE_CHECKING:
    import h5py

FLOW_ARRAYS = ("velocity_um_s", "velocity_std_um_s", "droplet_count", "is_interpolated")
_STEPS_AT_ONCE = 64


def write_hdf5(results: Results, output: Path) -> None:
    """Groups ``droplets`` and ``trajectories`` with one data set a column, and ``flow`` with its arrays."""
    import h5py

    with h5py.File(output, "w") as file:
        file.attrs["dropflow"] = json.dumps(results.provenance)
        for name, path in (("droplets", results.droplets), ("trajectories", results.trajectories)):
            _write_table(file.create_group(name), path)
        flow = file.create_group("flow")
        for name in (*FLOW_ARRAYS, "grid_x_px", "grid_y_px", "time_s"):
            _copy(zarr.open_array(results.flow / name, mode="r"), flow, name)


def write_netcdf(results: Results, output: Path) -> None:
    """The flow field as NetCDF 4, with the coordinates ``time_s``, ``y_px`` and ``x_px`` and units on each variable.

    NetCDF 4 is HDF5 with dimension scales, which is all that is needed of it here.
    """
    import h5py

    with h5py.File(output, "w", track_order=True) as file:
        file.attrs["dropflow"] = json.dumps(results.provenance)
        file.attrs["Conventions"] = "CF-1.11"
        file.attrs["title"] = f"Flow field of {results.experiment.name}"
        scales = {
            "time_s": ("time_s", "s"),
            "row_y_px": ("grid_y_px", "px"),
            "column_x_px": ("grid_x_px", "px"),
        }
        for index, (name, (source, unit)) in enumerate(scales.items()):
            _copy(zarr.open_array(results.flow / source, mode="r"), file, name)
            _as_scale(file[name], name, unit, index)
        file["component"] = np.arange(2, dtype=np.int32)
        _as_scale(file["component"], "component", "1", len(scales))
        file["component"].attrs["long_name"] = "0 along x (right), 1 along y (down)"
        for name in FLOW_ARRAYS:
            _copy(zarr.open_array(results.flow / name, mode="r"), file, name)
            axes = ["time_s", "row_y_px", "column_x_px"]
            if file[name].ndim == 4:
                axes.insert(1, "component")
            for axis, scale in enumerate(axes):
                file[name].dims[axis].attach_scale(file[scale])
            file[name].attrs["units"] = "um/s" if name.startswith("velocity") else "1"


def write_zarr(results: Results, output: Path) -> None:
    """The flow field as it is; it carries its provenance already."""
    shutil.copytree(results.flow, output)


def _as_scale(variable: Any, name: str, unit: str, number: int) -> None:
    variable.make_scale(name)
    variable.attrs["units"] = unit
    variable.attrs["_Netcdf4Dimid"] = np.int32(number)


def _copy(source: zarr.Array[Any], into: "h5py.Group", name: str) -> None:
    is_flag = source.dtype == np.bool_
    made = into.create_dataset(
        name,
        shape=source.shape,
        dtype="i1" if is_flag else source.dtype,
        chunks=tuple(max(1, min(length, 64)) for length in source.shape) if source.shape[0] else None,
        maxshape=source.shape,
        compression="gzip" if source.shape[0] and source.ndim > 1 else None,
    )
    for start in range(0, source.shape[0], _STEPS_AT_ONCE):
        made[start : start + _STEPS_AT_ONCE] = np.asarray(source[start : start + _STEPS_AT_ONCE])


def _write_table(group: "h5py.Group", path: Path) -> None:
    with pq.ParquetFile(path) as table:
        n_rows = table.metadata.num_rows
        chunks = (min(n_rows, 1 << 16),) if n_rows else None
        for column in table.schema_arrow:
            kind = "i1" if str(column.type) == "bool" else np.dtype(column.type.to_pandas_dtype())
            group.create_dataset(column.name, shape=(n_rows,), dtype=kind, chunks=chunks)
        start = 0
        for rows in trajectory_rows(table):
            for name in rows.column_names:
                group[name][start : start + len(rows)] = rows[name].to_numpy()
            start += len(rows)
