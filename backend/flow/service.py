"""Maps of the flow, out of the flow field of a film."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import zarr

from backend.flow.schemas import FlowMap
from backend.platform.object_store import ObjectStore
from backend.results.errors import NotYet
from backend.results.frames import open_flow
from backend.results.service import Asker
from dropflow.experiment import parse_experiment
from dropflow.statistics import flow_maps

CHUNK_STEPS = 32
MOST_CHUNKS = 24
"""A range of more chunks is sampled: reading all of a long film would take seconds."""


def at_frame(asker: Asker, store: ObjectStore, frame: int) -> FlowMap:
    """The flow between a frame and the next, in every cell."""
    group = open_flow(store, asker.product("track", frame))
    if frame >= _array(group, "time_s").shape[0]:
        raise NotYet
    return _shown(asker, group, frame, frame, is_every_cell_taken=True)


def over(asker: Asker, store: ObjectStore, from_s: float | None, to_s: float | None) -> FlowMap:
    """The mean flow of the steps that begin in a range of time; of the nearest one where there is none."""
    group = open_flow(store, asker.product("track"))
    time_s = np.asarray(_array(group, "time_s")[:])
    if not len(time_s):
        raise NotYet
    first = int(np.searchsorted(time_s, -np.inf if from_s is None else from_s, side="left"))
    last = int(np.searchsorted(time_s, np.inf if to_s is None else to_s, side="right")) - 1
    first = min(first, len(time_s) - 1)
    return _shown(asker, group, first, max(first, last), is_every_cell_taken=False)


def _shown(asker: Asker, group: zarr.Group, first: int, last: int, *, is_every_cell_taken: bool) -> FlowMap:
    pixel_size_um = parse_experiment(asker.run.document).pixel_size_um
    pieces = list(_pieces(first, last))
    steps = (
        (np.asarray(_array(group, "velocity_um_s")[piece]), np.asarray(_array(group, "is_interpolated")[piece]))
        for piece in pieces
    )
    found = flow_maps.flow_map(steps, is_every_cell_taken=is_every_cell_taken)
    x_px, y_px, time_s = (np.asarray(_array(group, name)[:]) for name in ("grid_x_px", "grid_y_px", "time_s"))
    velocity = (found.u_um_s, found.v_um_s, x_px * pixel_size_um, y_px * pixel_size_um)
    return FlowMap(
        first_frame=first,
        last_frame=last,
        from_s=float(time_s[first]),
        to_s=float(time_s[last]),
        n_steps=last - first + 1,
        n_used=sum(piece.stop - piece.start for piece in pieces),
        grid_x_px=x_px.tolist(),
        grid_y_px=y_px.tolist(),
        u_um_s=_rows(found.u_um_s),
        v_um_s=_rows(found.v_um_s),
        speed_um_s=_rows(np.hypot(found.u_um_s, found.v_um_s)),
        rms_um_s=_rows(found.rms_um_s),
        vorticity_per_s=_rows(flow_maps.vorticity_per_s(*velocity)),
        divergence_per_s=_rows(flow_maps.divergence_per_s(*velocity)),
        computed_share=_rows(found.computed_share),
    )


def _pieces(first: int, last: int) -> Iterator[slice]:
    """The range cut where chunks meet; of too many, some that lie evenly."""
    starts = [first, *range(first - first % CHUNK_STEPS + CHUNK_STEPS, last + 1, CHUNK_STEPS)]
    if len(starts) > MOST_CHUNKS:
        kept = np.linspace(0, len(starts) - 1, MOST_CHUNKS).round().astype(int)
        starts = [starts[index] for index in kept]
    for start in starts:
        yield slice(start, min(start - start % CHUNK_STEPS + CHUNK_STEPS, last + 1))


def _rows(values: npt.NDArray[np.float64]) -> list[list[float | None]]:
    return [[float(value) if np.isfinite(value) else None for value in row] for row in values]


def _array(group: zarr.Group, name: str) -> zarr.Array[Any]:
    found = group[name]
    if not isinstance(found, zarr.Array):
        raise TypeError(f"{name} is no array of the flow field")
    return found
