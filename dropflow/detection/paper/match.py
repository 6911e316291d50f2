"""How well a disk fits the prepared frame: eq. 3 of section 3.1.3, and its local maximum over x, y and r."""

from math import ceil, floor, sqrt

import numba
import numpy as np
import numpy.typing as npt

from dropflow.parameters import PaperDetection

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]
Constants = tuple[float, float, float, float]

NOWHERE = -np.inf
"""The match of a circle whose centre is outside the frame, or that fills it."""


def match(image: Image, x_px: Column, y_px: Column, r_px: Column, *, knobs: PaperDetection) -> Column:
    """Return the match function m(x, y, r) of eq. 3 for n circles.

    Disk and ring are antialiased (a pixel counts by how far the edge has passed its centre), which makes m continuous.
    The ring's centroid is weighted with its intensities, which are not negative, and compared with the centroid of the
    visible ring: where the ring is cut by the border of the frame, that is not the centre of the droplet.

    Parameters
    ----------
    image
        Prepared frame, shape (rows, columns), float32, levels 0 to 255, droplets bright.
    x_px, y_px, r_px
        Circles, each of shape (n,).
    knobs
        Ring width, A(r) and B.

    Returns
    -------
    Shape (n,); minus infinity where the centre is outside the frame.
    """
    return _match_all(image, x_px, y_px, r_px, _constants(knobs))


def climb(
    image: Image, x_px: Column, y_px: Column, r_px: Column, *, r_low_px: float, r_high_px: float, knobs: PaperDetection
) -> tuple[Column, Column, Column, Column]:
    """Vary position and radius of n circles until the match is at a local maximum.

    A compass search: try both ways along x, y and r, go where it is better, else halve the step; the last steps end
    at the vertices of parabolas.

    Parameters
    ----------
    image, x_px, y_px, r_px, knobs
        As in `match`.
    r_low_px, r_high_px
        The radius stays between these.

    Returns
    -------
    x_px, y_px, r_px and match, each of shape (n,); minus infinity where a circle is still outside the frame.
    """
    found = _climb_all(image, x_px, y_px, np.clip(r_px, r_low_px, r_high_px), r_low_px, r_high_px, _constants(knobs))
    return found[0], found[1], found[2], found[3]


def _constants(knobs: PaperDetection) -> Constants:
    return knobs.ring_width_px, knobs.match_offset, knobs.match_exponent, knobs.match_asymmetry


FIRST_STEP = 0.15
"""First step in radii: shorter than the distance to the next droplet, longer than the error of a candidate."""
FIRST_STEP_MAX_PX = 4.0
LAST_STEP_PX = 0.25
REORDERED = {"reassoc", "nsz", "arcp", "contract"}
"""Sums may be reordered (and so vectorised), but infinities stay what they are."""
N_REMEMBERED = 40
"""Circles of which a climb knows the match: those of its last two sweeps."""
SAME_PX = 1e-9
"""Steps forth and back end within rounding of where they began."""
MAX_SWEEPS = 60
"""A climb that has not ended by then is on a slope that leads to no droplet of this size."""


@numba.njit(cache=True, nogil=True, fastmath=REORDERED)
def _match_at(image: Image, x: float, y: float, r: float, constants: Constants) -> float:
    rows, columns = image.shape
    if not (-0.5 <= x <= columns - 0.5 and -0.5 <= y <= rows - 0.5):
        return NOWHERE
    ring_width, offset, exponent, asymmetry = constants
    outer = r + ring_width
    inside, touched, beyond = r - 0.5, outer + 0.5, r + 0.5
    disk_sum = disk_weight = 0.0
    ring_sum = ring_weight = ring_x = ring_y = centre_x = centre_y = 0.0
    for row in range(max(0, ceil(y - touched)), min(rows - 1, floor(y + touched)) + 1):
        dy = row - y
        half = sqrt(max(touched * touched - dy * dy, 0.0))
        first, last = max(0, ceil(x - half)), min(columns - 1, floor(x + half))
        # Columns from `core` to `core_end` are wholly in the disk: no weights, a sum the compiler can vectorise.
        core, core_end = last + 1, last
        if abs(dy) < inside:
            half = sqrt(inside * inside - dy * dy)
            core, core_end = max(first, ceil(x - half)), min(last, floor(x + half))
            if core <= core_end:
                total = 0.0
                for column in range(core, core_end + 1):
                    total += image[row, column]
                disk_sum += total
                disk_weight += core_end - core + 1
            else:
                core, core_end = last + 1, last
        row_ring = row_weight = 0.0
        for side in range(2):
            begin, end = (first, core) if side == 0 else (core_end + 1, last + 1)
            for column in range(begin, end):
                dx = column - x
                distance = sqrt(dx * dx + dy * dy)
                level = image[row, column]
                in_disk = min(max(beyond - distance, 0.0), 1.0)
                in_ring = min(max(touched - distance, 0.0), 1.0) - in_disk
                disk_sum += in_disk * level
                disk_weight += in_disk
                row_ring += in_ring * level
                row_weight += in_ring
                ring_x += in_ring * level * dx
                centre_x += in_ring * dx
        ring_sum += row_ring
        ring_weight += row_weight
        ring_y += row_ring * dy
        centre_y += row_weight * dy
    if disk_weight < 1e-6 or ring_weight < 1e-6:
        return NOWHERE
    gain: float = (disk_sum / disk_weight - ring_sum / ring_weight) / (offset + r**exponent)
    if ring_sum <= 0.0:
        return gain
    shift_x = ring_x / ring_sum - centre_x / ring_weight
    shift_y = ring_y / ring_sum - centre_y / ring_weight
    return gain - asymmetry * (shift_x * shift_x + shift_y * shift_y) / (r * r)


