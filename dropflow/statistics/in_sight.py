"""How long droplets stay in sight, and how much less their counts say for it than as many different droplets would."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


@dataclass(frozen=True)
class InSight:
    """Trajectories counted by radius and by the number of their frames."""

    n_frames: Integers
    """Lengths that occur, shape (n_lengths,), ascending."""
    counts: Integers
    """Trajectories in each radius bin of each length, shape (n_bins, n_lengths)."""

    def variance_factor(self, n_frames: Integers) -> Floats:
        """Variance of a count over that of Poisson's law, for columns of so many frames, shape (n_columns, n_bins).

        A droplet of L frames is counted up to F times in a column of F frames, and all of these come and go together:
        the variance of the sum is the sum of squares of how often each droplet is counted, which is what drawing
        trajectories again would give. Averaged over where the column begins it is m^2 (M - m + 1) + m (m - 1) (2 m -
        1) / 3, with m and M the smaller and the larger of F and L, over F L. A radius bin without a trajectory has
        that of all radii.
        """
        lengths, columns = self.n_frames.astype(np.float64), np.unique(n_frames)
        smaller = np.minimum(columns[:, None], lengths)
        larger = np.maximum(columns[:, None], lengths)
        squares = smaller**2 * (larger - smaller + 1) + smaller * (smaller - 1) * (2 * smaller - 1) / 3
        by_bin = self.counts.astype(np.float64)
        total, seen = squares @ by_bin.T, columns[:, None] * (by_bin @ lengths)
        whole = squares @ by_bin.sum(axis=0) / np.maximum(columns * (by_bin.sum(axis=0) @ lengths), 1.0)
        with np.errstate(invalid="ignore", divide="ignore"):
            factor = np.where(seen > 0, total / seen, np.maximum(whole, 1.0)[:, None])
        return np.asarray(factor[np.searchsorted(columns, n_frames)])


def in_sight(trajectories: pl.DataFrame, edges_um: Floats) -> InSight:
    """Count trajectories by radius bin and length; radii outside the edges go to the bin at the end."""
    n_frames, which = np.unique(trajectories["n_frames"].to_numpy().astype(np.int64), return_inverse=True)
    radius_bin = np.searchsorted(edges_um, trajectories["r_mean_um"].to_numpy(), side="right") - 1
    radius_bin = np.clip(radius_bin, 0, len(edges_um) - 2)
    cells = np.bincount(radius_bin * len(n_frames) + which, minlength=(len(edges_um) - 1) * len(n_frames))
    return InSight(n_frames, cells.reshape(len(edges_um) - 1, len(n_frames)).astype(np.int64))
