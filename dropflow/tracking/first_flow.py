"""The flow between two frames of which nothing is known yet.

The paper predicts with the flow of the step before (section 3.2.1); the first step has none. Here each droplet's
displacement is elected by its neighbours: of all similar droplets in the next frame it takes the one whose
displacement, after sedimentation, agrees with what its neighbours may have done, and these agree in turn
(relaxation labelling, Baek and Lee, Exp. Fluids 22 (1996) 23-32).
"""

from dataclasses import dataclass, replace

import numba
import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from dropflow.droplets import Droplets
from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices, Pairs, greedy

_REACH_SPACINGS = 6.0
"""Displacements by the flow are looked for up to this many mean droplet spacings."""
_N_NEAREST = 128
"""Of the droplets in reach; so many are in a circle of six spacings."""
_MOST_RADIUS_DEVIATION = 3.0
_RADIUS_MODEL_STD = 0.03
"""Standard deviation of ln r between frames beyond its known errors."""
_N_VOTERS = 8
_N_ROUNDS = 12
_LEAST_TOLERANCE_SPACINGS = 0.1
_SHEARS = (0.1, 0.3, 0.6, 1.0)
"""By how much the displacements of neighbours may differ, over the distance between them; tried one after another."""
_CHANCE_SHARES = (0.08, 0.25, 0.28, 0.28)
"""Share of droplets that is elected, for each shear, among random places; of few droplets more (next line)."""
_CHANCE_SPREAD = 0.6
"""Over the root of the number of droplets."""
_CLEAR_SHARE = 0.6
"""So many elected need no more tolerance."""
_VOTE = 4.0
"""How strongly one agreeing neighbour raises a candidate's odds in a round."""
_NEGLIGIBLE = 1e-4
"""A candidate less probable than this is voted for no more and has no voice."""
_LEAST_AGREEMENT = 0.3
"""Share of the neighbours, beyond chance, that must stand behind a displacement."""


@dataclass(frozen=True)
class _Candidates:
    """Possible displacements; those of droplet `i` stand at ``start[i]:start[i + 1]``."""

    start: Indices
    found: Indices
    displacement_px: Column
    probability: Column
    """By the radii alone; those of a droplet sum to one."""

    @property
    def droplet(self) -> Indices:
        return np.repeat(np.arange(len(self.start) - 1), np.diff(self.start))

    def normalised(self, probability: Column) -> Column:
        """Scaled so that those of each droplet sum to one."""
        total = np.add.reduceat(np.append(probability, 0.0), self.start[:-1])
        return np.asarray(probability / np.repeat(total, np.diff(self.start)))


def elect_pairs(predicted: Droplets, found: Droplets, *, spacing_px: float) -> Pairs:
    """Pair droplets of one frame, moved by sedimentation alone, with those of the next, whatever the flow.

    Parameters
    ----------
    predicted : Droplets
        Droplets of the first frame where sedimentation alone would have taken them.
    found : Droplets
        Droplets of the second frame.
    spacing_px : float
        Mean distance between droplets, px: displacements up to six times this are found.

    Returns
    -------
    Pairs
        Only droplets with whose displacement at least three tenths of their neighbours agree, beyond chance. None at
        all if they are so few that droplets without any common motion would elect as many.
    """
    nobody = Pairs(np.empty(0, np.int64), np.empty(0, np.int64))
    if len(predicted) < 2 or not len(found):
        return nobody
    candidates = _candidates(predicted, found, _REACH_SPACINGS * spacing_px)
    voters, distance_px = _voters(predicted)
    n_possible = min(len(predicted), len(found))
    best = nobody
    for shear, chance in zip(_SHEARS, _CHANCE_SHARES, strict=True):
        tolerance_px = _LEAST_TOLERANCE_SPACINGS * spacing_px + shear * distance_px
        elected = _elect(candidates, voters, tolerance_px, _REACH_SPACINGS * spacing_px)
        is_beyond_chance = len(elected) > (chance + _CHANCE_SPREAD / np.sqrt(n_possible)) * n_possible
        if is_beyond_chance and len(elected) > len(best):
            best = elected
        if len(best) > _CLEAR_SHARE * n_possible:
            break
    return best


