"""Where the flow must be wrong: far fewer droplets than usual are where it takes them."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree
from scipy.special import bdtr

from dropflow.tracking.grid import Column
from dropflow.tracking.probable.least_squares import Observations

_N_NEAR = 12
"""Expected droplets that are looked at together."""
_FEW = 0.5
"""Of the usual number found."""
_BY_CHANCE = 0.2
"""Lost places, on average, that a frame shows where there are none."""


@dataclass(frozen=True)
class LostPlaces:
    """The places that are nearest to some of the expected droplets."""

    tree: cKDTree
    """Of all expected droplets."""
    is_lost: npt.NDArray[np.bool_]
    """Of each of them."""

    def without(self, seen: Observations) -> Observations:
        """What was seen elsewhere."""
        _, nearest = self.tree.query(np.column_stack([seen.x_px, seen.y_px]))
        return seen[~self.is_lost[nearest]]


def lost_places(x_px: Column, y_px: Column, is_found: npt.NDArray[np.bool_]) -> LostPlaces | None:
    """Around which droplets fewer were found than chance explains, by the share that was found in the whole frame.

    Parameters
    ----------
    x_px, y_px : ndarray, float64, shape (n,)
        Where droplets are expected; only such as should be in the frame.
    is_found : ndarray, bool, shape (n,)
        Whether each of them was.

    Returns
    -------
    LostPlaces or None
        The surroundings, of sixteen droplets each, in which so few were found; None if there are none.
    """
    n_near = min(_N_NEAR, len(x_px))
    missing = np.flatnonzero(~is_found)
    if not len(missing):
        return None
    places = np.column_stack([x_px, y_px])
    tree = cKDTree(places)
    near = np.reshape(tree.query(places[missing], n_near)[1], (len(missing), n_near))
    n_found, usual = is_found[near].sum(axis=1), is_found.mean()
    is_few = n_found < _FEW * usual * n_near
    lost = near[is_few & (bdtr(n_found, n_near, usual) * len(missing) < _BY_CHANCE)]
    if not lost.size:
        return None
    is_lost = np.zeros(len(places), bool)
    is_lost[lost] = True
    return LostPlaces(tree, is_lost)
