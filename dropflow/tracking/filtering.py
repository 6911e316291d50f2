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
    BRIEF = "brief"
    """As short, but for no longer in view: it crossed a corner of the frame, or the film began or ended with it."""
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
        ("last_x_px", pa.float64()),
        ("last_y_px", pa.float64()),
        ("probability", pa.float64()),
        ("match", pa.float64()),
    ]
)
"""One row a trajectory: its places in its first and last frame, its mean radius, and why it is rejected.

The reason is an empty word where it is kept. `probability` is a mean over its frames, `match` that of logarithms over
those where it has one (else not a number).
"""

_VIEW_RADII = 1.0
"""A droplet whose centre is nearer to the border than this many radii need not be found."""


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
    probability_sum: Column
    log_match_sum: Column
    n_matched: Indices
    """Frames in which it has a match."""
    leaving_x_px: Column
    """How far it should have moved after its last frame; infinite where the film ends."""
    leaving_y_px: Column
    entering_x_px: Column
    """How far it should have moved before its first frame; not a number as long as that is not known."""
    entering_y_px: Column

    def __len__(self) -> int:
        return len(self.trajectory_id)

    def __getitem__(self, which: npt.NDArray[np.bool_] | Indices) -> "Trails":
        return Trails(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    @staticmethod
    def begin(front: Front, frame: int, leaving_px: Column | None = None) -> "Trails":
        """Trajectories whose last frame this is, after which they should move by `leaving_px`, shape (2, n)."""
        at, none = np.full(len(front), frame), np.zeros(len(front))
        x, y, r = front.droplets.x_px, front.droplets.y_px, front.droplets.r_px
        one = np.ones(len(front), np.int64)
        detected = front.is_detected.astype(np.int64)
        is_matched = front.droplets.match > 0
        log_match = np.log(np.where(is_matched, front.droplets.match, 1.0))
        leaving = np.full((2, len(front)), np.inf) if leaving_px is None else leaving_px
        return Trails(
            trajectory_id=front.trajectory_id,
            n_frames=one,
            n_detected=detected,
            first_frame=at,
            last_frame=at,
            first_x_px=x,
            first_y_px=y,
            last_x_px=x,
            last_y_px=y,
            r_sum_px=r,
            predicted_x_px=none,
            predicted_y_px=none,
            evidence=front.evidence,
            probability_sum=front.droplets.probability,
            log_match_sum=log_match,
            n_matched=is_matched.astype(np.int64),
            leaving_x_px=leaving[0],
            leaving_y_px=leaving[1],
            entering_x_px=none + np.nan,
            entering_y_px=none + np.nan,
        )

    def extend(
        self, front: Front, frame: int, predicted_step_px: Column | None, arrived_px: Column | None = None
    ) -> tuple["Trails", "Trails"]:
        """Go back to `front` at `frame`, whose droplets were predicted to move by `predicted_step_px`, shape (2, n).

        None where the film ends there. Those of these trails should have moved by `arrived_px`, shape (2, len(self)),
        in the same step. Returns the trails of the trajectories in `front`, and those that are complete: they are not
        in it.
        """
        here = Trails.begin(front, frame, predicted_step_px)
        both = in_both(self.trajectory_id, here.trajectory_id)
        joined = here if predicted_step_px is None else here._join(both.second, self, both.first, predicted_step_px)
        came = self if arrived_px is None else replace(self, entering_x_px=arrived_px[0], entering_y_px=arrived_px[1])
        return joined, came[all_but(len(self), both.first)]

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
                "last_x_px": self.last_x_px,
                "last_y_px": self.last_y_px,
                "probability": self.probability_sum / self.n_frames,
                "match": self._mean_match(),
            },
            schema=VERDICTS,
        )

    def _mean_match(self) -> Column:
        with np.errstate(invalid="ignore"):
            return np.asarray(np.exp(self.log_match_sum / self.n_matched))

    def _join(self, rows: Indices, later: "Trails", later_rows: Indices, step_px: Column) -> "Trails":
        joined = {name: getattr(self, name).copy() for name in self.__dataclass_fields__}
        for name in ("last_frame", "last_x_px", "last_y_px", "leaving_x_px", "leaving_y_px"):
            joined[name][rows] = getattr(later, name)[later_rows]
        sums = ("n_frames", "n_detected", "r_sum_px", "evidence", "probability_sum", "log_match_sum", "n_matched")
        for name in sums:
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
    frame_px: tuple[int, int] | None = None,
) -> npt.NDArray[np.str_]:
    """Why each complete trajectory is rejected, shape (n,); an empty word for those that are kept.

    Too short ones go first. Of the others go those that moved by less than `stationary_fraction` of the way that they
    were predicted to go in the same time, start to end. The prediction is that of their own place and size: a mean
    over the film would condemn droplets wherever the fluid is slow or flows against their sedimentation. At last go
    those that have less than `least_evidence`.

    Where three frames are enough, two are as well if their pair alone has `sure_pair_evidence`. With `frame_px`, height
    and width of the frames, short ones that were in view for no longer are told from the others.
    """
    moved_px = np.hypot(trails.last_x_px - trails.first_x_px, trails.last_y_px - trails.first_y_px)
    predicted_px = np.hypot(trails.predicted_x_px, trails.predicted_y_px)
    is_stationary = moved_px < stationary_fraction * predicted_px
    is_sure_pair = (trails.n_detected == 2) & (trails.evidence >= sure_pair_evidence) & (shortest_frames <= 3)
    is_short = (trails.n_frames < shortest_frames) & ~is_sure_pair
    is_doubtful = trails.evidence < least_evidence
    is_brief = is_short & (False if frame_px is None else _is_brief(trails, frame_px, shortest_frames))
    conditions = [is_brief, is_short, is_stationary, is_doubtful]
    words = [str(Reason.BRIEF), str(Reason.SHORT), str(Reason.STATIONARY), str(Reason.DOUBTFUL)]
    return np.select(conditions, words, default="")


def _is_brief(trails: Trails, frame_px: tuple[int, int], enough: int) -> npt.NDArray[np.bool_]:
    """Whether the film begins or ends with a trajectory, or it should be in view in fewer than `enough` frames."""
    margin_px = _VIEW_RADII * trails.r_sum_px / trails.n_frames
    n_frames = trails.n_frames.copy()
    for x_px, y_px, step_x_px, step_y_px in (
        (trails.first_x_px, trails.first_y_px, -trails.entering_x_px, -trails.entering_y_px),
        (trails.last_x_px, trails.last_y_px, trails.leaving_x_px, trails.leaving_y_px),
    ):
        is_there = np.ones(len(trails), bool)
        for n_steps in range(1, enough):
            deep_px = np.full(len(trails), np.inf)
            for place, step, size in ((x_px, step_x_px, frame_px[1]), (y_px, step_y_px, frame_px[0])):
                where = place + n_steps * np.where(np.isnan(step), 0.0, step)
                deep_px = np.minimum(deep_px, np.minimum(where, size - 1 - where))
            is_there &= deep_px >= margin_px
            n_frames += is_there
    return np.asarray((trails.first_frame == 0) | np.isinf(trails.leaving_x_px) | (n_frames < enough))
