"""The five numbers of the ISBI 2012 particle tracking challenge (Chenouard et al. 2014, doi:10.1038/nmeth.2808)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pyarrow as pa
from scipy.spatial import cKDTree

from dropflow.scoring.detection import share
from dropflow.scoring.matching import Matching, Rows, cheapest_pairs
from dropflow.simulation.truth import Visibility

GATE_PX = 5.0

Column = npt.NDArray[np.float64]


@dataclass(frozen=True)
class IsbiScore:
    """Whole tracks against truth. A number is None where nothing was there to count."""

    alpha: float | None
    """1 - d(X, Y) / d(X, nothing): how well the true tracks are covered, from 0 to 1."""
    beta: float | None
    """The same with a penalty for spurious tracks, from 0 to alpha."""
    jsc: float | None
    """Jaccard index of positions."""
    jsc_theta: float | None
    """Jaccard index of whole tracks."""
    rmse_px: float | None
    """Root mean square distance of matched positions."""


@dataclass(frozen=True)
class Tracks:
    """Points of tracks as columns; `track` counts from 0."""

    track: Rows
    frame: Rows
    place_px: Column
    """Shape (n, 2)."""

    @property
    def lengths(self) -> Rows:
        """Points of each track."""
        return np.bincount(self.track)


def score_isbi(matching: Matching, *, gate_px: float = GATE_PX) -> IsbiScore:
    """Score the trajectories in `matching` (their rows have a `trajectory_id`).

    True tracks are the visible rows of each droplet. Rows of the results that match a borderline droplet are left out.
    """
    is_visible = matching.truth_is(Visibility.VISIBLE)
    counts = ~matching.is_matched_to(Visibility.BORDERLINE)
    real = _tracks(matching.truth.filter(is_visible), "droplet_id")
    found = _tracks(matching.results.filter(counts), "trajectory_id")
    return compare_tracks(real, found, gate_px=gate_px)


def compare_tracks(real: Tracks, found: Tracks, *, gate_px: float = GATE_PX) -> IsbiScore:
    """The five numbers for true tracks X = `real` and results Y = `found`.

    The distance of two tracks is the sum over frames of min(distance, gate), and of the gate where only one of them
    is there. Each true track is paired with one track of the results or with none so that the sum of distances is
    least. In terms of the gain over "none", which is the sum of (gate - distance) over frames closer than the gate
    less the gate for every frame in which only the result is there, alpha = gain / (gate * true points).
    """
    pairs = _near_pairs(real, found, gate_px)
    best = _best(pairs.at(pairs.gain > 0))
    total, n_right = float(best.gain.sum()), int(best.n_near.sum())
    n_real, n_found = len(real.track), len(found.track)
    n_spurious = n_found - int(found.lengths[best.found].sum())
    n_tracks = len(real.lengths) + len(found.lengths) - len(best.gain)
    return IsbiScore(
        alpha=share(total, gate_px * n_real),
        beta=share(total, gate_px * (n_real + n_spurious)) if n_real else None,
        jsc=share(n_right, n_real + n_found - n_right),
        jsc_theta=share(len(best.gain), n_tracks),
        rmse_px=float(np.sqrt(best.squares_px2.sum() / n_right)) if n_right else None,
    )


@dataclass(frozen=True)
class _Pairs:
    """Pairs of a true track and a track of the results that come closer than the gate in some frame."""

    real: Rows
    found: Rows
    n_near: Rows
    gain: Column
    squares_px2: Column

    def at(self, which: npt.NDArray[np.bool_] | Rows) -> "_Pairs":
        return _Pairs(*(column[which] for column in vars(self).values()))


def _tracks(table: pa.Table, id_column: str) -> Tracks:
    _, track = np.unique(table[id_column].to_numpy(), return_inverse=True)
    place_px = np.column_stack([table["x_px"].to_numpy(), table["y_px"].to_numpy()])
    return Tracks(track.astype(np.int64), table["frame"].to_numpy().astype(np.int64), place_px)


def _near_pairs(real: Tracks, found: Tracks, gate_px: float) -> _Pairs:
    near = [_near_in_frame(real, found, frame, gate_px) for frame in np.intersect1d(real.frame, found.frame)]
    first, second, distance = (np.concatenate(column) for column in zip(_NO_POINTS, *near, strict=True))
    n_found = max(len(found.lengths), 1)
    keys, pair = np.unique(first * n_found + second, return_inverse=True)
    i, j = keys // n_found, keys % n_found
    closeness = np.bincount(pair, gate_px - distance, len(keys))
    alone = found.lengths[j] - _n_common(real, found, i, j)
    return _Pairs(
        real=i,
        found=j,
        n_near=np.bincount(pair, minlength=len(keys)),
        gain=closeness - gate_px * alone,
        squares_px2=np.bincount(pair, distance**2, len(keys)).astype(np.float64),
    )


_NO_POINTS = (np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))


def _near_in_frame(real: Tracks, found: Tracks, frame: int, gate_px: float) -> tuple[Rows, Rows, Column]:
    """Tracks and distances of all points closer than the gate in one frame."""
    one, other = np.flatnonzero(real.frame == frame), np.flatnonzero(found.frame == frame)
    near = cKDTree(found.place_px[other]).query_ball_point(real.place_px[one], gate_px)
    rows = np.repeat(one, [len(partners) for partners in near])
    partners = other[np.concatenate([np.asarray(p, np.int64) for p in near])]
    distance = np.hypot(*(real.place_px[rows] - found.place_px[partners]).T)
    is_near = distance < gate_px
    return real.track[rows[is_near]], found.track[partners[is_near]], distance[is_near]


def _n_common(real: Tracks, found: Tracks, i: Rows, j: Rows) -> Rows:
    """Frames in which both tracks of each pair are there."""
    frames = [_frames_by_track(tracks) for tracks in (real, found)]
    common = [len(np.intersect1d(frames[0][a], frames[1][b], assume_unique=True)) for a, b in zip(i, j, strict=True)]
    return np.array(common, np.int64)


def _frames_by_track(tracks: Tracks) -> list[Rows]:
    order = np.argsort(tracks.track, kind="stable")
    return np.split(tracks.frame[order], np.cumsum(tracks.lengths)[:-1])


def _best(pairs: _Pairs) -> _Pairs:
    """Of pairs with a gain those that together gain most, where each track is in one pair at most."""
    most = float(pairs.gain.max(initial=0.0))
    real, found = cheapest_pairs(pairs.real, pairs.found, most - pairs.gain, most)
    n_found = int(pairs.found.max(initial=0)) + 1
    keys = pairs.real * n_found + pairs.found  # sorted, as `_near_pairs` made them
    return pairs.at(np.searchsorted(keys, real * n_found + found))
