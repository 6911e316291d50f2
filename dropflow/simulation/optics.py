"""How one droplet looks: the chord profile of a sphere in a light sheet, blurred by distance from the focal plane.

A point of the image at distance d from the centre sees the chord of the sphere there, from z - s to z + s with
s = sqrt(r^2 - d^2), lit by the sheet's Gaussian profile. Its light is the share of the sheet which the chord fills,
Phi((z + s) / sigma) - Phi((z - s) / sigma). The same chord makes the droplet opaque for what lies behind:
opacity * (1 - exp(-2 s / opacity_depth)). Both are blurred by a Gaussian; the blur is done on the radial profile,
so that the picture on the pixels is exact for any place between them.
"""

from functools import lru_cache
from math import erf, exp, sqrt

import numba
import numpy as np
import numpy.typing as npt

from dropflow.errors import FieldProblem, ParametersError
from dropflow.simulation.scenario import Scenario

Column = npt.NDArray[np.float64]

BLUR_REACH = 4.0
"""A profile ends this many blur sigmas outside the radius."""
SHEET_REACH = 2.5
"""A droplet farther than this many sheet sigmas from the focal plane (plus its radius) gives no light."""
SAMPLES_PER_PX = 4.0
"""Radial samples of a blurred profile; linear in between it is within 0.002 of the full contrast."""

VISIBLE_BLUR, INVISIBLE_BLUR = 0.22, 0.36
"""Blur over radius up to which a droplet is visible, and from which it is not."""
VISIBLE_CONTRAST, INVISIBLE_CONTRAST = 8.0, 4.0
"""Contrast in levels from which a droplet is visible, and below which it is not."""


def blur_px(z_um: Column, scenario: Scenario) -> Column:
    """Standard deviation of a droplet's blur at a distance from the focal plane."""
    return np.asarray(np.hypot(scenario.point_spread_px, scenario.defocus_px_per_um * np.asarray(z_um)))


def reach_um(r_um: Column, scenario: Scenario) -> Column:
    """Distance from the focal plane up to which a droplet is lit at all."""
    return np.asarray(np.asarray(r_um) + SHEET_REACH * scenario.sheet_sigma_um)


def own_contrast(r_um: Column, z_um: Column, scenario: Scenario) -> Column:
    """Mean over the disk minus mean over the ring r+1 .. r+4 px of a droplet's own light, in levels at full light.

    From a table that is made once a scenario; within about 1 % of the exact profile.
    """
    log_r, table = _contrast_table(scenario)
    r_um, z_um = np.asarray(r_um, np.float64), np.asarray(z_um, np.float64)
    depth = np.clip(np.abs(z_um) / reach_um(r_um, scenario), 0.0, 1.0) * (table.shape[1] - 1)
    size = np.clip((np.log(r_um) - log_r[0]) / (log_r[1] - log_r[0]), 0.0, len(log_r) - 1.0)
    row = np.minimum(size.astype(np.int64), table.shape[0] - 2)
    column = np.minimum(depth.astype(np.int64), table.shape[1] - 2)
    down, right = size - row, depth - column
    upper = table[row, column] * (1 - right) + table[row, column + 1] * right
    lower = table[row + 1, column] * (1 - right) + table[row + 1, column + 1] * right
    return np.asarray(scenario.contrast_levels * (upper * (1 - down) + lower * down))


def seen_depth_um(r_um: Column, scenario: Scenario) -> Column:
    """Thickness of the layer in which a droplet of this radius is visible by its own blur and contrast."""
    r_um = np.asarray(r_um, np.float64)[:, None]
    z_um = np.linspace(0.0, 1.0, 200) * reach_um(r_um, scenario)
    is_sharp = blur_px(z_um, scenario) <= VISIBLE_BLUR * r_um / scenario.pixel_size_um
    is_strong = own_contrast(np.broadcast_to(r_um, z_um.shape), z_um, scenario) >= VISIBLE_CONTRAST
    return np.asarray(2.0 * reach_um(r_um[:, 0], scenario) * (is_sharp & is_strong).mean(axis=1))


@lru_cache(maxsize=32)
def _contrast_table(scenario: Scenario) -> tuple[Column, npt.NDArray[np.float64]]:
    """Contrast over full contrast by ln(radius) and by depth over reach."""
    radii_um = np.geomspace(0.7 * scenario.radius_min_um, 2.5 * scenario.radius_max_um, 40)
    table = np.empty((40, 40))
    for row, r_um in enumerate(radii_um):
        z_um = np.linspace(0.0, 1.0, 40) * reach_um(r_um, scenario)
        for column, (z, blur) in enumerate(zip(z_um, blur_px(z_um, scenario), strict=True)):
            light, _ = blurred_profile(
                r_um, z, blur, scenario.sheet_sigma_um, scenario.pixel_size_um, 1.0, scenario.opacity_depth_um
            )
            table[row, column] = _disk_minus_ring(light, r_um / scenario.pixel_size_um)
    return np.log(radii_um), table


