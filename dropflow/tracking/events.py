"""What happened to droplets: where trajectories begin and end, and why; which two became one (section 5)."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.tracking.coalescing import Merger, find_mergers
from dropflow.tracking.flow import bilinear
from dropflow.tracking.grid import Column, Grid
from dropflow.tracking.identification import Indices
from dropflow.tracking.prediction import Motion
from dropflow.tracking.sightings import Sightings

EVENTS = pa.schema(
    [
        ("frame", pa.int32()),
        ("time_s", pa.float64()),
        ("kind", pa.string()),
        ("cause", pa.string()),
        ("trajectory_id", pa.int64()),
        ("other_id", pa.int64()),
        ("product_id", pa.int64()),
        ("x_px", pa.float64()),
        ("y_px", pa.float64()),
        ("r_px", pa.float64()),
        ("r_um", pa.float64()),
        ("r_1_um", pa.float64()),
        ("r_2_um", pa.float64()),
        ("volume_residual", pa.float64()),
    ]
)
"""One row an event, sorted by frame: the first in which it can be seen.

In a coalescence `trajectory_id` (the larger droplet, radius `r_1_um`) and `other_id` (`r_2_um`) became `product_id`,
at whose first place the row stands; `product_id` is `trajectory_id` where that trajectory goes on. `volume_residual` is
the product's volume minus that of both, in its own standard deviations. A birth or an exit stands where the trajectory
was seen first or last. What was there in the first frame, or still is in the last one, has no birth or no exit.
"""

Columns = dict[str, npt.NDArray[Any]]
"""Some of these."""

_CUT_RADII = 1.0
"""A droplet whose centre is nearer to the border than this many radii is cut by it."""


class Kind(StrEnum):
    """What happened."""

    BIRTH = "birth"
    COALESCENCE = "coalescence"
    EXIT = "exit"
    SHIFT = "shift"
    """The camera moved by `x_px`, `y_px`; no trajectory is named."""


class Cause(StrEnum):
    """Why a trajectory begins or ends."""

    COALESCENCE = "coalescence"
    CAMERA = "camera"
    BORDER = "border"
    """It came from or went to where part of it is outside the frame."""
    HIDDEN = "hidden"
    """Another droplet covers the place where it was or would be."""
    FOCUS = "focus"
    """Inside the frame, and nothing hides it: it moved into or out of focus, nucleated, or was not found."""


@dataclass(frozen=True)
class Surroundings:
    """What all steps of a film have in common."""

    grid: Grid
    motion: Motion

    def places_px(
        self, seen: Sightings, rows: Indices, flow_um_s: Column, step: Indices, dt_s: Column, sense: int
    ) -> Column:
        """Where droplets would be in the frame after (`sense` 1) or before (-1), shape (2, n).

        Each goes on with the velocity that it had, which knows of its material and its own ways, changed by as much as
        the flow changes on its way. `flow_um_s` are the fields of some steps, shape (n_steps, 2, n_rows, n_columns),
        `step` says which is whose.
        """
        fields = flow_um_s.swapaxes(0, 1)
        here_px = np.stack([seen.x_px[rows], seen.y_px[rows]])
        own_um_s = np.nan_to_num(np.stack([seen.u_um_s[rows], seen.v_um_s[rows]]))
        way_px = sense * own_um_s * (dt_s / self.motion.pixel_size_um)
        ahead, behind = (bilinear(self.grid, fields, *(here_px + side * way_px / 2), step=step) for side in (1, -1))
        change_um_s = np.nan_to_num(ahead - behind)
        return np.asarray(here_px + way_px + sense * change_um_s * (dt_s / self.motion.pixel_size_um))

    def is_cut(self, x_px: Column, y_px: Column, r_px: Column) -> npt.NDArray[np.bool_]:
        """Whether the border of the frame takes a good part of a droplet here."""
        deep = np.minimum(
            np.minimum(x_px, self.grid.width_px - 1 - x_px), np.minimum(y_px, self.grid.height_px - 1 - y_px)
        )
        return np.asarray(deep < _CUT_RADII * r_px)


def events_of_steps(
    seen: Sightings, steps: range, times_s: Column, flow_um_s: Column, shifts_px: Column, around: Surroundings
) -> pa.Table:
    """The events of consecutive steps, each from a frame to the next, rows of `EVENTS`.

    Parameters
    ----------
    seen : Sightings
        Of the trajectories that are kept, from a few frames before to a few after.
    steps : range
        The frames with which the steps begin.
    times_s : ndarray, float64, shape (n_frames,)
    flow_um_s : ndarray, float64, shape (len(steps), 2, n_rows, n_columns)
        Of these steps; NaN where it is not known.
    shifts_px : ndarray, float64, shape (n_frames - 1, 2)
        By how much the camera moved in each step of the film.
    around : Surroundings
    """
    is_here = (seen.frame >= steps.start) & (seen.frame < steps.stop)
    is_there = (seen.frame > steps.start) & (seen.frame <= steps.stop)
    ends, begins = np.flatnonzero(seen.is_last & is_here), np.flatnonzero(seen.is_first & is_there)
    step = seen.frame[ends] - steps.start
    before_step = seen.frame[begins] - 1 - steps.start
    dt_s = np.diff(times_s[steps.start : steps.stop + 1])
    next_px = around.places_px(seen, ends, flow_um_s, step, dt_s[step], 1)
    before_px = around.places_px(seen, begins, flow_um_s, before_step, dt_s[before_step], -1)
    mergers = find_mergers(seen, ends, next_px, begins)
    is_end = ~np.isin(ends, [parent for merger in mergers for parent in merger.ended])
    is_birth = ~np.isin(begins, [merger.product for merger in mergers])
    births, exits = begins[is_birth], ends[is_end]
    pixel_size_um = around.motion.pixel_size_um
    parts = [
        _shifts(steps, shifts_px),
        _mergers(seen, mergers, pixel_size_um),
        {
            **_places(seen, births, seen.frame[births], Kind.BIRTH, pixel_size_um),
            "cause": _causes(seen, births, before_px[:, is_birth], seen.frame[births] - 1, around),
        },
        {
            **_places(seen, exits, seen.frame[exits] + 1, Kind.EXIT, pixel_size_um),
            "cause": _causes(seen, exits, next_px[:, is_end], seen.frame[exits] + 1, around),
        },
    ]
    rows = pa.concat_tables([_table(columns, times_s) for columns in parts])
    return rows.take(np.argsort(rows["frame"].to_numpy(), kind="stable"))


def _table(columns: Columns, times_s: Column) -> pa.Table:
    """Rows of `EVENTS`, null where there is no column."""
    known = {**columns, "time_s": times_s[columns["frame"]]}
    n = len(columns["frame"])
    arrays = [pa.array(known[f.name], f.type) if f.name in known else pa.nulls(n, f.type) for f in EVENTS]
    return pa.Table.from_arrays(arrays, schema=EVENTS)


def _shifts(steps: range, shifts_px: Column) -> Columns:
    """The steps in which the camera moved."""
    moved = steps.start + np.flatnonzero(shifts_px[steps.start : steps.stop].any(axis=1))
    x_px, y_px = -shifts_px[moved].T
    kind, cause = np.full(len(moved), Kind.SHIFT), np.full(len(moved), Cause.CAMERA)
    return {"frame": moved + 1, "kind": kind, "cause": cause, "x_px": x_px, "y_px": y_px}


def _places(seen: Sightings, rows: Indices, frame: Indices, kind: Kind, pixel_size_um: float) -> Columns:
    """Where droplets were seen in some rows."""
    return {
        "frame": frame,
        "kind": np.full(len(rows), kind),
        "trajectory_id": seen.trajectory_id[rows],
        "x_px": seen.x_px[rows],
        "y_px": seen.y_px[rows],
        "r_px": seen.r_px[rows],
        "r_um": seen.r_px[rows] * pixel_size_um,
    }


def _causes(
    seen: Sightings, rows: Indices, place_px: Column, frame: Indices, around: Surroundings
) -> npt.NDArray[np.str_]:
    """Border, hidden or focus for each of some rows, from where it would be in the other frame."""
    x_px, y_px = place_px
    is_cut = around.is_cut(x_px, y_px, seen.r_px[rows])
    is_hidden = seen.covers(x_px, y_px, seen.r_px[rows], frame)
    return np.where(is_cut, Cause.BORDER, np.where(is_hidden, Cause.HIDDEN, Cause.FOCUS))


def _mergers(seen: Sightings, mergers: list[Merger], pixel_size_um: float) -> Columns:
    product = np.array([merger.product for merger in mergers], np.int64)
    larger, smaller = np.array([[merger.larger, merger.smaller] for merger in mergers], np.int64).reshape(-1, 2).T
    r_px, r_1_px, r_2_px, residual = (
        np.array([[one.r_px, one.r_larger_px, one.r_smaller_px, one.volume_residual] for one in mergers])
        .reshape(-1, 4)
        .T
    )
    return {
        **_places(seen, product, seen.frame[product], Kind.COALESCENCE, pixel_size_um),
        "cause": np.full(len(product), Cause.COALESCENCE),
        "trajectory_id": seen.trajectory_id[larger],
        "other_id": seen.trajectory_id[smaller],
        "product_id": seen.trajectory_id[product],
        "r_px": r_px,
        "r_um": r_px * pixel_size_um,
        "r_1_um": r_1_px * pixel_size_um,
        "r_2_um": r_2_px * pixel_size_um,
        "volume_residual": residual,
    }
