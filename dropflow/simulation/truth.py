"""What is true of each droplet in each frame, and whether it can be expected to be seen.

The rules of visibility, in this order (`blur_px` is the standard deviation of the droplet's own blur, contrast that of
its own light over the ring r+1 .. r+4 px):

- visible: blur at most 0.22 r, contrast at least 8 of 255 levels, at least 3/4 of the disk inside the frame, at most
  half hidden by others;
- not: blur over 0.36 r, or contrast below 4, or less than 0.4 inside, or more than 0.9 hidden;
- borderline: all others; in scoring they count neither way.
"""

from dataclasses import dataclass
from enum import StrEnum

import numba
import numpy as np
import numpy.typing as npt
import pyarrow as pa

from dropflow.simulation import optics
from dropflow.simulation.camera import gradient_light
from dropflow.simulation.cloud import Cloud
from dropflow.simulation.scenario import Scenario

Column = npt.NDArray[np.float64]

TRUTH = pa.schema(
    [
        ("frame", pa.int32()),
        ("time_s", pa.float64()),
        ("droplet_id", pa.int64()),
        ("x_px", pa.float64()),
        ("y_px", pa.float64()),
        ("r_px", pa.float64()),
        ("x_um", pa.float64()),
        ("y_um", pa.float64()),
        ("r_um", pa.float64()),
        ("z_um", pa.float64()),
        ("u_um_s", pa.float64()),
        ("v_um_s", pa.float64()),
        ("sedimentation_um_s", pa.float64()),
        ("flow_u_um_s", pa.float64()),
        ("flow_v_um_s", pa.float64()),
        ("contrast", pa.float64()),
        ("blur_px", pa.float64()),
        ("inside_fraction", pa.float64()),
        ("hidden_fraction", pa.float64()),
        ("visibility", pa.string()),
    ]
)
"""One row a droplet and frame, for every droplet of whose disk a part is in the frame and whose contrast is at least
half a level; sorted by (frame, droplet_id).

`z_um` is the distance from the focal plane, positive towards the camera. `u_um_s`, `v_um_s` are the mean velocity to
the next frame, `flow_u_um_s`, `flow_v_um_s` the flow's part of it (where the droplet does not reach the next frame,
the velocity of the moment). `sedimentation_um_s` is the Stokes speed along up. `hidden_fraction` is the share of its
light that nearer droplets take away.
"""

LEAST_CONTRAST = 0.5
"""Droplets fainter than this, in levels, are no part of the truth."""
MIN_INSIDE, LEAST_INSIDE = 0.75, 0.4
MAX_HIDDEN, MOST_HIDDEN = 0.5, 0.9
_N_PROBES = 64
_N_STRIPS = 256


class Visibility(StrEnum):
    """Whether a droplet counts."""

    VISIBLE = "visible"
    BORDERLINE = "borderline"
    NOT = "not"


@dataclass(frozen=True)
class Motion:
    """How the droplets of a cloud move to the next frame; columns of its length, um/s."""

    u_um_s: Column
    v_um_s: Column
    sedimentation_um_s: Column
    flow_u_um_s: Column
    flow_v_um_s: Column


def truth_table(cloud: Cloud, motion: Motion, scenario: Scenario, *, frame: int, time_s: float) -> pa.Table:
    """The rows of `TRUTH` for one frame."""
    pixel = scenario.pixel_size_um
    x_px, y_px, r_px = cloud.x_um / pixel, cloud.y_um / pixel, cloud.r_um / pixel
    inside = inside_fraction(x_px, y_px, r_px, scenario.height_px, scenario.width_px)
    light = gradient_light(y_px, scenario)
    contrast = light * optics.own_contrast(cloud.r_um, cloud.z_um, scenario)
    blur_px = optics.blur_px(cloud.z_um, scenario)
    is_in_truth = (inside > 0) & (contrast >= LEAST_CONTRAST)
    hidden = hidden_fraction(cloud, scenario, is_in_truth)
    columns = {
        "frame": np.full(len(cloud), frame, np.int32),
        "time_s": np.full(len(cloud), time_s),
        "droplet_id": cloud.droplet_id,
        "x_px": x_px,
        "y_px": y_px,
        "r_px": r_px,
        "x_um": cloud.x_um,
        "y_um": cloud.y_um,
        "r_um": cloud.r_um,
        "z_um": cloud.z_um,
        **vars(motion),
        "contrast": contrast,
        "blur_px": blur_px,
        "inside_fraction": inside,
        "hidden_fraction": hidden,
        "visibility": visibility(blur_px / r_px, contrast, inside, hidden),
    }
    return pa.table(columns, schema=TRUTH).filter(pa.array(is_in_truth))


