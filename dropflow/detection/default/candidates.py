"""Where droplets may be: every edge votes for the centres it could belong to (a Hough transform for circles).

An edge of a bright disk points uphill to its centre. For each of a few radii an octave, each edge votes for the place
that lies that far uphill; where the votes of a whole outline meet, there may be a droplet. Overlaps cost a droplet
only the votes of the outline that is covered, and a bright centre inside a rim costs none. Votes count one each,
however strong the edge: what counts is how much of an outline is there, so that faint droplets score as strong ones.
"""

from dataclasses import dataclass
from math import ceil

import cv2
import numba
import numpy as np
import numpy.typing as npt

from dropflow.detection.default.edges import thin_edges
from dropflow.detection.default.pyramid import Level, doubled, halved

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]
Values = npt.NDArray[np.float32]
Counts = npt.NDArray[np.uint16]

N_PER_OCTAVE = 3
"""Radii voted for in each octave; edges of radii between them still meet within the blur of the votes."""
SMALLEST_SHARE = 0.85
"""Edges lie inside the true radius: the smallest radius voted for is this part of the smallest looked for."""
EDGE_BLUR_PX = 1.0
EDGE_NOISES = 5.0
"""An edge is stronger than this many standard deviations of its noise."""
VOTE_BLUR = 0.25
"""Votes are blurred by this part of the radius (standard deviation)."""
VOTE_BLUR_LEAST = 0.6
BIN = 2
"""Votes are counted in blocks of this many pixels, for radii of at least `LEAST_BINNED_PX`."""
LEAST_BINNED_PX = 4.5
LEAST_LEVEL_RADIUS_PX = 4.0
"""Smaller droplets are looked for on an image of twice the size."""
MAX_PER_MPIXEL = 20_000
_BLOCK = 32
"""So many places are passed at once where none has enough votes."""
_TYPICAL_PX = 8.0
_LEVEL_POWER, _FRAME_POWER = 0.5, 0.2
"""Votes over a whole outline rise by chance as 1 / radius: large outlines of which a part is there are favoured."""


@dataclass(frozen=True)
class Candidates:
    """n places that may be droplets; each attribute has shape (n,), pixels of the frame."""

    x_px: Column
    y_px: Column
    r_px: Column
    votes: Column
    """Votes over those of a whole outline, weighted by radius: about 1/2 for a clear droplet of 8 px."""

    def __len__(self) -> int:
        return len(self.x_px)


def find_candidates(
    levels: list[Level], noise: float, *, r_min_px: float, r_max_px: float, finest_px: float, least_votes: float
) -> Candidates:
    """Vote on each octave of radii, on the level where its smallest radius is `finest_px` to twice that.

    Parameters
    ----------
    levels
        `pyramid` of the prepared frame.
    noise
        Standard deviation of a pixel of the frame.
    r_min_px, r_max_px
        Radii looked for.
    finest_px
        Smaller is quicker: 5.2 for levels of half as many rows and columns as 10.4.
    least_votes
        Candidates have more votes than this.
    """
    found = []
    r_px = r_min_px * SMALLEST_SHARE
    index = max(0, int(np.floor(np.log2(max(r_min_px / (finest_px / 2), 1.0)))))
    level = levels[min(index, len(levels) - 1)]
    if r_min_px < LEAST_LEVEL_RADIUS_PX:
        index, level = -1, Level(doubled(levels[0].image), 0.5)
    while r_px < 1.1 * r_max_px:
        radii = r_px / level.factor * 2.0 ** (np.arange(N_PER_OCTAVE + 1) / N_PER_OCTAVE)
        found.append(_vote(level, noise / level.factor, radii, least_votes))
        r_px *= 2
        index += 1
        level = levels[index] if index < len(levels) else Level(halved(level.image), 2 * level.factor)
    x, y, r, votes = np.concatenate(found, axis=1)
    return Candidates(x, y, r, votes)