def _candidates(predicted: Droplets, found: Droplets, reach_px: float) -> _Candidates:
    """All displacements to droplets in reach whose radius may be the same."""
    places, targets = (np.column_stack([some.x_px, some.y_px]) for some in (predicted, found))
    n_nearest = min(_N_NEAREST, len(found))
    _, index = cKDTree(targets).query(places, n_nearest, distance_upper_bound=reach_px)
    index = np.reshape(index, (len(places), n_nearest))
    log_r, theirs = np.log(predicted.r_px), np.append(np.log(found.r_px), np.nan)
    std, their_std = predicted.r_std_px / predicted.r_px, np.append(found.r_std_px / found.r_px, np.nan)
    variance = std[:, None] ** 2 + their_std[index] ** 2 + _RADIUS_MODEL_STD**2
    squared = (theirs[index] - log_r[:, None]) ** 2 / variance
    is_candidate = squared < _MOST_RADIUS_DEVIATION**2
    droplet, rank = np.nonzero(is_candidate)
    start = np.concatenate([[0], np.cumsum(is_candidate.sum(axis=1))])
    target = index[droplet, rank]
    displacement_px = np.ascontiguousarray(targets[target] - places[droplet])
    candidates = _Candidates(start, target, displacement_px, np.exp(-squared[droplet, rank] / 2))
    return replace(candidates, probability=candidates.normalised(candidates.probability))


def _voters(predicted: Droplets) -> tuple[Indices, Column]:
    """The nearest others of each droplet and how far away they are, both of shape (n, n_voters)."""
    places = np.column_stack([predicted.x_px, predicted.y_px])
    n_nearest = min(_N_VOTERS + 1, len(places))
    distance, index = cKDTree(places).query(places, n_nearest)
    is_itself = index == np.arange(len(places))[:, None]
    is_itself[~is_itself.any(axis=1), -1] = True  # in a heap of more than n_voters at one place
    shape = (len(places), n_nearest - 1)
    return index[~is_itself].reshape(shape), distance[~is_itself].reshape(shape)


def _elect(candidates: _Candidates, voters: Indices, tolerance_px: Column, reach_px: float) -> Pairs:
    """Let neighbours vote in rounds; each droplet's candidate with enough of them behind it is elected."""
    probability, support = candidates.probability, np.zeros(len(candidates.found))
    for _ in range(_N_ROUNDS):
        support = _support(candidates.start, candidates.displacement_px, probability, voters, tolerance_px)
        probability = candidates.normalised(probability * (1 + _VOTE * support * voters.shape[1]))
    # Votes spread evenly over the circle in reach would give so much to any displacement.
    chance = (2 * tolerance_px**2 / reach_px**2).mean(axis=1)[candidates.droplet]
    agreement = support * probability - chance
    agreed = np.flatnonzero(agreement >= _LEAST_AGREEMENT)
    return greedy(candidates.droplet[agreed], candidates.found[agreed], -agreement[agreed])


@numba.njit(cache=True)
def _support(
    start: Indices, displacement_px: Column, probability: Column, voters: Indices, tolerance_px: Column
) -> npt.NDArray[np.float64]:
    support = np.zeros(len(probability))
    n_voters = voters.shape[1]
    for droplet in range(len(start) - 1):
        for choice in range(start[droplet], start[droplet + 1]):
            if probability[choice] < _NEGLIGIBLE:
                continue
            for rank in range(n_voters):
                voter = voters[droplet, rank]
                width = 2 * tolerance_px[droplet, rank] ** 2
                for theirs in range(start[voter], start[voter + 1]):
                    if probability[theirs] < _NEGLIGIBLE:
                        continue
                    across = displacement_px[theirs, 0] - displacement_px[choice, 0]
                    along = displacement_px[theirs, 1] - displacement_px[choice, 1]
                    distance = (across * across + along * along) / width
                    if distance < 8.0:
                        support[choice] += probability[theirs] * np.exp(-distance)
            support[choice] /= n_voters
    return support
