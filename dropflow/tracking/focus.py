"""Which trajectories are of droplets in focus: the depth of field of a film, from the film itself.

A droplet out of the focal plane is blurred, and the less contrast its edge has, the worse it matches a circle. The
depth of field ends where the match is half of what it is in focus, as widths are usually measured. A detector that
takes sharp droplets alone leaves hardly any below that; then none is left out.
"""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.tracking.grid import Column

_LOG_MATCH = np.linspace(-16.0, 8.0, 1201)
"""Edges of the bins of ln match, 2 % wide."""
_SHARP_QUANTILE = 0.75
"""Of the matches of trajectories, counted by their droplets: the one taken for that of a droplet in focus."""
_LEAST_SHARE = 0.5
"""Match at the edge of the depth of field, over that in focus."""
_LEAST_BLURRED = 0.05
"""Share of trajectories below it that shows that there are droplets out of focus: fewer are others, such as those that
are partly covered."""


@dataclass
class MatchCensus:
    """Trajectories by their mean match, gathered table by table; its size does not grow with them."""

    n_trajectories: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros(len(_LOG_MATCH) + 1, np.int64))
    n_droplets: npt.NDArray[np.int64] = field(default_factory=lambda: np.zeros(len(_LOG_MATCH) + 1, np.int64))

    def add(self, match: Column, n_frames: npt.NDArray[np.int64]) -> None:
        """Trajectories with their mean match (not a number where none is known) and their numbers of frames."""
        is_known = match > 0
        which = np.searchsorted(_LOG_MATCH, np.log(match[is_known]))
        self.n_trajectories += np.bincount(which, minlength=len(_LOG_MATCH) + 1)
        self.n_droplets += np.bincount(which, n_frames[is_known], len(_LOG_MATCH) + 1).astype(np.int64)

    def least_match(self) -> float:
        """Mean match below which a trajectory is out of focus; 0 where the film shows no droplets out of focus."""
        cumulated = np.cumsum(self.n_droplets)
        if not cumulated[-1]:
            return 0.0
        sharp = _LOG_MATCH[min(int(np.searchsorted(cumulated, _SHARP_QUANTILE * cumulated[-1])), len(_LOG_MATCH) - 1)]
        least = float(sharp + np.log(_LEAST_SHARE))
        n_below = int(self.n_trajectories[: int(np.searchsorted(_LOG_MATCH, least))].sum())
        return float(np.exp(least)) if n_below >= _LEAST_BLURRED * self.n_trajectories.sum() else 0.0


def mean_matches(rows: pa.Table) -> Column:
    """For each row of whole trajectories, sorted, the mean match (of logarithms) of its trajectory; NaN: none known."""
    ids, match = rows["trajectory_id"].to_numpy(), rows["match"].to_numpy()
    _, of_row = np.unique(ids, return_inverse=True)
    is_known = match > 0
    n = np.bincount(of_row[is_known], minlength=len(ids))
    total = np.bincount(of_row[is_known], np.log(match[is_known]), minlength=len(ids))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.exp(total / n)[of_row])
