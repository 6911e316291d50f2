"""The flow between two frames of which nothing is known yet.

The paper predicts with the flow of the step before (section 3.2.1); the first step has none. Here each droplet's
displacement is elected by its neighbours: of all similar droplets in the next frame it takes the one whose
displacement, after sedimentation, agrees with what its neighbours may have done, and these agree in turn
(relaxation labelling, Baek and Lee, Exp. Fluids 22 (1996) 23-32).
"""

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices, Pairs, greedy

_REACH_SPACINGS = 4.0
"""Displacements by the flow are looked for up to this many mean droplet spacings."""
_N_CANDIDATES = 48
_N_VOTERS = 8
_N_ROUNDS = 12
_TOLERANCE_SPACINGS = 0.1
"""Displacements of neighbours may differ by this, and by as much again for each spacing between them."""
_VOTE = 4.0
"""How strongly one agreeing neighbour raises a candidate's odds in a round."""
_LEAST_AGREEMENT = 0.3
"""Share of the neighbours that must stand behind a displacement."""


@dataclass(frozen=True)
class _Candidates:
    """Possible displacements; those of droplet `i` stand at ``start[i]:start[i + 1]``."""

    start: Indices
    found: Indices
    displacement_px: Column

    @property
    def droplet(self) -> Indices:
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))


def elect_pairs(
    predicted: Droplets, found: Droplets, *, spacing_px: float, similar_ratio: tuple[float, float]
) -> Pairs:
    """Pair droplets of one frame, moved by sedimentation alone, with those of the next, whatever the flow.

    Parameters
    ----------
    predicted : Droplets
        Droplets of the first frame where sedimentation alone would have taken them.
    found : Droplets
        Droplets of the second frame.
    spacing_px : float
        Mean distance between droplets, px: displacements up to four times this are found.
    similar_ratio : (float, float)
        Ratio of radii that can be one droplet.

    Returns
    -------
    Pairs
        Only droplets whose displacement at least three tenths of their neighbours share.
    """
    if len(predicted) < 2 or not len(found):
        return Pairs(np.empty(0, np.int64), np.empty(0, np.int64))
    candidates = _candidates(predicted, found, spacing_px, similar_ratio)
    voters, tolerance_px = _voters(predicted, spacing_px)
    support = _relax(candidates, voters, tolerance_px)
    agreed = np.flatnonzero(support >= _LEAST_AGREEMENT)
    return greedy(candidates.droplet[agreed], candidates.found[agreed], -support[agreed])


def _candidates(
    predicted: Droplets, found: Droplets, spacing_px: float, similar_ratio: tuple[float, float]
) -> _Candidates:
    places, targets = (np.column_stack([some.x_px, some.y_px]) for some in (predicted, found))
    n_nearest = min(_N_CANDIDATES, len(found))
    _, index = cKDTree(targets).query(places, n_nearest, distance_upper_bound=_REACH_SPACINGS * spacing_px)
    index = np.reshape(index, (len(places), n_nearest))
    ratio = predicted.r_px[:, None] / np.append(found.r_px, np.nan)[index]
    is_candidate = (ratio > similar_ratio[0]) & (ratio < similar_ratio[1])
    droplet, rank = np.nonzero(is_candidate)
    start = np.concatenate([[0], np.cumsum(is_candidate.sum(axis=1))])
    target = index[droplet, rank]
    return _Candidates(start, target, np.ascontiguousarray(targets[target] - places[droplet]))


def _voters(predicted: Droplets, spacing_px: float) -> tuple[Indices, Column]:
    """The nearest others of each droplet, shape (n, n_voters), and how far their displacements may differ."""
    places = np.column_stack([predicted.x_px, predicted.y_px])
    n_nearest = min(_N_VOTERS + 1, len(places))
    distance, index = cKDTree(places).query(places, n_nearest)
    is_itself = index == np.arange(len(places))[:, None]
    is_itself[~is_itself.any(axis=1), -1] = True  # in a heap of more than n_voters at one place
    others = ~is_itself
    shape = (len(places), n_nearest - 1)
    return index[others].reshape(shape), _TOLERANCE_SPACINGS * (spacing_px + distance[others].reshape(shape))


def _relax(candidates: _Candidates, voters: Indices, tolerance_px: Column) -> Column:
    """Share of the neighbours behind each candidate after the last round, shape (n_candidates,), 0 to 1."""
    n_choices = np.diff(candidates.start)
    probability = np.repeat(1.0 / np.maximum(n_choices, 1), n_choices)
    support = np.zeros(len(probability))
    for _ in range(_N_ROUNDS):
        support = _support(candidates.start, candidates.displacement_px, probability, voters, tolerance_px)
        probability = probability * (1 + _VOTE * support * voters.shape[1])
        total = np.add.reduceat(np.append(probability, 0.0), candidates.start[:-1])
        probability /= np.repeat(total, n_choices)
    return support * probability


@numba.njit(cache=True)
def _support(
    start: Indices, displacement_px: Column, probability: Column, voters: Indices, tolerance_px: Column
) -> npt.NDArray[np.float64]:
    support = np.zeros(len(probability))
    n_voters = voters.shape[1]
    for droplet in range(len(start) - 1):
        for choice in range(start[droplet], start[droplet + 1]):
            for rank in range(n_voters):
                voter = voters[droplet, rank]
                width = 2 * tolerance_px[droplet, rank] ** 2
                for theirs in range(start[voter], start[voter + 1]):
                    across = displacement_px[theirs, 0] - displacement_px[choice, 0]
                    along = displacement_px[theirs, 1] - displacement_px[choice, 1]
                    distance = (across * across + along * along) / width
                    if distance < 8.0:
                        support[choice] += probability[theirs] * np.exp(-distance)
            support[choice] /= n_voters
    return support
