"""Size histograms of a whole table of droplets or trajectories, read in batches."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from dropflow.errors import ResultsError
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
    n_frames, n_bins = len(times_s), len(edges_um) - 1
    counts = np.zeros(n_frames * (n_bins + 2), np.int64)
    moments = np.zeros((n_frames, N_MOMENTS))
    try:
        with pq.ParquetFile(path) as table:
            for batch in table.iter_batches(_ROWS_AT_ONCE, columns=["frame", "r_um"]):
                frame = batch["frame"].to_numpy().astype(np.int64)
                radius_um = batch["r_um"].to_numpy()
                if len(frame) and (frame.min() < 0 or frame.max() >= n_frames):
                    raise ResultsError(f"The table has frames beyond the film's {n_frames}.", file=str(path))
                radius_bin = np.searchsorted(edges_um, radius_um, side="right")
                radius_bin[radius_um == edges_um[-1]] = n_bins
                counts += np.bincount(frame * (n_bins + 2) + radius_bin, minlength=len(counts))
                for power in range(N_MOMENTS):
                    moments[:, power] += np.bincount(frame, radius_um**power, n_frames)
    except (OSError, KeyError, pa.ArrowException) as problem:
        raise ResultsError(f"The table cannot be read ({problem}).", file=str(path)) from None
    frames = np.arange(n_frames, dtype=np.int64)
    inside = counts.reshape(n_frames, n_bins + 2)[:, 1:-1]
    ones = np.ones(n_frames, np.int64)
    return FrameHistograms(np.asarray(edges_um), frames, frames, ones, np.array(times_s, np.float64), inside, moments)
