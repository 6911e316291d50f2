"""Size histograms of whole tables of droplets and trajectories, read in batches."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from dropflow.errors import ResultsError
from dropflow.statistics.counted import counted_droplets
from dropflow.statistics.expected_counts import shares_of_bins
from dropflow.statistics.histograms import N_MOMENTS, FrameHistograms

Floats = npt.NDArray[np.float64]

_ROWS_AT_ONCE = 1 << 20


def histograms_of_table(path: Path, edges_um: Floats, times_s: Floats) -> FrameHistograms:
    """Count the droplets of every frame by radius, in any order of rows.

    Parameters
    ----------
    path
        Parquet file with the columns ``frame`` and ``r_um``; memory does not grow with its rows.
    edges_um
        Edges of the radius bins.
    times_s
        Time of each frame of the film, shape (n_frames,).

    Raises
    ------
    ResultsError
        The file is missing, is another table, or names a frame that the film does not have.
    """
    sums = _Sums(edges_um, times_s, path)
    try:
        with pq.ParquetFile(path) as table:
            for batch in table.iter_batches(_ROWS_AT_ONCE, columns=["frame", "r_um"]):
                radius_um = batch["r_um"].to_numpy()
                sums.add(batch["frame"].to_numpy(), radius_um, np.zeros(len(radius_um)), np.ones(len(radius_um)))
    except (OSError, KeyError, pa.ArrowException) as problem:
        raise ResultsError(f"The table cannot be read ({problem}).", file=str(path)) from None
    return sums.histograms()


def histograms_after_tracking(
    folder: Path, edges_um: Floats, times_s: Floats, *, pixel_size_um: float, out_of_focus: bool = False
) -> FrameHistograms:
    """Count the droplets that `dropflow.statistics.counted` counts, each radius with its error.

    Parameters
    ----------
    folder, pixel_size_um, out_of_focus
        As for `dropflow.statistics.counted.counted_droplets`; memory does not grow with the rows of the tables.
    edges_um, times_s
        As for `histograms_of_table`.

    Raises
    ------
    ResultsError
        As there.
    """
    path = folder / "trajectories.parquet"
    sums = _Sums(edges_um, times_s, path)
    try:
        for rows in counted_droplets(folder, pixel_size_um=pixel_size_um, out_of_focus=out_of_focus):
            sums.add(*(rows[name].to_numpy() for name in ("frame", "r_um", "r_std_um", "weight")))
    except (OSError, KeyError, pa.ArrowException) as problem:
        raise ResultsError(f"The table cannot be read ({problem}).", file=str(path)) from None
    return sums.histograms()


class _Sums:
    """Counts and moments of a film's frames."""

    def __init__(self, edges_um: Floats, times_s: Floats, path: Path) -> None:
        self._edges_um, self._times_s, self._path = np.asarray(edges_um), np.array(times_s, np.float64), path
        self._counts = np.zeros((len(times_s), len(edges_um) + 1))
        self._moments = np.zeros((len(times_s), N_MOMENTS))

    def add(self, frame: npt.NDArray[np.int32], radius_um: Floats, std_um: Floats, weight: Floats) -> None:
        n_frames, n_bins = self._counts.shape
        if len(frame) and (frame.min() < 0 or frame.max() >= n_frames):
            raise ResultsError(f"The table has frames beyond the film's {n_frames}.", file=str(self._path))
        at = frame.astype(np.int64)
        counts = self._counts.reshape(-1)
        for which, radius_bin, share in shares_of_bins(radius_um, std_um, self._edges_um):
            counts += np.bincount(at[which] * n_bins + radius_bin, share * weight[which], counts.size)
        for power in range(N_MOMENTS):
            self._moments[:, power] += np.bincount(at, weight * radius_um**power, n_frames)

    def histograms(self) -> FrameHistograms:
        frames = np.arange(len(self._times_s), dtype=np.int64)
        ones = np.ones(len(frames), np.int64)
        counts = self._counts[:, 1:-1]
        return FrameHistograms(self._edges_um, frames, frames, ones, self._times_s, counts, self._moments)
