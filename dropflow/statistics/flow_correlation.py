"""Correlation length and time of the flow (section 3.2.2: about 200 um and 30 s)."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import zarr

Floats = npt.NDArray[np.float64]

N_BLOCKS = 8
_STEPS_AT_ONCE = 256
_MAX_STEPS = 6000
_CELLS_AT_ONCE = 40


@dataclass(frozen=True)
class FlowCorrelation:
    """How the fluctuation of the flow correlates with itself over distance and over time.

    Length and time are where the correlation falls below 1 / e; NaN where it does not within the frame or the film.
    """

    distance_um: Floats
    """Shape (n_distances,)."""
    in_space: Floats
    """Correlation of the velocity vector, averaged over directions, shape (n_distances,)."""
    lag_s: Floats
    """Shape (n_lags,)."""
    in_time: Floats
    """At a fixed place, shape (n_lags,)."""
    length_um: float
    length_std_um: float
    """From the scatter between eight parts of the film."""
    time_s: float
    time_std_s: float


def flow_correlation(flow: Path, *, pixel_size_um: float) -> FlowCorrelation:
    """Correlation functions of the fluctuation about the mean of each step, over cells computed from droplets.

    Parameters
    ----------
    flow
        The folder ``flow.zarr``. Of long films every k-th step is taken for the length, and a contiguous stretch of
        6000 steps for the time.
    pixel_size_um
        Edge of a pixel.
    """
    arrays = (zarr.open_array(flow / name, mode="r") for name in ("velocity_um_s", "is_interpolated", "time_s"))
    velocities, interpolated, times = arrays
    n_steps = velocities.shape[0]
    spacing_um = [
        float(np.diff(np.asarray(zarr.open_array(flow / name, mode="r")[:])).mean()) * pixel_size_um
        for name in ("grid_y_px", "grid_x_px")
    ]
    if n_steps == 0:
        nothing = np.empty(0)
        return FlowCorrelation(nothing, nothing, nothing, nothing, np.nan, np.nan, np.nan, np.nan)
    fluctuation = _fluctuations(velocities, interpolated, min(n_steps, _MAX_STEPS))
    distance_um, in_space, lengths_um = _space(fluctuation, spacing_um)
    step_s = float(np.median(np.diff(np.asarray(times[: len(fluctuation)])))) if n_steps > 1 else np.nan
    lag, in_time, spans = _time(fluctuation)
    return FlowCorrelation(
        distance_um,
        in_space,
        lag * step_s,
        in_time,
        _fall_below(distance_um, in_space),
        _standard_error(lengths_um),
        _fall_below(lag * step_s, in_time),
        _standard_error(spans) * step_s,
    )


def _fluctuations(velocities: zarr.Array[Any], interpolated: zarr.Array[Any], n_steps: int) -> npt.NDArray[np.float32]:
    """Velocity minus the mean of its step, NaN in cells that were interpolated: (step, component, row, column)."""
    parts = []
    for start in range(0, n_steps, _STEPS_AT_ONCE):
        steps = slice(start, min(start + _STEPS_AT_ONCE, n_steps))
        velocity = np.array(velocities[steps], np.float32)
        velocity[np.broadcast_to(np.asarray(interpolated[steps])[:, None], velocity.shape)] = np.nan
        n_known = np.isfinite(velocity).sum(axis=(2, 3), keepdims=True)
        mean = np.nansum(velocity, axis=(2, 3), keepdims=True) / np.maximum(n_known, 1)
        parts.append(velocity - mean)
    return np.concatenate(parts)


def _space(fluctuation: npt.NDArray[np.float32], spacing_um: list[float]) -> tuple[Floats, Floats, list[float]]:
    rows, columns = fluctuation.shape[2:]
    products, pairs = np.zeros((N_BLOCKS, 2 * rows, 2 * columns)), np.zeros((N_BLOCKS, 2 * rows, 2 * columns))
    for block, part in enumerate(np.array_split(fluctuation, N_BLOCKS)):
        for chunk in np.array_split(part, max(1, len(part) // _STEPS_AT_ONCE)):
            known = np.isfinite(chunk)
            products[block] += _autocorrelation(np.where(known, chunk, 0)).sum(axis=(0, 1))
            pairs[block] += _autocorrelation(known.astype(np.float32)).sum(axis=(0, 1))
    lag_y = np.fft.fftfreq(2 * rows, 1 / (2 * rows)) * spacing_um[0]
    lag_x = np.fft.fftfreq(2 * columns, 1 / (2 * columns)) * spacing_um[1]
    distance = np.hypot(lag_y[:, None], lag_x)
    step_um = max(spacing_um)
    ring = np.rint(distance / step_um).astype(np.int64).ravel()
    n_rings = min(rows, columns)
    centre_um = np.bincount(ring, distance.ravel())[:n_rings] / np.bincount(ring)[:n_rings]

    def of(product: Floats, pair: Floats) -> Floats:
        total = np.bincount(ring, product.ravel())[:n_rings]
        with np.errstate(invalid="ignore", divide="ignore"):
            covariance = total / np.where(np.bincount(ring, pair.ravel())[:n_rings] > 0.5, 1, np.nan)
            covariance /= np.bincount(ring, pair.ravel())[:n_rings]
            return np.asarray(covariance / covariance[0])

    whole = of(products.sum(axis=0), pairs.sum(axis=0))
    lengths = [_fall_below(centre_um, of(products[block], pairs[block])) for block in range(N_BLOCKS)]
    return centre_um, whole, lengths


def _autocorrelation(values: npt.NDArray[np.float32]) -> Floats:
    """Sums of products over all shifts in the last two axes, without wrapping."""
    shape = (2 * values.shape[-2], 2 * values.shape[-1])
    spectrum = np.fft.rfft2(values, shape)
    return np.asarray(np.fft.irfft2(np.abs(spectrum) ** 2, shape), np.float64)


def _time(fluctuation: npt.NDArray[np.float32]) -> tuple[Floats, Floats, list[float]]:
    n_steps = len(fluctuation)
    n_lags = max(n_steps // 2, 1)
    blocks = [part for part in np.array_split(fluctuation, N_BLOCKS) if len(part)]
    whole = _time_correlation(fluctuation, n_lags)
    spans = []
    for part in blocks:
        n_part = max(len(part) // 2, 1)
        spans.append(_fall_below(np.arange(n_part, dtype=np.float64), _time_correlation(part, n_part)))
    return np.arange(n_lags, dtype=np.float64), whole, spans


def _time_correlation(fluctuation: npt.NDArray[np.float32], n_lags: int) -> Floats:
    n_steps = len(fluctuation)
    series = fluctuation.reshape(n_steps, -1)
    product, pair = np.zeros(n_lags), np.zeros(n_lags)
    for start in range(0, series.shape[1], _CELLS_AT_ONCE):
        part = series[:, start : start + _CELLS_AT_ONCE]
        known = np.isfinite(part)
        product += _lagged_sums(np.where(known, part, 0))[:n_lags]
        pair += _lagged_sums(known.astype(np.float32))[:n_lags]
    with np.errstate(invalid="ignore", divide="ignore"):
        covariance = np.where(pair > 0.5, product / pair, np.nan)
        return np.asarray(covariance / covariance[0])


def _lagged_sums(values: npt.NDArray[np.float32]) -> Floats:
    """Sums of products over all lags along the first axis, added up over the others."""
    spectrum = np.abs(np.fft.rfft(values, 2 * len(values), axis=0)) ** 2
    return np.asarray(np.fft.irfft(spectrum, axis=0).sum(axis=1), np.float64)


def _fall_below(x: Floats, correlation: Floats) -> float:
    """First x at which the correlation is below 1 / e, linear between points."""
    below = np.flatnonzero(correlation < np.exp(-1))
    if not below.size or below[0] == 0:
        return np.nan
    last = below[0]
    before, after = correlation[last - 1], correlation[last]
    return float(x[last - 1] + (x[last] - x[last - 1]) * (before - np.exp(-1)) / (before - after))


def _standard_error(values: list[float]) -> float:
    known = np.array([value for value in values if np.isfinite(value)])
    return float(known.std(ddof=1) / np.sqrt(len(known))) if len(known) > 2 else np.nan
