"""The droplets of kept trajectories over a few frames, as columns: what happens at their ends is read from them."""

from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np
import numpy.typing as npt
import pyarrow as pa
from scipy.spatial import cKDTree

from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices

N_AVERAGED = 3
"""Frames over which a radius is averaged at the end or the beginning of a trajectory."""
_FAR_PX = 1e6
"""Between frames, where places in several are searched at once."""
_RADIUS_MODEL_STD = 0.02
"""Relative standard deviation of a radius that no averaging removes."""


@dataclass(frozen=True)
class Sightings:
    """Rows sorted by (trajectory_id, frame), a row for each frame from the first to the last of a trajectory."""

    trajectory_id: Indices
    frame: Indices
    x_px: Column
    y_px: Column
    r_px: Column
    r_std_px: Column
    u_um_s: Column
    v_um_s: Column
    sedimentation_um_s: Column

    @staticmethod
    def from_table(rows: pa.Table) -> "Sightings":
        """From rows of `dropflow.tables.TRAJECTORIES`, sorted."""
        return Sightings(
            *(rows[name].to_numpy().astype(np.int64) for name in ("trajectory_id", "frame")),
            *(
                rows[name].to_numpy()
                for name in ("x_px", "y_px", "r_px", "r_std_px", "u_um_s", "v_um_s", "sedimentation_um_s")
            ),
        )

    @cached_property
    def is_first(self) -> npt.NDArray[np.bool_]:
        """Rows that are the first of their trajectory."""
        return np.append(True, np.diff(self.trajectory_id) != 0)[: len(self.frame)]

    @cached_property
    def is_last(self) -> npt.NDArray[np.bool_]:
        """Rows that are the last of their trajectory."""
        return np.append(np.diff(self.trajectory_id) != 0, True)[: len(self.frame)]

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(in_frames(self.x_px, self.y_px, self.frame), compact_nodes=False, balanced_tree=False)

    def near(self, x_px: Column, y_px: Column, frame: Indices, reach_px: float | Column) -> tuple[Indices, Indices]:
        """Indices of places in given frames, and of the rows of these frames that lie within reach of them."""
        return near_pairs(self._tree, in_frames(x_px, y_px, frame), reach_px)

    @cached_property
    def radius_until(self) -> tuple[Column, Column]:
        """Mean radius up to each row, and its standard deviation."""
        return self._radius(-1)

    @cached_property
    def radius_from(self) -> tuple[Column, Column]:
        """Mean radius from each row on, and its standard deviation."""
        return self._radius(1)

    def _radius(self, direction: int) -> tuple[Column, Column]:
        n = len(self.frame)
        total, squares, of_r, count = np.zeros((4, n))
        for away in range(N_AVERAGED):
            other = np.arange(n) + direction * away
            is_there = (other >= 0) & (other < n)
            other = np.clip(other, 0, max(n - 1, 0))
            is_there &= self.trajectory_id[other] == self.trajectory_id
            total += np.where(is_there, self.r_px[other], 0.0)
            squares += np.where(is_there, self.r_std_px[other] ** 2, 0.0)
            of_r += np.where(is_there, self.r_px[other] ** 2, 0.0)
            count += is_there
        mean = total / np.maximum(count, 1)
        # Radii that scatter by more than their errors, as those of a bubble that wobbles, are known that much worse.
        scatter = np.maximum(of_r - count * mean**2, 0.0) / np.maximum(count - 1, 1)
        variance = np.maximum(squares / np.maximum(count, 1), scatter) / np.maximum(count, 1)
        return mean, np.sqrt(variance + (_RADIUS_MODEL_STD * mean) ** 2)

    def covers(self, x_px: Column, y_px: Column, r_px: Column, frame: Indices) -> npt.NDArray[np.bool_]:
        """Whether the centre of each given droplet lies in a larger one of its frame."""
        is_covered = np.zeros(len(x_px), bool)
        if len(x_px):
            which, over = self.near(x_px, y_px, frame, float(self.r_px.max()))
            apart = np.hypot(self.x_px[over] - x_px[which], self.y_px[over] - y_px[which])
            is_covered[which[(apart < self.r_px[over]) & (self.r_px[over] > r_px[which])]] = True
        return is_covered


def in_frames(x_px: Column, y_px: Column, frame: Indices) -> Column:
    """Places as points of a space in which frames are further apart than anything in one, shape (n, 3)."""
    return np.column_stack([x_px, y_px, _FAR_PX * frame])


def near_pairs(tree: cKDTree, places: Column, reach_px: float | Column) -> tuple[Indices, Indices]:
    """Indices of places, shape (n, 3), and of the points of a tree that lie within reach of them."""
    near = tree.query_ball_point(places, reach_px)
    which = np.repeat(np.arange(len(places)), [len(some) for some in near])
    return which, np.fromiter(chain.from_iterable(near), np.int64, len(which))
