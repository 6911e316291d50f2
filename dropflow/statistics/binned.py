"""Means of a quantity in bins of another, with standard errors: the form of most figures against radius."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class BinnedMean:
    """One value a bin; NaN where a bin is empty, and an error needs two entries at least."""

    edges: Floats
    """Shape (n_bins + 1,)."""
    x: Floats
    """Mean of the binned quantity in each bin, shape (n_bins,); the bin's middle where it is empty."""
    mean: Floats
    """Shape (n_bins,)."""
    std: Floats
    """Scatter within the bin, shape (n_bins,)."""
    standard_error: Floats
    """Of the mean if entries are independent, shape (n_bins,)."""
    n: npt.NDArray[np.int64]
    """Entries, shape (n_bins,)."""


def binned_mean(x: Floats, y: Floats, edges: Floats) -> BinnedMean:
    """Mean of `y` in bins of `x`; entries outside the edges or not finite are left out."""
    is_used = np.isfinite(x) & np.isfinite(y) & (x >= edges[0]) & (x < edges[-1])
    x, y = x[is_used], y[is_used]
    n_bins = len(edges) - 1
    which = np.searchsorted(edges, x, side="right") - 1
    n = np.bincount(which, minlength=n_bins)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.bincount(which, y, n_bins) / n
        square = np.bincount(which, (y - mean[which]) ** 2, n_bins)
        std = np.sqrt(np.where(n > 1, square / (n - 1), np.nan))
        middle = np.where(n > 0, np.bincount(which, x, n_bins) / n, (edges[1:] + edges[:-1]) / 2)
        return BinnedMean(edges, middle, mean, std, std / np.sqrt(n), n.astype(np.int64))
