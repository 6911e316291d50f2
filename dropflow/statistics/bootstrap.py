"""Uncertainty from the data themselves, where no formula gives it: drawing trajectories again, with replacement."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

N_REPLICATES = 100
MOST_DRAWN = 5000


def bootstrap_std(
    statistic: Callable[[npt.NDArray[np.int64], Floats], float],
    n: int,
    *,
    n_replicates: int = N_REPLICATES,
    most_drawn: int = MOST_DRAWN,
    seed: int = 0,
) -> float:
    """Standard deviation of a statistic over samples drawn again from `n` independent entries.

    Parameters
    ----------
    statistic
        Called with the indices of entries and a weight for each, of equal shape; entries weigh as often as they were
        drawn (Poisson, mean 1, which for many entries is drawing with replacement).
    n
        Entries there are, such as trajectories.
    most_drawn
        Of more entries so many are taken at random, and the result is scaled by the square root of their share: the
        bootstrap of m out of n.
    seed
        The same seed gives the same answer.

    Returns
    -------
    NaN where fewer than ten replicates give a finite value.
    """
    if n < 2:
        return float("nan")
    rng = np.random.default_rng(seed)
    entries = np.arange(n) if n <= most_drawn else np.sort(rng.choice(n, most_drawn, replace=False))
    weights = rng.poisson(1.0, (n_replicates, len(entries))).astype(np.float64)
    values = np.array([statistic(entries, weight) for weight in weights])
    values = values[np.isfinite(values)]
    if len(values) < 10:
        return float("nan")
    return float(values.std(ddof=1) * np.sqrt(len(entries) / n))
