"""Scenes of plain discs that do not overlap, and of nothing but noise."""

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.detection.default.training.scenes import Scene
from dropflow.experiment import DropletTone
from dropflow.simulation.truth import Visibility

_SIDE_PX = 500
_SEED = 0xD5
_FINE = 4


def disc_scene(seed: int) -> Scene:
    """Flat discs side by side, sharp or nearly so."""
    rng = np.random.default_rng([_SEED, seed])
    smallest = rng.uniform(2.2, 7.0)
    largest = min(smallest * rng.uniform(2.5, 11.0), 60.0)
    x, y, r = _packed(rng, smallest, largest, gap=rng.uniform(2.0, 30.0), n_most=int(rng.uniform(5, 250)))
    fine = np.zeros((_SIDE_PX * _FINE, _SIDE_PX * _FINE), np.uint8)
    for centre_x, centre_y, radius in zip(x, y, r, strict=True):
        at = (round((centre_x + 0.5) * _FINE * 16 - 8), round((centre_y + 0.5) * _FINE * 16 - 8))
        cv2.circle(fine, at, round(radius * _FINE * 16), 255, -1, shift=4)
    reduced = cv2.resize(fine, (_SIDE_PX, _SIDE_PX), interpolation=cv2.INTER_AREA)
    share = np.asarray(reduced, np.float32) / 255
    if rng.random() < 0.5:
        share = np.asarray(cv2.GaussianBlur(share, (0, 0), rng.uniform(0.3, 0.15 * smallest + 0.3)), np.float32)
    contrast = rng.uniform(60, 220)
    levels = rng.uniform(0, 255 - contrast) + contrast * share.astype(np.float64)
    levels += rng.uniform(0.3, 0.08 * contrast) * rng.standard_normal(share.shape)
    is_dark = rng.random() < 0.3
    frame = np.clip(np.rint(255 - levels if is_dark else levels), 0, 255).astype(np.uint8)
    return Scene(
        family="discs",
        frame=frame,
        flat_field=None,
        tone=DropletTone.DARK if is_dark else DropletTone.BRIGHT,
        r_min_px=smallest * rng.uniform(0.7, 1.0),
        r_max_px=largest * rng.uniform(1.0, 1.4),
        x_px=x,
        y_px=y,
        r_px=r,
        visibility=np.full(len(x), Visibility.VISIBLE.value),
        edge_px=r,
    )


def empty_scene(seed: int) -> Scene:
    """Noise, white or a little smooth, on a ground that may be uneven or striped; no droplet at all."""
    rng = np.random.default_rng([_SEED, 1, seed])
    noise = rng.standard_normal((_SIDE_PX, 2 * _SIDE_PX)).astype(np.float32)
    if rng.random() < 0.3:
        noise = np.asarray(cv2.GaussianBlur(noise, (0, 0), rng.uniform(0.4, 1.5)), np.float32)
        noise /= noise.std()
    coarse = rng.standard_normal((4, 6)).astype(np.float32)
    ground = rng.uniform(0, 20) * cv2.resize(coarse, (2 * _SIDE_PX, _SIDE_PX), interpolation=cv2.INTER_CUBIC)
    stripes = cv2.GaussianBlur(rng.standard_normal((_SIDE_PX, 1)).astype(np.float32), (0, 0), rng.uniform(1, 5))
    ground = ground + (rng.random() < 0.4) * rng.uniform(0, 5) * stripes / stripes.std()
    frame = np.clip(rng.uniform(20, 220) + ground + rng.uniform(0.5, 15) * noise, 0, 255)
    nothing = np.empty(0)
    return Scene(
        family="empty",
        frame=np.rint(frame).astype(np.uint8),
        flat_field=None,
        tone=DropletTone.DARK if rng.random() < 0.5 else DropletTone.BRIGHT,
        r_min_px=float(rng.choice([2.0, 4.0, 6.4])),
        r_max_px=64.0,
        x_px=nothing,
        y_px=nothing,
        r_px=nothing,
        visibility=np.empty(0, dtype="<U10"),
        edge_px=nothing,
    )


def _packed(
    rng: np.random.Generator, smallest: float, largest: float, *, gap: float, n_most: int
) -> tuple[npt.NDArray[np.float64], ...]:
    """Centres and radii of discs that keep `gap` px between each other."""
    placed = np.empty((0, 3))
    for _ in range(3000):
        if len(placed) >= n_most:
            break
        r = rng.uniform(smallest, largest)
        x, y = rng.uniform(r + 2, _SIDE_PX - r - 3, 2)
        if np.all(np.hypot(placed[:, 0] - x, placed[:, 1] - y) >= placed[:, 2] + r + gap):
            placed = np.vstack([placed, [x, y, r]])
    return placed[:, 0], placed[:, 1], placed[:, 2]