def visibility(blur_over_r: Column, contrast: Column, inside: Column, hidden: Column) -> npt.NDArray[np.str_]:
    """One of `Visibility` for each droplet."""
    is_visible = (
        (blur_over_r <= optics.VISIBLE_BLUR)
        & (contrast >= optics.VISIBLE_CONTRAST)
        & (inside >= MIN_INSIDE)
        & (hidden <= MAX_HIDDEN)
    )
    is_not = (
        (blur_over_r > optics.INVISIBLE_BLUR)
        | (contrast < optics.INVISIBLE_CONTRAST)
        | (inside < LEAST_INSIDE)
        | (hidden > MOST_HIDDEN)
    )
    words = np.array([Visibility.VISIBLE, Visibility.NOT, Visibility.BORDERLINE], dtype=str)
    return words[np.where(is_visible, 0, np.where(is_not, 1, 2))]


def inside_fraction(x_px: Column, y_px: Column, r_px: Column, height_px: int, width_px: int) -> Column:
    """Share of each disk's area inside the frame, which reaches from -0.5 to height - 0.5 and to width - 0.5."""
    return np.asarray(_inside(x_px, y_px, r_px, height_px, width_px))


def hidden_fraction(cloud: Cloud, scenario: Scenario, is_asked: npt.NDArray[np.bool_] | None = None) -> Column:
    """Share of each droplet's light that nearer droplets take away, as a mean over points of its disk.

    Only where `is_asked` is true, if it is given; the others get 0 but hide as well.
    """
    order = np.argsort(cloud.y_um, kind="stable")
    hidden = np.empty(len(cloud))
    hidden[order] = _hidden(
        cloud.x_um[order],
        cloud.y_um[order],
        cloud.z_um[order],
        cloud.r_um[order],
        np.ones(len(cloud), bool) if is_asked is None else is_asked[order],
        scenario.opacity,
        scenario.opacity_depth_um,
    )
    return hidden


@numba.njit(cache=True, error_model="numpy")
def _inside(x: Column, y: Column, r: Column, height: int, width: int) -> Column:
    share = np.ones(x.size)
    # Strips of equal angle: the chord's ends, where a disk's outline is steep, get narrow ones.
    angle = np.pi * (np.arange(_N_STRIPS) + 0.5) / _N_STRIPS
    cosine, sine = np.cos(angle), np.sin(angle)
    for i in range(x.size):
        if x[i] + r[i] <= -0.5 or x[i] - r[i] >= width - 0.5 or y[i] + r[i] <= -0.5 or y[i] - r[i] >= height - 0.5:
            share[i] = 0.0
            continue
        if x[i] - r[i] >= -0.5 and x[i] + r[i] <= width - 0.5 and y[i] - r[i] >= -0.5 and y[i] + r[i] <= height - 0.5:
            continue
        area = 0.0
        for k in range(_N_STRIPS):
            strip_x = x[i] - r[i] * cosine[k]
            if strip_x < -0.5 or strip_x > width - 0.5:
                continue
            chord = r[i] * sine[k]
            top, bottom = max(y[i] - chord, -0.5), min(y[i] + chord, height - 0.5)
            area += max(bottom - top, 0.0) * chord * np.pi / _N_STRIPS
        share[i] = area / (np.pi * r[i] * r[i])
    return share


@numba.njit(cache=True, error_model="numpy")
def _hidden(
    x: Column,
    y: Column,
    z: Column,
    r: Column,
    is_asked: npt.NDArray[np.bool_],
    opacity: float,
    opacity_depth: float,
) -> Column:
    hidden = np.zeros(x.size)
    passed = np.empty(_N_PROBES)
    # Points of a sunflower: equal areas of the disk.
    number = np.arange(_N_PROBES)
    probe_x = np.sqrt((number + 0.5) / _N_PROBES) * np.cos(2.399963229728653 * number)
    probe_y = np.sqrt((number + 0.5) / _N_PROBES) * np.sin(2.399963229728653 * number)
    largest = r.max() if r.size else 0.0
    first = 0
    for i in range(x.size):
        while y[first] < y[i] - 2.0 * largest:
            first += 1
        if not is_asked[i]:
            continue
        passed[:] = 1.0
        is_covered = False
        for j in range(first, x.size):
            if y[j] > y[i] + r[i] + largest:
                break
            touch = r[i] + r[j]
            if z[j] <= z[i] or (x[j] - x[i]) ** 2 + (y[j] - y[i]) ** 2 >= touch * touch:
                continue
            is_covered = True
            for k in range(_N_PROBES):
                away = (x[i] + r[i] * probe_x[k] - x[j]) ** 2 + (y[i] + r[i] * probe_y[k] - y[j]) ** 2
                if away < r[j] * r[j]:
                    chord = 2.0 * np.sqrt(r[j] * r[j] - away)
                    passed[k] *= 1.0 - opacity * (1.0 - np.exp(-chord / opacity_depth))
        if is_covered:
            hidden[i] = 1.0 - passed.mean()
    return hidden
