"""All pairs of a predicted and a found droplet that are not out of the question, with their likelihoods."""

from math import lgamma, log, pi

import numba
import numpy as np
import numpy.typing as npt

from dropflow.tracking.grid import Column
from dropflow.tracking.identification import Indices

TAIL = 6.0
"""Degrees of freedom of the t distributions with which outliers are reckoned."""
_REACH_STD = 4.5
"""A detection further from its prediction than this many standard deviations is not thought of."""
_RADIUS_MODEL_STD = 0.03
"""Standard deviation of ln r between frames beyond its known errors."""
_LEAST_LOG_ODDS = -6.0
"""Pairs less probable than this against chance are left out."""
_MOST_CANDIDATES = 32
"""Of one droplet: a heap of detections in one place must not cost the square of their number."""
_MOST_ROUNDS = 25
_CONVERGED = 1e-3
_MOST_LOG_ODDS = 20.0
_LOG_T_NORM = lgamma((TAIL + 1) / 2) - lgamma(TAIL / 2) - log(TAIL * pi) / 2
_LOG_2_PI = log(2 * pi)

Found = tuple[Indices, Indices, Column, Column]
"""Indices of predicted and of found droplets, log odds, squared Mahalanobis distances; the first ascending."""


@numba.njit(cache=True)
def possible_pairs(
    expected: Column, seen: Column, log_odds: Column, up: tuple[float, float]
) -> Found:  # pragma: no cover - compiled
    """Weigh the pairs of droplets that are near enough to each other for the errors of both.

    Parameters
    ----------
    expected : ndarray, float64, shape (6, n)
        Of predicted droplets x, y, variance of the place across `up` and along it, ln r and its variance.
    seen : ndarray, float64, shape (5, m)
        Of found droplets x, y, variance of the place, ln r and its variance.
    log_odds : ndarray, float64, shape (m,)
        What is added to the likelihoods of each found droplet.
    up : (float, float)
    """
    n = expected.shape[1]
    cell_px, low_x, low_y, n_columns, n_rows, start, order = _cells(seen)
    first, second = np.empty(4 * n + 64, np.int64), np.empty(4 * n + 64, np.int64)
    weight, squares = np.empty(4 * n + 64), np.empty(4 * n + 64)
    count = 0
    for one in range(n):
        if count + _MOST_CANDIDATES > len(first):
            first, second = np.append(first, np.empty_like(first)), np.append(second, np.empty_like(second))
            weight, squares = np.append(weight, np.empty_like(weight)), np.append(squares, np.empty_like(squares))
        begin = count
        x, y = expected[0, one], expected[1, one]
        reach = _REACH_STD * np.sqrt(max(expected[2, one], expected[3, one])) + 1.0
        left = max(int(np.floor((x - reach - low_x) / cell_px)), 0)
        right = min(int(np.floor((x + reach - low_x) / cell_px)), n_columns - 1)
        top = max(int(np.floor((y - reach - low_y) / cell_px)), 0)
        bottom = min(int(np.floor((y + reach - low_y) / cell_px)), n_rows - 1)
        for row in range(top, bottom + 1):
            if right < left:
                break
            for at in range(start[row * n_columns + left], start[row * n_columns + right + 1]):
                other = order[at]
                off_x, off_y = seen[0, other] - x, seen[1, other] - y
                if off_x * off_x + off_y * off_y > reach * reach:
                    continue
                odds, square = _log_likelihood(expected[:, one], seen[:, other], up)
                odds += log_odds[other]
                if odds <= _LEAST_LOG_ODDS:
                    continue
                slot = count
                if count - begin == _MOST_CANDIDATES:
                    slot = begin + int(np.argmin(weight[begin:count]))
                    if weight[slot] >= odds:
                        continue
                else:
                    count += 1
                first[slot], second[slot], weight[slot], squares[slot] = one, other, odds, square
    return first[:count], second[:count], weight[:count], squares[:count]


