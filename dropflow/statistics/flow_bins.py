"""Moments of the flow in bins of time, as four bins an oscillation (section 4.6, Fig. 14)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.statistics.flow_moments import FlowMoments

Floats = npt.NDArray[np.float64]

BINS_PER_OSCILLATION = 4


@dataclass(frozen=True)
class BinnedFlow:
    """Moments of the flow in bins of time, each of shape (n, 2): horizontal, upward. NaN where no step has flow."""

    time_s: Floats
    """Shape (n,)."""
    mean_um_s: Floats
    mean_std_um_s: Floats
    rms_um_s: Floats
    rms_std_um_s: Floats


def bin_flow(moments: FlowMoments, edges_s: Floats, *, correlation_time_s: float) -> BinnedFlow:
    """Mean and rms over the steps in each bin, with standard errors.

    Steps nearer than the correlation time say the same twice: a bin counts as its duration over twice that time, or as
    its number of steps if that is less.
    """
    which = np.searchsorted(edges_s, moments.time_s, side="right") - 1
    rows = []
    for number in range(len(edges_s) - 1):
        inside = (which == number) & np.isfinite(moments.mean_um_s[:, 0])
        n = int(inside.sum())
        if not n:
            rows.append((np.full(2, np.nan),) * 4)
            continue
        duration_s = edges_s[number + 1] - edges_s[number]
        n_independent = min(n, max(1.0, duration_s / (2 * correlation_time_s))) if correlation_time_s > 0 else n
        mean, square = moments.mean_um_s[inside], moments.rms_um_s[inside] ** 2
        rms = np.sqrt(square.mean(axis=0))
        spread = np.sqrt(n_independent) if n > 1 else np.nan
        square_error = square.std(axis=0) / spread
        with np.errstate(invalid="ignore", divide="ignore"):
            rms_error = np.where(rms > 0, square_error / (2 * rms), 0.0)
        rows.append((mean.mean(axis=0), mean.std(axis=0) / spread, rms, rms_error))
    columns = [np.array([row[index] for row in rows]).reshape(-1, 2) for index in range(4)]
    return BinnedFlow((edges_s[1:] + edges_s[:-1]) / 2, *columns)


def edges_of_oscillations(peak_s: Floats, n_bins: int = BINS_PER_OSCILLATION) -> Floats:
    """Edges that divide each period between peaks into `n_bins`, shape (n_periods * n_bins + 1,)."""
    at = np.arange((len(peak_s) - 1) * n_bins + 1) / n_bins
    return np.asarray(np.interp(at, np.arange(len(peak_s)), peak_s))
