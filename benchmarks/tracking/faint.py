"""Trajectories whose droplets fit the image poorly: out of focus, where the detector takes these as well."""

import numpy as np
import pyarrow as pa

from dropflow.tracking.grid import Column


def without_faint(trajectories: pa.Table) -> tuple[pa.Table, float]:
    """The rows of trajectories whose mean match (of logarithms) is above the valley between two classes, and that.

    The valley is where both classes together have the least variance (N. Otsu, IEEE Trans. Syst. Man Cybern. 9 (1979)
    62-66); the truth is not asked.
    """
    ids, match = trajectories["trajectory_id"].to_numpy(), trajectories["match"].to_numpy()
    is_known = match > 0  # a droplet that nobody saw has none
    _, of_row = np.unique(ids, return_inverse=True)
    n = of_row.max() + 1
    total = np.bincount(of_row[is_known], np.log(match[is_known]), n)
    mean = total / np.maximum(np.bincount(of_row[is_known], minlength=n), 1)
    cut = _valley(mean)
    return trajectories.filter(pa.array(mean[of_row] > cut)), float(np.exp(cut))


def _valley(values: Column) -> float:
    ordered, n = np.sort(values), len(values)
    below = np.arange(1, n)
    sums = np.cumsum(ordered)
    gap = (sums[-1] - sums[:-1]) / (n - below) - sums[:-1] / below
    best = int(np.argmax(below * (n - below) * gap**2))
    return float(ordered[best] + ordered[best + 1]) / 2
