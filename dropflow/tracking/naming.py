"""Final ids: trajectories are numbered in the order in which they begin, rejected ones among them."""

from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.compute as pc

from dropflow.tracking.filtering import VERDICTS
from dropflow.tracking.identification import Indices


@dataclass(frozen=True)
class Names:
    """Trajectories that have rows to come, in the order of the ids they had while they were tracked."""

    tracked_id: Indices
    final_id: Indices
    is_kept: npt.NDArray[np.bool_]
    last_frame: Indices

    @staticmethod
    def none() -> "Names":
        """Before the first frame."""
        nothing = np.empty(0, np.int64)
        return Names(nothing, nothing, np.empty(0, bool), nothing)

    def with_more(self, named: pa.Table, *, frame: int) -> "Names":
        """Add what `number` named; forget what ended before `frame`."""
        more = (
            named["tracked_id"].to_numpy(),
            named["trajectory_id"].to_numpy(),
            pc.equal(named["reason"], "").to_numpy().astype(bool),
            named["last_frame"].to_numpy().astype(np.int64),
        )
        columns = [np.concatenate([getattr(self, f.name), new]) for f, new in zip(fields(self), more, strict=True)]
        goes_on = columns[3] >= frame
        order = np.argsort(columns[0][goes_on], kind="stable")
        return Names(*(column[goes_on][order] for column in columns))

    def of(self, tracked_ids: Indices) -> tuple[Indices, npt.NDArray[np.bool_]]:
        """The final id of each, and whether the trajectory is kept."""
        at = np.searchsorted(self.tracked_id, tracked_ids)
        return self.final_id[at], self.is_kept[at]


def number(verdicts: pa.Table, first_id: int) -> pa.Table:
    """Give ids from `first_id` on to the trajectories of one part, in the order in which they begin.

    Returns the verdicts in that order, `trajectory_id` being the new id and `tracked_id` the old one.
    """
    ordered = verdicts.sort_by([("first_frame", "ascending"), ("trajectory_id", "ascending")])
    tracked = ordered["trajectory_id"]
    final = pa.array(first_id + np.arange(len(ordered)))
    return ordered.set_column(0, VERDICTS.field(0), final).append_column("tracked_id", tracked)
