"""Oscillations of the size distribution: where they are, how long they take, how that goes with the driving (4.7)."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from dropflow.statistics.histograms import FrameHistograms, coarsen
from dropflow.statistics.size_distribution import size_moments

Floats = npt.NDArray[np.float64]


class Signal(StrEnum):
    """What oscillates, as one number a time."""

    SAUTER_RADIUS = "sauter_radius"
    MEAN_RADIUS = "mean_radius"
    N_DROPLETS = "n_droplets"
    N_SMALL = "n_small"
    """Droplets in the lower third of the radius bins: each wave of nucleation makes many."""


@dataclass(frozen=True)
class Oscillations:
    """Peaks of a signal and the periods between them."""

    signal_name: Signal
    time_s: Floats
    """Times of the signal, shape (n,)."""
    signal: Floats
    """Its relative deviation from the slow trend, smoothed, shape (n,)."""
    peak_s: Floats
    """Times of the peaks, shape (n_peaks,)."""
    peak_std_s: Floats
    """How well each time is known, shape (n_peaks,)."""
    is_certain: npt.NDArray[np.bool_]
    """Whether each peak stands out: see `find_oscillations`, shape (n_peaks,)."""

    @property
    def period_s(self) -> Floats:
        """Time from each peak to the next, shape (n_peaks - 1,)."""
        return np.diff(self.peak_s)

    @property
    def period_std_s(self) -> Floats:
        """Standard error of each period."""
        return np.hypot(self.peak_std_s[1:], self.peak_std_s[:-1])

    @property
    def period_at_s(self) -> Floats:
        """Middle of each period."""
        return (self.peak_s[1:] + self.peak_s[:-1]) / 2

    @property
    def is_period_certain(self) -> npt.NDArray[np.bool_]:
        """Whether both peaks of each period are certain."""
        return self.is_certain[1:] & self.is_certain[:-1]


MAX_POINTS = 4096
_LEAST_POINTS = 8
_CLEAR_PROMINENCE = 4.0
"""In standard deviations of the smoothed signal's noise."""
_LEAST_PROMINENCE = 2.0
_CLEAR_CORRELATION = 4.0
"""In standard deviations of the autocorrelation of noise."""


def signal_over_time(histograms: FrameHistograms, signal: Signal) -> Floats:
    """The signal of each column; NaN where there is no droplet."""
    if signal is Signal.N_SMALL:
        n_small = histograms.counts.shape[1] // 3
        return np.asarray(histograms.counts[:, :n_small].sum(axis=1) / histograms.n_frames)
    found = size_moments(histograms, area_um2=1.0)
    by_name = {
        Signal.SAUTER_RADIUS: found.sauter_radius_um,
        Signal.MEAN_RADIUS: found.mean_radius_um,
        Signal.N_DROPLETS: found.n_per_frame,
    }
    return by_name[signal]


def find_oscillations(histograms: FrameHistograms, *, signal: Signal = Signal.N_DROPLETS) -> Oscillations:
    """Find the peaks of a signal of the size distribution.

    The signal is freed of its slow trend (a Gaussian as wide as the strongest period), smoothed over a tenth of that
    period, and searched for peaks at least half a period apart. The strongest period is the first maximum of the
    autocorrelation past its first zero. A peak is certain if it stands out by 4 standard deviations of the noise and
    its periods to both sides are within half of their neighbours' median; from 2 on it is reported as uncertain.

    An empty or too short film gives no peaks.
    """
    from scipy.ndimage import gaussian_filter1d

    shown = coarsen(histograms, MAX_POINTS)
    raw = signal_over_time(shown, signal)
    is_known = np.isfinite(raw)
    time_s = shown.time_s
    nothing = Oscillations(signal, time_s, np.zeros_like(time_s), *(np.empty(0),) * 2, np.empty(0, bool))
    if is_known.sum() < _LEAST_POINTS or np.ptp(raw[is_known]) == 0:
        return nothing
    step_s = float(np.median(np.diff(time_s)))
    even_s = np.arange(time_s[0], time_s[-1] + step_s / 2, step_s)
    even = np.interp(even_s, time_s[is_known], raw[is_known])
    period = _strongest_period(even / even.mean() - 1)
    if period is None:
        return nothing
    trend = gaussian_filter1d(even, period, mode="nearest")
    relative = even / np.where(trend == 0, 1, trend) - 1
    width = max(period / 20, 0.7)
    smooth = gaussian_filter1d(relative, width, mode="nearest")
    noise = _noise(relative, smooth, width)
    return _with_peaks(nothing, even_s, smooth, period, noise, step_s)


