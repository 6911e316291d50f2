"""``flow.zarr``: the flow fields of a film, one entry a step."""

from pathlib import Path
from typing import Any

import numpy as np
import zarr

from dropflow.tracking.flow import FlowField
from dropflow.tracking.grid import Column, Grid

STEPS_PER_CHUNK = 32
_COORDINATES = "time_s grid_y_px grid_x_px"


def create_flow_store(path: Path, grid: Grid, times_s: Column, about: dict[str, Any]) -> zarr.Group:
    """Make an empty store in the layout of `FlowStore`, in place of any that is there."""
    n_steps = len(times_s) - 1
    store = zarr.create_group(path, zarr_format=3, overwrite=True, attributes=about)
    vector, scalar = (n_steps, 2, grid.n_rows, grid.n_columns), (n_steps, grid.n_rows, grid.n_columns)
    unit = {"units": "um/s", "coordinates": _COORDINATES}
    _array(store, "velocity_um_s", vector, "f4", np.nan, {**unit, "long_name": "velocity of the fluid (x, y)"})
    _array(store, "velocity_std_um_s", vector, "f4", np.nan, {**unit, "long_name": "standard deviation of its error"})
    cells = {"coordinates": _COORDINATES}
    _array(store, "droplet_count", scalar, "i4", 0, {**cells, "long_name": "followed droplets in the cell"})
    _array(store, "is_interpolated", scalar, "bool", True, {**cells, "long_name": "no droplet took part in the value"})
    _coordinate(store, "grid_x_px", "column", grid.x_px, {"units": "px", "long_name": "centre of the column"})
    _coordinate(store, "grid_y_px", "row", grid.y_px, {"units": "px", "long_name": "centre of the row"})
    _coordinate(store, "time_s", "frame", times_s[:-1], {"units": "s", "long_name": "time at which the step begins"})
    return store


class FlowStore:
    """Writes ``flow.zarr`` step by step.

    `velocity_um_s` and `velocity_std_um_s` (frame, component, row, column), `droplet_count` and `is_interpolated`
    (frame, row, column), `grid_x_px` (column), `grid_y_px` (row), `time_s` (frame). Entry i is the flow between frame
    i and frame i + 1. A step in which no droplet was followed is NaN. The arrays carry dimension names and
    units, as xarray reads them.
    """

    def __init__(self, store: zarr.Group) -> None:
        self._store = store

    def write(self, first_step: int, flows: list[FlowField]) -> None:
        """Write consecutive steps."""
        steps = slice(first_step, first_step + len(flows))
        for name in ("velocity_um_s", "velocity_std_um_s", "droplet_count", "is_interpolated"):
            self._array(name)[steps] = np.stack([getattr(flow, name) for flow in flows])

    def _array(self, name: str) -> zarr.Array[Any]:
        array = self._store[name]
        assert isinstance(array, zarr.Array)  # noqa: S101 - `create_flow_store` made it
        return array


def _array(
    store: zarr.Group, name: str, shape: tuple[int, ...], dtype: str, fill: float, attributes: dict[str, Any]
) -> None:
    dimensions = ("frame", "component", "row", "column") if len(shape) == 4 else ("frame", "row", "column")
    store.create_array(
        name,
        shape=shape,
        dtype=dtype,
        chunks=(min(STEPS_PER_CHUNK, max(shape[0], 1)), *shape[1:]),
        fill_value=fill,
        dimension_names=dimensions,
        attributes=attributes,
    )


def _coordinate(store: zarr.Group, name: str, dimension: str, values: Column, attributes: dict[str, Any]) -> None:
    array = store.create_array(
        name,
        shape=values.shape,
        dtype="f8",
        chunks=(max(len(values), 1),),
        dimension_names=(dimension,),
        attributes=attributes,
    )
    array[:] = values
