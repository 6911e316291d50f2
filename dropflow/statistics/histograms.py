"""Size histograms of frames that can be merged and coarsened: what a live dashboard keeps of each shard."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.errors import ParametersError, ResultsError

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

N_MOMENTS = 4


@dataclass(frozen=True)
class FrameHistograms:
    """Droplets counted by radius, one column of the time axis for one frame or a few neighbouring ones.

    Columns are sorted by frame and share no frame. Droplets outside the edges are in the moments but in no bin.
    """

    edges_um: Floats
    """Edges of the radius bins, shape (n_bins + 1,), ascending."""
    first_frame: Integers
    """First frame of each column, shape (n,)."""
    last_frame: Integers
    """Last frame of each column, shape (n,)."""
    n_frames: Integers
    """Frames summed up in each column, shape (n,): fewer than from first to last where some are missing."""
    time_s: Floats
    """Mean time of the column's frames, shape (n,)."""
    counts: Floats
    """Droplets by column and radius bin, shape (n, n_bins); fractions where radii have errors."""
    moments: Floats
    """Sums of r^0, r^1, r^2, r^3 over the droplets of each column, r in um, shape (n, 4)."""

    def __len__(self) -> int:
        return len(self.first_frame)

    @property
    def radius_um(self) -> Floats:
        """Geometric centres of the bins, shape (n_bins,)."""
        return np.asarray(np.sqrt(self.edges_um[:-1] * self.edges_um[1:]))

    @staticmethod
    def empty(edges_um: Floats) -> "FrameHistograms":
        """No frames: the neutral element of `merge`."""
        none = np.zeros(0, np.int64)
        counts = np.zeros((0, len(edges_um) - 1))
        return FrameHistograms(edges_um, none, none, none, np.zeros(0), counts, np.zeros((0, N_MOMENTS)))

    def __getitem__(self, which: slice | Integers | npt.NDArray[np.bool_]) -> "FrameHistograms":
        """The columns at a mask, at ascending indices or in a slice."""
        return FrameHistograms(
            self.edges_um,
            self.first_frame[which],
            self.last_frame[which],
            self.n_frames[which],
            self.time_s[which],
            self.counts[which],
            self.moments[which],
        )


def radius_edges_um(radius_min_um: float, radius_max_um: float, n_bins: int = 48) -> Floats:
    """Edges of `n_bins` radius bins of equal width in log r, shape (n_bins + 1,), um."""
    if not 0 < radius_min_um < radius_max_um or n_bins < 1:
        raise ParametersError(
            f"Radius bins need 0 < smallest < largest radius and one bin at least, "
            f"not {radius_min_um} to {radius_max_um} um in {n_bins}."
        )
    return np.geomspace(radius_min_um, radius_max_um, n_bins + 1)


def frame_histograms(table: pa.Table, edges_um: Floats, frames: range, times_s: Floats) -> FrameHistograms:
    """Count the droplets of each frame by radius.

    Parameters
    ----------
    table
        Rows with the columns ``frame`` and ``r_um``; rows of other frames are left out.
    edges_um
        Edges of the radius bins, shape (n_bins + 1,).
    frames
        The frames looked at, also those without a droplet.
    times_s
        Time of each of them, shape (len(frames),).
    """
    column = table["frame"].to_numpy().astype(np.int64) - frames.start
    radius_um = table["r_um"].to_numpy()
    is_inside = (column >= 0) & (column < len(frames))
    column, radius_um = column[is_inside], radius_um[is_inside]
    n_bins = len(edges_um) - 1
    radius_bin = np.searchsorted(edges_um, radius_um, side="right") - 1
    radius_bin[radius_um == edges_um[-1]] = n_bins - 1
    is_binned = (radius_bin >= 0) & (radius_bin < n_bins)
    cell = column[is_binned] * n_bins + radius_bin[is_binned]
    counts = np.bincount(cell, minlength=len(frames) * n_bins).reshape(len(frames), n_bins)
    moments = [np.bincount(column, radius_um**power, len(frames)) for power in range(N_MOMENTS)]
    return FrameHistograms(
        edges_um=np.asarray(edges_um, np.float64),
        first_frame=np.arange(frames.start, frames.stop, dtype=np.int64),
        last_frame=np.arange(frames.start, frames.stop, dtype=np.int64),
        n_frames=np.ones(len(frames), np.int64),
        time_s=np.array(times_s, np.float64),
        counts=counts.astype(np.float64),
        moments=np.stack(moments, axis=1).astype(np.float64),
    )


def merge(*parts: FrameHistograms) -> FrameHistograms:
    """All columns of `parts` sorted by frame; any order and grouping of the parts gives the same.

    Merge first and coarsen last: a coarsened column that spans frames of another part is an error.

    Raises
    ------
    ResultsError
        The parts have different radius bins, or a frame is in two of them and would be counted twice.
    """
    first = parts[0]
    if any(not np.array_equal(part.edges_um, first.edges_um) for part in parts):
        raise ResultsError("Histograms with different radius bins cannot be merged.", code="results.bins_differ")
    joined = FrameHistograms(
        first.edges_um,
        np.concatenate([part.first_frame for part in parts]),
        np.concatenate([part.last_frame for part in parts]),
        np.concatenate([part.n_frames for part in parts]),
        np.concatenate([part.time_s for part in parts]),
        np.concatenate([part.counts for part in parts]),
        np.concatenate([part.moments for part in parts]),
    )
    merged = joined[np.argsort(joined.first_frame, kind="stable")]
    overlapping = np.flatnonzero(merged.last_frame[:-1] >= merged.first_frame[1:])
    if overlapping.size:
        frame = int(merged.first_frame[overlapping[0] + 1])
        raise ResultsError("Two histograms hold the same frame.", code="results.frame_twice", frame=frame)
    return merged


def coarsen(histograms: FrameHistograms, max_columns: int) -> FrameHistograms:
    """Sum neighbouring columns so that at most `max_columns` remain; counts, moments and frames keep their totals."""
    if max_columns < 1:
        raise ParametersError(f"At least one column must remain, not {max_columns}.")
    n_together = -(-len(histograms) // max_columns)
    if n_together <= 1:
        return histograms
    starts = np.arange(0, len(histograms), n_together)
    return sum_columns(histograms, starts)


def sum_columns(histograms: FrameHistograms, starts: Integers) -> FrameHistograms:
    """One column for each run of columns from one of `starts` (ascending, the first is 0) to the next."""
    n_frames = np.add.reduceat(histograms.n_frames, starts)
    return FrameHistograms(
        histograms.edges_um,
        histograms.first_frame[starts],
        np.maximum.reduceat(histograms.last_frame, starts),
        n_frames,
        np.add.reduceat(histograms.time_s * histograms.n_frames, starts) / n_frames,
        np.add.reduceat(histograms.counts, starts, axis=0),
        np.add.reduceat(histograms.moments, starts, axis=0),
    )
