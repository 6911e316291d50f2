"""The droplets of one frame, each with the trajectory it belongs to."""

from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.droplets import Droplets
from dropflow.tracking.identification import Indices

ROWS = pa.schema(
    [
        ("frame", pa.int32()),
        ("trajectory_id", pa.int64()),
        *((column.name, pa.float64()) for column in fields(Droplets)),
        ("is_detected", pa.bool_()),
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

    def __len__(self) -> int:
        return len(self.trajectory_id)

    def __getitem__(self, which: npt.NDArray[np.bool_] | Indices | slice) -> "Front":
        """The rows at a mask, at indices or in a slice."""
        return Front(self.trajectory_id[which], self.droplets[which], self.is_detected[which])

    def sorted(self) -> "Front":
        """In the order of `trajectory_id`."""
        return self[np.argsort(self.trajectory_id, kind="stable")]

    @staticmethod
    def empty() -> "Front":
        """No trajectory."""
        return Front(np.empty(0, np.int64), Droplets.empty(), np.empty(0, bool))

    @staticmethod
    def concatenate(parts: "list[Front]") -> "Front":
        """All rows of `parts`, in order."""
        return Front(
            np.concatenate([part.trajectory_id for part in parts]),
            Droplets.concatenate([part.droplets for part in parts]),
            np.concatenate([part.is_detected for part in parts]),
        )

    def to_table(self, frame: int) -> pa.Table:
        """These as rows of `ROWS`."""
        droplets = {column.name: getattr(self.droplets, column.name) for column in fields(Droplets)}
        return pa.table(
            {
                "frame": np.full(len(self), frame, np.int32),
                "trajectory_id": self.trajectory_id,
                **droplets,
                "is_detected": self.is_detected,
            },
            schema=ROWS,
        )

    @staticmethod
    def from_table(rows: pa.Table) -> "Front":
        """The rows of one frame."""
        is_detected = rows["is_detected"].to_numpy().astype(bool)
        return Front(rows["trajectory_id"].to_numpy().astype(np.int64), Droplets.from_table(rows), is_detected)


@dataclass(frozen=True)
class Links:
    """Which rows of two fronts are the same trajectory."""

    earlier: Indices
    later: Indices

    @staticmethod
    def between(earlier: Front, later: Front) -> "Links":
        """Trajectories that both fronts have, in the order of their ids."""
        _, in_earlier, in_later = np.intersect1d(
            earlier.trajectory_id, later.trajectory_id, assume_unique=True, return_indices=True
        )
        return Links(in_earlier, in_later)