def _vote(level: Level, noise: float, radii: Column, least_votes: float) -> npt.NDArray[np.float64]:
    """Candidates of one octave: rows x, y, r (px of the frame) and votes."""
    image = _blurred(level.image, EDGE_BLUR_PX, 3.0)
    rows, columns = image.shape
    size = BIN if radii[0] >= LEAST_BINNED_PX else 1
    capacity = max(image.size // 5, 64)
    edges = np.empty((4, capacity), np.float32)
    # Blurring leaves 1 / (2 sqrt(pi) blur) of white noise, and a difference over two pixels about as much again.
    least = np.float32(EDGE_NOISES * noise / (2.0 * EDGE_BLUR_PX))
    n_edges = thin_edges(image, least, edges[0], edges[1], edges[2], edges[3])
    cast = np.zeros((len(radii), rows // size + 1, columns // size + 1), np.uint16)
    x, y, u, v = edges[:, :n_edges]
    _cast(x, y, u, v, radii.astype(np.float32), np.float32(1 / size), cast)
    counts = np.empty(cast.shape, np.float32)
    whole = np.empty(len(radii), np.float32)
    for k, radius in enumerate(radii):
        blur = max(VOTE_BLUR_LEAST, VOTE_BLUR * radius / size)
        counts[k] = _blurred(cast[k].astype(np.float32), blur, 2.5, border=cv2.BORDER_CONSTANT)
        whole[k] = radius / blur**2 * (_TYPICAL_PX / radius) ** _LEVEL_POWER
        whole[k] *= (_TYPICAL_PX / (radius * level.factor)) ** _FRAME_POWER
    peaks = np.empty((4, max(64, MAX_PER_MPIXEL * counts[0].size // 1_000_000)), np.float32)
    n_peaks = _peaks(counts, np.float32(1) / whole, np.float32(least_votes), peaks)
    column, row, k, votes = peaks[:, :n_peaks].astype(np.float64)
    places = [level.x_to_frame((along + 0.5) * size - 0.5) for along in (column, row)]
    return np.stack([*places, radii[k.astype(int)] * level.factor, votes])


def _blurred(image: Image, sigma: float, n_sigmas: float, border: int = cv2.BORDER_DEFAULT) -> Image:
    """Blurred by a Gaussian cut off after `n_sigmas`: half the work of OpenCV's own width for float32."""
    width = 2 * ceil(n_sigmas * sigma) + 1
    return np.asarray(cv2.GaussianBlur(image, (width, width), sigma, borderType=border), np.float32)


@numba.njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _cast(x: Values, y: Values, u: Values, v: Values, radii: Values, scale: np.float32, counts: Counts) -> None:
    """Each edge's votes, one a radius, into `counts` (radius, row, column)."""
    rows, columns = counts.shape[1], counts.shape[2]
    half = np.float32(0.5)
    for edge in range(x.size):
        start_x, start_y = (x[edge] + half) * scale, (y[edge] + half) * scale
        uphill_x, uphill_y = u[edge] * scale, v[edge] * scale
        for k in range(radii.size):
            at_x, at_y = start_x + uphill_x * radii[k], start_y + uphill_y * radii[k]
            if at_x >= 0 and at_y >= 0 and at_x < columns and at_y < rows:
                counts[k, int(at_y), int(at_x)] += np.uint16(1)


@numba.njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _peaks(counts: Image, scale: Values, least: np.float32, peaks: Image) -> int:
    """Write x, y, index of radius and votes of places with more votes than around them and than at the next radii."""
    n_radii, rows, columns = counts.shape
    n = 0
    for k in range(n_radii):
        plane = counts[k]
        threshold = least / scale[k]
        for row in range(rows):
            here = plane[row]
            above, below = plane[max(row - 1, 0)], plane[min(row + 1, rows - 1)]
            for begin in range(0, columns, _BLOCK):
                end = min(begin + _BLOCK, columns)
                most = np.float32(0)
                for column in range(begin, end):
                    most = max(most, here[column])
                if most < threshold:
                    continue
                for column in range(begin, end):
                    value = here[column]
                    if value < threshold:
                        continue
                    left, right = max(column - 1, 0), min(column + 1, columns - 1)
                    if max(here[left], here[right], above[left], above[column], above[right]) > value:
                        continue
                    if max(below[left], below[column], below[right]) > value:
                        continue
                    votes = value * scale[k]
                    if k > 0 and counts[k - 1, row, column] * scale[k - 1] > votes:
                        continue
                    if k + 1 < n_radii and counts[k + 1, row, column] * scale[k + 1] >= votes:
                        continue
                    if n < peaks.shape[1]:
                        peaks[0, n], peaks[1, n], peaks[2, n], peaks[3, n] = column, row, k, votes
                        n += 1
    return n
