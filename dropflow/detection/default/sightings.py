"""Circles that may be droplets, with what was measured of each."""

from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.features import N_FEATURES, VOTES
from dropflow.detection.default.overlaps import is_best_of_its_kind

Column = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Rows = npt.NDArray[np.int64]

_SAME_DISTANCE, _SAME_RATIO = 0.2, 1.2
"""Fits as near as this have ended on the same circle."""
_NEAR_DISTANCE, _NEAR_RATIO = 0.3, 1.3
"""Fits that begin as near as this will end on the same circle."""
_TWICE_DISTANCE, _TWICE_RATIO = 0.5, 1.35
"""Circles as near as this are one droplet found twice."""


@dataclass(frozen=True, eq=False)
class Sightings:
    """n circles that may be droplets, pixels of the frame, with their features, shape (n, features)."""

    x_px: Column
    y_px: Column
    r_px: Column
    features: Column
    first_log_odds: Column
    """Of being a droplet after the first look, NaN where nobody has asked."""

    @staticmethod
    def unmeasured(x_px: Column, y_px: Column, r_px: Column, votes: Column | None = None) -> "Sightings":
        """Circles of which only the votes are known, or nothing."""
        features = np.full((len(x_px), N_FEATURES), np.nan)
        if votes is not None:
            features[:, VOTES] = votes
        return Sightings(x_px, y_px, r_px, features, np.full(len(x_px), np.nan))

    def __len__(self) -> int:
        return len(self.x_px)

    def __getitem__(self, which: Flags | Rows | slice) -> "Sightings":
        return Sightings(*(getattr(self, field.name)[which] for field in fields(self)))

    def followed_by(self, other: "Sightings") -> "Sightings":
        """Both as one."""
        pairs = ((getattr(self, field.name), getattr(other, field.name)) for field in fields(self))
        return Sightings(*(np.concatenate(pair) for pair in pairs))

    def circles(self) -> Column:
        """x, y and r, shape (n, 3)."""
        return np.column_stack([self.x_px, self.y_px, self.r_px])

    def best(self, goodness: Column) -> Flags:
        """Which are not a worse sighting of another's droplet."""
        return is_best_of_its_kind(
            self.x_px, self.y_px, self.r_px, goodness, distance=_TWICE_DISTANCE, ratio=_TWICE_RATIO
        )

    def unique(self) -> "Sightings":
        """Without fits that have ended on the same circle; the one that had most votes stays."""
        return self._of_most_votes(_SAME_DISTANCE, _SAME_RATIO)

    def apart(self) -> "Sightings":
        """Without candidates so near to one with more votes that their fits would end on the same circle."""
        return self._of_most_votes(_NEAR_DISTANCE, _NEAR_RATIO)

    def _of_most_votes(self, distance: float, ratio: float) -> "Sightings":
        votes = self.features[:, VOTES]
        return self[is_best_of_its_kind(self.x_px, self.y_px, self.r_px, votes, distance=distance, ratio=ratio)]