def check_is_visible(seen_um: Column) -> None:
    """An error if no droplet of any radius could be seen: their number would have no meaning."""
    if not np.any(seen_um > 0):
        problem = FieldProblem("contrast_levels", "no droplet of any radius would be visible with this light and blur")
        raise ParametersError("Please correct:", code="simulation.nothing_visible", fields=[problem])


@numba.njit(cache=True, error_model="numpy")
def bessel_i0e(x: float) -> float:
    """exp(-x) I0(x) for x >= 0, to 2e-7 (Abramowitz and Stegun 9.8.1, 9.8.2)."""
    if x < 3.75:
        t = (x / 3.75) ** 2
        series = 1.0 + t * (
            3.5156229 + t * (3.0899424 + t * (1.2067492 + t * (0.2659732 + t * (0.0360768 + t * 0.0045813))))
        )
        return exp(-x) * series
    t = 3.75 / x
    series = 0.39894228 + t * (
        0.01328592
        + t
        * (
            0.00225319
            + t
            * (
                -0.00157565
                + t * (0.00916281 + t * (-0.02057706 + t * (0.02635537 + t * (-0.01647633 + t * 0.00392377))))
            )
        )
    )
    return series / sqrt(x)


@numba.njit(cache=True, error_model="numpy")
def blurred_profile(
    r_um: float, z_um: float, blur_px: float, sheet_um: float, pixel_um: float, opacity: float, opacity_depth_um: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Light (0 to 1) and opacity of a droplet at distances 0, 1/4, 2/4, ... px from its centre, after the blur.

    The integral over the disk is a sum over rings. Outside r / sqrt(2) the rings are equal steps of the half chord s
    instead of the distance d: d^2 + s^2 = r^2, and the edge, a square root in d, is smooth in s.
    """
    r = r_um / pixel_um
    half = r / sqrt(2.0)
    n_half = max(int(np.ceil(half / min(blur_px / 5.0, r / 12.0))), 4)
    step = half / n_half
    distance = np.empty(2 * n_half)
    light_weight = np.empty(2 * n_half)
    opaque_weight = np.empty(2 * n_half)
    for j in range(2 * n_half):
        if j < n_half:
            distance[j] = (j + 0.5) * step
            chord = sqrt(r * r - distance[j] ** 2)
            area = distance[j] * step
        else:
            chord = half - (j - n_half + 0.5) * step
            distance[j] = sqrt(r * r - chord * chord)
            area = chord * step
        chord_um = chord * pixel_um
        scale = 1.0 / (sqrt(2.0) * sheet_um)
        light_weight[j] = area * 0.5 * (erf((z_um + chord_um) * scale) - erf((z_um - chord_um) * scale))
        opaque_weight[j] = area * opacity * (1.0 - exp(-2.0 * chord_um / opacity_depth_um))
    n_samples = int(np.ceil((r + BLUR_REACH * blur_px) * SAMPLES_PER_PX)) + 2
    light = np.zeros(n_samples)
    opaque = np.zeros(n_samples)
    variance = blur_px * blur_px
    reach = 5.0 * blur_px
    first = 0
    for i in range(n_samples):
        d = i / SAMPLES_PER_PX
        while first < distance.size and distance[first] < d - reach:
            first += 1
        for j in range(first, distance.size):
            if distance[j] > d + reach:
                break
            away = d - distance[j]
            kernel = exp(-0.5 * away * away / variance) * bessel_i0e(d * distance[j] / variance) / variance
            light[i] += kernel * light_weight[j]
            opaque[i] += kernel * opaque_weight[j]
    return light, opaque


@numba.njit(cache=True, error_model="numpy")
def _disk_minus_ring(light: Column, r_px: float) -> float:
    """Mean of a radial profile over the disk minus its mean over the ring from r+1 to r+4 px."""
    disk = disk_area = ring = ring_area = 0.0
    n_steps = 20 * (int(r_px) + 5)
    for k in range(n_steps):
        d = (k + 0.5) * (r_px + 4.0) / n_steps
        place = d * SAMPLES_PER_PX
        i = int(place)
        value = 0.0 if i + 1 >= light.size else light[i] * (i + 1 - place) + light[i + 1] * (place - i)
        if d <= r_px:
            disk += value * d
            disk_area += d
        elif d > r_px + 1.0:
            ring += value * d
            ring_area += d
    return disk / disk_area - ring / ring_area