@numba.njit(cache=True, nogil=True)
def _match_all(image: Image, x: Column, y: Column, r: Column, constants: Constants) -> Column:
    result = np.empty(x.size)
    for i in range(x.size):
        result[i] = _match_at(image, x[i], y[i], r[i], constants)
    return result


@numba.njit(cache=True, nogil=True)
def _remembered(image: Image, x: float, y: float, r: float, constants: Constants, memory: Column) -> float:
    """The match, computed once for each circle of a climb: `memory` has rows x, y, r, match and is written in turn.

    The way back from each step, and the corners of the next sweep, have been looked at before.
    """
    for k in range(N_REMEMBERED):
        if abs(memory[0, k] - x) + abs(memory[1, k] - y) + abs(memory[2, k] - r) < SAME_PX:
            return float(memory[3, k])
    turn = int(memory[0, N_REMEMBERED])
    memory[0, turn], memory[1, turn], memory[2, turn] = x, y, r
    memory[3, turn] = _match_at(image, x, y, r, constants)
    memory[0, N_REMEMBERED] = (turn + 1) % N_REMEMBERED
    return float(memory[3, turn])


@numba.njit(cache=True, nogil=True)
def _climb_all(
    image: Image, x: Column, y: Column, r: Column, r_low: float, r_high: float, constants: Constants
) -> Column:
    """Return rows x, y, r, match of shape (4, n)."""
    result = np.empty((4, x.size))
    here, memory = np.empty(3), np.empty((4, N_REMEMBERED + 1))
    for i in range(x.size):
        memory.fill(np.nan)
        memory[0, N_REMEMBERED] = 0
        here[0], here[1], here[2] = x[i], y[i], r[i]
        best = _remembered(image, here[0], here[1], here[2], constants, memory)
        step = min(max(LAST_STEP_PX, FIRST_STEP * r[i]), FIRST_STEP_MAX_PX)
        for _ in range(MAX_SWEEPS):
            is_last = step <= LAST_STEP_PX
            before = best
            for axis in range(3):
                best = _try_axis(image, here, axis, step, is_last, best, r_low, r_high, constants, memory)
            if best <= before:
                best = _try_growing_sideways(image, here, step, best, r_low, r_high, constants, memory)
            if best <= before or (is_last and best - before < 1e-4):
                if is_last:
                    break
                step = max(LAST_STEP_PX, step / 2)
        result[0, i], result[1, i], result[2, i], result[3, i] = here[0], here[1], here[2], best
    return result


@numba.njit(cache=True, nogil=True)
def _try_axis(
    image: Image, here: Column, axis: int, step: float, is_last: bool, best: float, r_low: float, r_high: float,
    constants: Constants, memory: Column,
) -> float:  # fmt: skip
    """Move `here` along one axis to the best of two neighbours or, in the last steps, to the vertex between them."""
    start = here[axis]
    best_at = start
    sides = np.empty(2)
    for side in range(2):
        here[axis] = start + (2 * side - 1) * step
        sides[side] = NOWHERE
        if axis < 2 or r_low <= here[2] <= r_high:
            sides[side] = _remembered(image, here[0], here[1], here[2], constants, memory)
    centre = best
    for side in range(2):
        if sides[side] > best:
            best, best_at = sides[side], start + (2 * side - 1) * step
    if is_last and best_at == start and min(sides[0], sides[1]) > NOWHERE:
        bend = sides[0] - 2 * centre + sides[1]
        if bend < 0:
            here[axis] = start + step * 0.5 * (sides[0] - sides[1]) / bend
            vertex = _remembered(image, here[0], here[1], here[2], constants, memory)
            if vertex > best:
                best, best_at = vertex, here[axis]
    here[axis] = best_at
    return best


@numba.njit(cache=True, nogil=True)
def _try_growing_sideways(
    image: Image, here: Column, step: float, best: float, r_low: float, r_high: float, constants: Constants,
    memory: Column,
) -> float:  # fmt: skip
    """Move along x or y and change the radius at once: a circle that touches the edge from inside can only grow so."""
    start_x, start_y, start_r = here
    best_x, best_y, best_r = start_x, start_y, start_r
    for way in range(8):
        sideways = step if way & 1 else -step
        x, y = (start_x + sideways, start_y) if way & 2 else (start_x, start_y + sideways)
        r = start_r + (step if way & 4 else -step)
        if not r_low <= r <= r_high:
            continue
        value = _remembered(image, x, y, r, constants, memory)
        if value > best:
            best, best_x, best_y, best_r = value, x, y, r
    here[0], here[1], here[2] = best_x, best_y, best_r
    return best