@numba.njit(cache=True)
def _log_likelihood(
    expected: Column, seen: Column, up: tuple[float, float]
) -> tuple[float, float]:  # pragma: no cover - compiled
    """Of one pair, and its squared Mahalanobis distance; of a pair that is out of the question minus infinity."""
    off_x, off_y = seen[0] - expected[0], seen[1] - expected[1]
    across, along = -up[1] * off_x + up[0] * off_y, up[0] * off_x + up[1] * off_y
    across_variance, along_variance = expected[2] + seen[2], expected[3] + seen[2]
    square = across * across / across_variance + along * along / along_variance
    if square >= 2 * _REACH_STD**2:
        return -np.inf, square
    place = -_LOG_2_PI - np.log(across_variance * along_variance) / 2
    place -= (TAIL / 2 + 1) * np.log1p(square / TAIL)
    variance = expected[5] + seen[4] + _RADIUS_MODEL_STD**2
    log_ratio = seen[3] - expected[4]
    radius = _LOG_T_NORM - np.log(variance) / 2
    radius -= (TAIL + 1) / 2 * np.log1p(log_ratio * log_ratio / variance / TAIL)
    return place + radius, square


@numba.njit(cache=True)
def _cells(
    seen: Column,
) -> tuple[float, float, float, int, int, Indices, Indices]:  # pragma: no cover - compiled
    """Found droplets sorted into square cells, two in each on average: edge, corner, numbers, starts, droplets."""
    m = seen.shape[1]
    low_x, low_y = seen[0].min(), seen[1].min()
    width, height = seen[0].max() - low_x + 1.0, seen[1].max() - low_y + 1.0
    cell_px = max(np.sqrt(2 * width * height / m), width / 2000, height / 2000)
    n_columns, n_rows = int(width / cell_px) + 1, int(height / cell_px) + 1
    cell = np.empty(m, np.int64)
    start = np.zeros(n_columns * n_rows + 1, np.int64)
    for k in range(m):
        cell[k] = int((seen[1, k] - low_y) / cell_px) * n_columns + int((seen[0, k] - low_x) / cell_px)
        start[cell[k] + 1] += 1
    start = np.cumsum(start)
    free = start.copy()
    order = np.empty(m, np.int64)
    for k in range(m):
        order[free[cell[k]]] = k
        free[cell[k]] += 1
    return cell_px, low_x, low_y, n_columns, n_rows, start, order


@numba.njit(cache=True)
def pair_probabilities(
    first: Indices, second: Indices, log_weight: Column, n_first: int, n_second: int
) -> npt.NDArray[np.float64]:  # pragma: no cover - compiled
    """Probability of each pair from its log odds against both ends being alone, by belief propagation.

    For each end the probabilities of its pairs sum to one at most.
    """
    n = len(first)
    weight = np.exp(np.minimum(log_weight, _MOST_LOG_ODDS))
    message, claim = np.ones(n), np.empty(n)
    for _ in range(_MOST_ROUNDS):
        of_first, of_second = np.zeros(n_first), np.zeros(n_second)
        for pair in range(n):
            of_first[first[pair]] += weight[pair] * message[pair]
        for pair in range(n):
            others = max(of_first[first[pair]] - weight[pair] * message[pair], 0.0)
            claim[pair] = weight[pair] / (1 + others)
            of_second[second[pair]] += claim[pair]
        change = 0.0
        for pair in range(n):
            updated = 1 / (1 + max(of_second[second[pair]] - claim[pair], 0.0))
            change = max(change, abs(updated - message[pair]))
            message[pair] = updated
        if change < _CONVERGED:
            break
    product = weight * message
    of_first = np.zeros(n_first)
    for pair in range(n):
        of_first[first[pair]] += product[pair]
    for pair in range(n):
        product[pair] /= 1 + of_first[first[pair]]
    return product
