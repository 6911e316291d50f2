"""Which trajectories are droplets, and why the others are not (section 3.3.3)."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.tracking.front import Front
from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices, all_but, in_both


class Reason(StrEnum):
    """Why a trajectory was rejected."""

    SHORT = "short"
    """Fewer frames than a trajectory must have."""
    STATIONARY = "stationary"
    """It did not move with the flow, as dirt does not."""
    DOUBTFUL = "doubtful"
    """Chance makes such a trajectory too easily."""


VERDICTS = pa.schema(
    [
        ("trajectory_id", pa.int64()),
        ("reason", pa.string()),
        ("first_frame", pa.int32()),
        ("last_frame", pa.int32()),
        ("n_frames", pa.int32()),
        ("n_detected", pa.int32()),
        ("x_px", pa.float64()),
        ("y_px", pa.float64()),
        ("r_px", pa.float64()),
    ]
)
"""One row a trajectory: its place in its first frame, its mean radius, and why it is rejected (empty: it is not)."""


@dataclass(frozen=True)
class Trails:
    """What filtering must know of each trajectory, gathered while walking back through the frames.

    Each of shape (n,), in the order of `trajectory_id`.
    """

    trajectory_id: Indices
    n_frames: Indices
    n_detected: Indices
    """Frames in which it was detected, not only found by prediction."""
    first_frame: Indices
    last_frame: Indices
    first_x_px: Column
    first_y_px: Column
    last_x_px: Column
    last_y_px: Column
    r_sum_px: Column
    predicted_x_px: Column
    """How far flow and sedimentation should have carried it, over all its steps."""
    predicted_y_px: Column
    evidence: Column
    """How much more probable (ln) than chance its pairs are together."""

    def __len__(self) -> int:
        return len(self.trajectory_id)

    def __getitem__(self, which: npt.NDArray[np.bool_] | Indices) -> "Trails":
        return Trails(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    @staticmethod
    def begin(front: Front, frame: int) -> "Trails":
        """Trajectories whose last frame this is."""
        at, none = np.full(len(front), frame), np.zeros(len(front))
        x, y, r = front.droplets.x_px, front.droplets.y_px, front.droplets.r_px
        one = np.ones(len(front), np.int64)
        detected = front.is_detected.astype(np.int64)
        return Trails(front.trajectory_id, one, detected, at, at, x, y, x, y, r, none, none, front.evidence)

    def extend(self, front: Front, frame: int, predicted_step_px: Column) -> tuple["Trails", "Trails"]:
        """Go back to `front` at `frame`, whose droplets were predicted to move by `predicted_step_px`, shape (2, n).

        Returns the trails of the trajectories in `front`, and those that are complete: they are not in it.
        """
        here = Trails.begin(front, frame)
        both = in_both(self.trajectory_id, here.trajectory_id)
        joined = here._join(both.second, self, both.first, predicted_step_px)
        return joined, self[all_but(len(self), both.first)]

    def to_verdicts(self, why: npt.NDArray[np.str_]) -> pa.Table:
        """Rows of `VERDICTS`, in the order of the trails."""
        return pa.table(
            {
                "trajectory_id": self.trajectory_id,
                "reason": why.astype(str).tolist(),
                "first_frame": self.first_frame,
                "last_frame": self.last_frame,
                "n_frames": self.n_frames,
                "n_detected": self.n_detected,
                "x_px": self.first_x_px,
                "y_px": self.first_y_px,
                "r_px": self.r_sum_px / self.n_frames,
            },
            schema=VERDICTS,
        )

    def _join(self, rows: Indices, later: "Trails", later_rows: Indices, step_px: Column) -> "Trails":
        joined = {name: getattr(self, name).copy() for name in self.__dataclass_fields__}
        for name in ("last_frame", "last_x_px", "last_y_px"):
            joined[name][rows] = getattr(later, name)[later_rows]
        for name in ("n_frames", "n_detected", "r_sum_px", "evidence"):
            joined[name][rows] += getattr(later, name)[later_rows]
        joined["predicted_x_px"][rows] = later.predicted_x_px[later_rows] + step_px[0, rows]
        joined["predicted_y_px"][rows] = later.predicted_y_px[later_rows] + step_px[1, rows]
        return replace(self, **joined)


def reasons(
    trails: Trails,
    *,
    shortest_frames: int,
    stationary_fraction: float,
    least_evidence: float = -np.inf,
    sure_pair_evidence: float = np.inf,
) -> npt.NDArray[np.str_]:
    """Why each complete trajectory is rejected, shape (n,); an empty word for those that are kept.

    Too short ones go first. Of the others go those that moved by less than `stationary_fraction` of the way that they
    were predicted to go in the same time, start to end. The prediction is that of their own place and size: a mean
    over the film would condemn droplets wherever the fluid is slow or flows against their sedimentation. At last go
    those that have less than `least_evidence`.

    Where three frames are enough, two are as well if their pair alone has `sure_pair_evidence`.
    """
    moved_px = np.hypot(trails.last_x_px - trails.first_x_px, trails.last_y_px - trails.first_y_px)
    predicted_px = np.hypot(trails.predicted_x_px, trails.predicted_y_px)
    is_stationary = moved_px < stationary_fraction * predicted_px
    is_sure_pair = (trails.n_detected == 2) & (trails.evidence >= sure_pair_evidence) & (shortest_frames <= 3)
    is_short = (trails.n_frames < shortest_frames) & ~is_sure_pair
    is_doubtful = trails.evidence < least_evidence
    conditions = [is_short, is_stationary, is_doubtful]
    return np.select(conditions, [str(Reason.SHORT), str(Reason.STATIONARY), str(Reason.DOUBTFUL)], default="")
