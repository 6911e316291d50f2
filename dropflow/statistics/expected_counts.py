"""Droplets counted by radius where each radius has its error: one near the edge of a bin is partly in the next."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr

Floats = npt.NDArray[np.float64]

_REACH = 2.0
"""Standard deviations; what is further out counts in the last bin that is reached. So each bin that has something of a
droplet has a fiftieth of it at least, for logarithmic scales."""


def shares_of_bins(
    radius_um: Floats, std_um: Floats, edges_um: Floats
) -> Iterator[tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], Floats]]:
    """Which part of each droplet is in which bin: indices of droplets, of bins, and the share, a few bins at a time.

    Bin 0 is all below the first edge, the last one all above the last. ln r is normally distributed; a droplet whose
    error is 0 is in one bin, and one at the last edge in the bin before.

    Parameters
    ----------
    radius_um, std_um
        Shape (n,).
    edges_um
        Shape (n_edges,), ascending; 0 and infinity are possible.
    """
    with np.errstate(divide="ignore"):
        log_edges = np.log(edges_um)
    log_r = np.log(radius_um)
    has_error = std_um > 0
    std = np.where(has_error, std_um / radius_um, 1.0)
    here = np.searchsorted(edges_um, radius_um, side="right")
    here[radius_um == edges_um[-1]] = len(edges_um) - 1
    first = np.where(has_error, np.searchsorted(log_edges, log_r - _REACH * std, side="right"), here)
    last = np.where(has_error, np.searchsorted(log_edges, log_r + _REACH * std, side="right"), here)
    below = np.zeros(len(radius_um))
    which = np.arange(len(radius_um))
    bin_ = first.copy()
    while len(which):
        is_last = bin_[which] == last[which]
        edge = log_edges[np.minimum(bin_[which], len(log_edges) - 1)]
        upto = np.where(is_last, 1.0, ndtr((edge - log_r[which]) / std[which]))
        yield which, bin_[which], upto - below[which]
        below[which] = upto
        which = which[~is_last]
        bin_[which] += 1