def _strongest_period(signal: Floats) -> float | None:
    """First maximum of the autocorrelation past its first zero, in points."""
    from scipy.signal import find_peaks  # takes a second to load, which whoever starts the service would wait for

    centred = signal - np.polynomial.Polynomial.fit(np.arange(len(signal)), signal, 1)(np.arange(len(signal)))
    spectrum = np.abs(np.fft.rfft(centred, 2 * len(centred))) ** 2
    correlation = np.fft.irfft(spectrum)[: len(centred)] / np.arange(len(centred), 0, -1)
    correlation = correlation[: max(len(centred) * 2 // 3, 4)]
    if correlation[0] <= 0:
        return None
    below = np.flatnonzero(correlation < 0)
    if not below.size:
        return None
    peaks, found = find_peaks(correlation[below[0] :], height=0.0)
    period, height = peaks + below[0], found["peak_heights"]
    # Of pure noise, n points correlate by chance to about 1 / sqrt(n).
    is_clear = height > _CLEAR_CORRELATION * correlation[0] / np.sqrt(len(centred) - period)
    if not is_clear.any():
        return None
    # The first that is nearly as high as the highest: later ones are multiples of the period.
    return float(period[is_clear & (height >= 0.6 * height[is_clear].max())][0])


def _noise(relative: Floats, smooth: Floats, width: float) -> float:
    """Standard deviation of what noise leaves in the smoothed signal.

    Droplets stay in sight for some frames, so the noise of neighbouring ones is alike and averages out less.
    """
    residual = relative - smooth
    rough = 1.4826 * float(np.median(np.abs(residual)))
    alike = float((residual[1:] * residual[:-1]).mean() / max((residual**2).mean(), 1e-30))
    rough *= float(np.sqrt((1 + np.clip(alike, 0, 0.9)) / (1 - np.clip(alike, 0, 0.9))))
    return max(rough / float(np.sqrt(2 * np.sqrt(np.pi) * width)), 1e-12)


def _with_peaks(
    nothing: Oscillations, time_s: Floats, smooth: Floats, period: float, noise: float, step_s: float
) -> Oscillations:
    from scipy.signal import find_peaks, peak_prominences

    swing = float(np.std(smooth))
    least = max(_LEAST_PROMINENCE * noise, 0.3 * swing)
    peaks, _ = find_peaks(smooth, distance=max(period / 2, 1), prominence=least)
    prominence = peak_prominences(smooth, peaks)[0]
    # Noise s, smoothed over P/20, moves the top of a sine of amplitude A by 20 s P / (4 pi^2 A); it rises by 2 A.
    std_s = np.clip(noise / np.maximum(prominence, 1e-12), 0, 0.5) * period * step_s + step_s / np.sqrt(12)
    peak_s = time_s[peaks]
    is_clear = prominence >= _CLEAR_PROMINENCE * noise
    return Oscillations(nothing.signal_name, time_s, smooth, peak_s, std_s, is_clear & _is_regular(np.diff(peak_s)))


def _is_regular(period_s: Floats) -> npt.NDArray[np.bool_]:
    """Whether both periods beside each peak are within half of the median of five around them."""
    n = len(period_s)
    around = [np.median(period_s[max(0, i - 2) : i + 3]) for i in range(n)]
    is_odd = np.abs(period_s / np.array(around) - 1) > 0.5 if n else np.empty(0, bool)
    # The first and the last peak have one period only: it must be regular. Others need one regular of two.
    before, after = np.append(is_odd[:1], is_odd), np.append(is_odd, is_odd[-1:])
    return np.asarray(~(before & after))


DRIVING_GROUPS_PER_S = (6e-6, 1.3e-5, 3e-5, 6e-5, 3e-4)
"""Limits between the six groups of Fig. 15."""
LATER_THEORY_EXPONENT = -3 / 7
"""Of the period against the driving, in the theory that the field arrived at later."""


@dataclass(frozen=True)
class PeriodLaw:
    """Period = prefactor * xi^exponent, fitted in logarithms."""

    exponent: float
    exponent_std: float
    prefactor_s: float
    """Period that the law gives at xi = 1 per second."""


def driving_group(driving_per_s: Floats) -> npt.NDArray[np.int64]:
    """Group of Fig. 15 that each driving parameter belongs to, 0 to 5."""
    return np.searchsorted(DRIVING_GROUPS_PER_S, driving_per_s, side="right").astype(np.int64)


def period_law(
    driving_per_s: Floats, period_s: Floats, *, experiment: npt.NDArray[np.int64] | None = None
) -> PeriodLaw:
    """Least-squares exponent of the period against the driving over experiments, with its standard error.

    NaN for fewer than two different drivings; the error needs three periods, or with `experiment`, which says of each
    period whose it is, three experiments: their periods may err together.
    """
    x, y = np.log(driving_per_s), np.log(period_s)
    spread = float(((x - x.mean()) ** 2).sum()) if len(x) else 0.0
    if spread == 0:
        return PeriodLaw(np.nan, np.nan, np.nan)
    exponent = float(((x - x.mean()) * (y - y.mean())).sum()) / spread
    residual = y - y.mean() - exponent * (x - x.mean())
    error = float(np.sqrt((residual**2).sum() / (len(x) - 2) / spread)) if len(x) > 2 else np.nan
    if experiment is not None:
        pulls = np.bincount(experiment, (x - x.mean()) * residual)
        n = len(np.unique(experiment))
        error = float(np.sqrt((pulls**2).sum() * n / (n - 2)) / spread) if n > 2 else np.nan
    return PeriodLaw(exponent, error, float(np.exp(y.mean() - exponent * x.mean())))
