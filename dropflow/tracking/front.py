"""The droplets of one frame, each with the trajectory it belongs to."""

from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices, in_both

ROWS = pa.schema(
    [
        ("frame", pa.int32()),
        ("trajectory_id", pa.int64()),
        *((column.name, pa.float64()) for column in fields(Droplets)),
        ("is_detected", pa.bool_()),
        ("is_seen", pa.bool_()),
        ("smooth_r_px", pa.float64()),
        ("log_r_std", pa.float64()),
        ("evidence", pa.float64()),
    ]
)
"""Rows on their way between the passes of tracking, sorted by (frame, trajectory_id)."""


@dataclass(frozen=True)
class Front:
    """Where all trajectories are in one frame; `trajectory_id` is ascending and each occurs once."""

    trajectory_id: Indices
    droplets: Droplets
    is_detected: npt.NDArray[np.bool_]
    """False where the droplet was found by prediction alone."""
    is_seen: npt.NDArray[np.bool_]
    """False where not even the image shows it, and it is only thought to be where it is predicted."""
    smooth_r_px: Column
    """Radius in the light of the trajectory so far."""
    log_r_std: Column
    """Standard deviation of its logarithm."""
    evidence: Column
    """How much more probable (ln) it made its trajectory than chance."""

    def __len__(self) -> int:
        return len(self.trajectory_id)

    def __getitem__(self, which: npt.NDArray[np.bool_] | Indices | slice) -> "Front":
        """The rows at a mask, at indices or in a slice."""
        return Front(*(getattr(self, name)[which] for name in self.__dataclass_fields__))

    def sorted(self) -> "Front":
        """In the order of `trajectory_id`."""
        return self[np.argsort(self.trajectory_id, kind="stable")]

    @staticmethod
    def of(trajectory_id: Indices, droplets: Droplets, *, is_detected: bool) -> "Front":
        """Droplets that were all seen, with no knowledge from other frames."""
        n = len(trajectory_id)
        log_r_std = droplets.r_std_px / droplets.r_px
        return Front(
            trajectory_id, droplets, np.full(n, is_detected), np.ones(n, bool), droplets.r_px, log_r_std, np.zeros(n)
        )

    @staticmethod
    def empty() -> "Front":
        """No trajectory."""
        return Front.of(np.empty(0, np.int64), Droplets.empty(), is_detected=True)

    @staticmethod
    def concatenate(parts: "list[Front]") -> "Front":
        """All rows of `parts`, in order."""
        columns = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _OWN}
        return Front(droplets=Droplets.concatenate([part.droplets for part in parts]), **columns)

    @staticmethod
    def to_table(fronts: "list[Front]", first_frame: int) -> pa.Table:
        """Fronts of consecutive frames as rows of `ROWS`: one table for many, for each costs as much as its rows."""
        together = Front.concatenate(fronts)
        frames = first_frame + np.arange(len(fronts), dtype=np.int32)
        droplets = {column.name: getattr(together.droplets, column.name) for column in fields(Droplets)}
        own = {name: getattr(together, name) for name in _OWN}
        columns = {"frame": np.repeat(frames, [len(front) for front in fronts]), **droplets, **own}
        return pa.table({name: columns[name] for name in ROWS.names}, schema=ROWS)

    @staticmethod
    def from_table(rows: pa.Table) -> "Front":
        """The rows of one frame."""
        own = {name: rows[name].to_numpy() for name in _OWN}
        return Front(droplets=Droplets.from_table(rows), **own)


_OWN = [field.name for field in fields(Front) if field.name != "droplets"]


@dataclass(frozen=True)
class Links:
    """Which rows of two fronts are the same trajectory."""

    earlier: Indices
    later: Indices

    @staticmethod
    def between(earlier: Front, later: Front) -> "Links":
        """Trajectories that both fronts have, in the order of their ids."""
        both = in_both(earlier.trajectory_id, later.trajectory_id)
        return Links(both.first, both.second)
