"""What happened to droplets: where trajectories begin and end, and why; which two became one (section 5)."""

from dataclasses import dataclass
from enum import StrEnum

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

Row = dict[str, object]
"""One of these, as far as it has values."""

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

    def step_px(self, seen: Sightings, rows: Indices, flow_um_s: npt.NDArray[np.float64], dt_s: float) -> Column:
        """How far droplets should move in a step, shape (2, n); with their own velocity where the flow is unknown."""
        own = np.nan_to_num(np.stack([seen.u_um_s[rows], seen.v_um_s[rows]]))
        carried = bilinear(self.grid, flow_um_s, seen.x_px[rows], seen.y_px[rows])
        carried += np.outer(self.motion.up, seen.sedimentation_um_s[rows])
        velocity_um_s = np.where(np.isfinite(carried), carried, own)
        return np.asarray(velocity_um_s * (dt_s / self.motion.pixel_size_um))

    def is_cut(self, x_px: Column, y_px: Column, r_px: Column) -> npt.NDArray[np.bool_]:
        """Whether the border of the frame takes a good part of a droplet here."""
        deep = np.minimum(
            np.minimum(x_px, self.grid.width_px - 1 - x_px), np.minimum(y_px, self.grid.height_px - 1 - y_px)
        )
        return np.asarray(deep < _CUT_RADII * r_px)


def events_of_step(
    seen: Sightings, frame: int, times_s: Column, flow_um_s: npt.NDArray[np.float64], around: Surroundings
) -> list[Row]:
    """The events between `frame` and the next, rows of `EVENTS`.

    Parameters
    ----------
    seen : Sightings
        Of the trajectories that are kept, from a few frames before to a few after.
    frame : int
    times_s : ndarray, float64, shape (n_frames,)
    flow_um_s : ndarray, float64, shape (2, n_rows, n_columns)
        Of this step; NaN where it is not known.
    around : Surroundings
    """
    here, there = seen.rows_of(frame), seen.rows_of(frame + 1)
    ends, begins = here[seen.is_last[here]], there[seen.is_first[there]]
    going_on = here[~seen.is_last[here]]
    dt_s = float(times_s[frame + 1] - times_s[frame])
    ahead = around.step_px(seen, ends, flow_um_s, dt_s)
    back = around.step_px(seen, begins, flow_um_s, dt_s)
    next_px = np.stack([seen.x_px[ends], seen.y_px[ends]]) + ahead
    before_px = np.stack([seen.x_px[begins], seen.y_px[begins]]) - back
    mergers = find_mergers(seen, ends, next_px, begins, going_on)
    time_s = float(times_s[frame + 1])
    ends_alone = ~np.isin(ends, [parent for merger in mergers for parent in merger.ended])
    begins_alone = ~np.isin(begins, [merger.product for merger in mergers])
    rows = [_row_of_merger(seen, merger, frame + 1, time_s, around.motion.pixel_size_um) for merger in mergers]
    for kind, which, place_px, others in (
        (Kind.BIRTH, begins[begins_alone], before_px[:, begins_alone], here),
        (Kind.EXIT, ends[ends_alone], next_px[:, ends_alone], there),
    ):
        causes = _causes(seen, which, place_px, others, around)
        for row, cause in zip(which.tolist(), causes, strict=True):
            rows.append(_row(seen, row, frame + 1, time_s, kind, cause, around.motion.pixel_size_um))
    return rows


def row_of_shift(frame: int, time_s: float, shift_px: Column) -> Row:
    """The event that the camera moved before `frame`."""
    x_px, y_px = (-shift_px).tolist()
    row: Row = {"frame": frame, "time_s": time_s, "kind": str(Kind.SHIFT), "cause": str(Cause.CAMERA)}
    return {**row, "x_px": x_px, "y_px": y_px}


def _causes(seen: Sightings, rows: Indices, place_px: Column, others: Indices, around: Surroundings) -> list[Cause]:
    """Border, hidden or focus for each of some rows, from where it would be in the other frame."""
    x_px, y_px = place_px
    is_cut = around.is_cut(x_px, y_px, seen.r_px[rows])
    is_hidden = seen.covers(others, x_px, y_px, seen.r_px[rows])
    return [
        Cause.BORDER if cut else Cause.HIDDEN if hidden else Cause.FOCUS
        for cut, hidden in zip(is_cut.tolist(), is_hidden.tolist(), strict=True)
    ]


def _row(seen: Sightings, row: int, frame: int, time_s: float, kind: Kind, cause: Cause, pixel_size_um: float) -> Row:
    return {
        "frame": frame,
        "time_s": time_s,
        "kind": str(kind),
        "cause": str(cause),
        "trajectory_id": int(seen.trajectory_id[row]),
        "x_px": float(seen.x_px[row]),
        "y_px": float(seen.y_px[row]),
        "r_px": float(seen.r_px[row]),
        "r_um": float(seen.r_px[row]) * pixel_size_um,
    }


def _row_of_merger(seen: Sightings, merger: Merger, frame: int, time_s: float, pixel: float) -> Row:
    row = _row(seen, merger.product, frame, time_s, Kind.COALESCENCE, Cause.COALESCENCE, pixel)
    ids = {
        "trajectory_id": int(seen.trajectory_id[merger.larger]),
        "other_id": int(seen.trajectory_id[merger.smaller]),
        "product_id": int(seen.trajectory_id[merger.product]),
    }
    sizes = {"r_um": merger.r_px * pixel, "r_1_um": merger.r_larger_px * pixel, "r_2_um": merger.r_smaller_px * pixel}
    return {**row, **ids, **sizes, "r_px": merger.r_px, "volume_residual": merger.volume_residual}
