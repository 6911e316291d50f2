"""Scenes of bubbles lit from behind: dark rims, bright centres, light that is multiplied where they overlap."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.detection.default.training.scenes import Scene
from dropflow.experiment import DropletTone
from dropflow.simulation.optics import INVISIBLE_BLUR, VISIBLE_BLUR
from dropflow.simulation.truth import Visibility

Image = npt.NDArray[np.float32]
Column = npt.NDArray[np.float64]

SIDE_PX = 640
_SEED = 0xB1
_N_ARC = 64
_HALO_AT, _HALO_WIDTH = 1.08, 0.08
"""Radii."""
_MOST_HIDDEN_VISIBLE, _MOST_HIDDEN = 0.7, 0.9
_LEAST_VISIBLE_DEPTH, _LEAST_DEPTH = 0.22, 0.12
"""Of the light around: grey discs far from the focal plane are what people leave out."""
_TOUCHING = 0.95, 1.1
"""Bubbles of a cluster keep this distance, over the sum of their radii."""


@dataclass(frozen=True, eq=False)
class _Bubbles:
    x: Column
    y: Column
    r: Column
    defocus: Column
    blur: Column
    """All blur: that of the lens and of the distance from the focal plane."""
    rim_from: Column
    """Where the dark rim begins, in radii."""
    rim: Column
    """Light that passes the rim."""
    centre: Column
    """Light that passes the centre."""
    softness: Column
    """Width over which the rim passes into the centre, in radii."""
    halo: Column
    """Light that the rim throws just outside."""
    stretch: Column
    angle: Column


def backlit_scene(seed: int) -> Scene:
    """A frame of bubbles of which some are sharp, in or out of a bright window, with dust and noise."""
    rng = np.random.default_rng([_SEED, seed])
    bubbles = _drawn(rng)
    picture = _lamp(rng) * _dust(rng)
    for i in range(len(bubbles.r)):
        _cover(picture, bubbles, i)
    low, high = rng.uniform(0, 0.04), rng.uniform(0.4, 0.95)
    levels = 255 * (low + (high - low) * picture)
    levels += rng.standard_normal(levels.shape) * np.sqrt(rng.uniform(0.2, 6.0) + levels * rng.uniform(0.002, 0.05))
    frame = np.clip(np.rint(levels), 0, 255).astype(np.uint8)
    r_min_px = float(rng.choice([2.0, 2.5, 4.0]))
    return Scene(
        family="backlit",
        frame=frame,
        flat_field=None,
        tone=DropletTone.DARK,
        r_min_px=r_min_px,
        r_max_px=float(max(60.0, 1.05 * bubbles.r.max())),
        x_px=bubbles.x,
        y_px=bubbles.y,
        r_px=bubbles.r,
        visibility=_visibility(bubbles, picture, r_min_px),
        edge_px=bubbles.r,
    )


def _drawn(rng: np.random.Generator) -> _Bubbles:
    n = int(np.exp(rng.uniform(np.log(80), np.log(1200))))
    # Most are small, as breaking bubbles are; the rarest giants are left out.
    typical, breadth = np.exp(rng.uniform(np.log(1.5), np.log(8.0))), rng.uniform(0.5, 1.0)
    r = np.clip(typical * np.exp(breadth * rng.standard_normal(n)), 1.0, np.exp(rng.uniform(np.log(12), np.log(100))))
    if rng.random() < 0.4:
        r[: int(rng.integers(2, 12))] = rng.uniform(15, 100)
        r *= np.where(r > 15, rng.uniform(0.6, 1.2, n), 1.0)
    r = rng.permutation(r)
    # No more of them than cover the frame about once.
    r = r[np.cumsum(np.pi * r**2) < rng.uniform(0.1, 2.0) * SIDE_PX**2]
    n = len(r)
    lens_px, rim_from, softness = rng.uniform(0.4, 0.9), rng.uniform(0.35, 0.8), rng.uniform(0.02, 0.5)
    defocus = np.abs(rng.standard_normal(n)) * rng.uniform(0.3, 4.0) * (rng.random(n) < rng.uniform(0.2, 0.8))
    order = np.argsort(-r)
    r = r[order]
    x, y = _clustered(rng, r)
    most_stretch = 1.06 + np.clip((r - 6) / 30, 0, 1) * rng.uniform(0.05, 0.5)
    return _Bubbles(
        x=x,
        y=y,
        r=r,
        defocus=defocus,
        blur=np.hypot(lens_px, defocus),
        rim_from=np.clip(rim_from + 0.12 * rng.standard_normal(n), 0.2, 0.88),
        rim=np.clip(rng.uniform(0.0, 0.35) + rng.uniform(0.02, 0.12) * rng.standard_normal(n), 0.0, 0.7),
        halo=rng.uniform(0, 0.25) * rng.uniform(0.3, 1.0, n),
        centre=np.clip(rng.uniform(0.3, 1.0) + 0.2 * rng.standard_normal(n), 0.1, 1.1),
        softness=softness * rng.uniform(0.5, 1.5, n),
        stretch=1 + (most_stretch - 1) * rng.uniform(0, 1, n),
        angle=rng.uniform(0, np.pi, n),
    )


def _clustered(rng: np.random.Generator, r: Column) -> tuple[Column, Column]:
    """Places all over the frame; in some scenes many bubbles touch one that is larger, as they do in foams."""
    x, y = rng.uniform(-10, SIDE_PX + 10, (2, len(r)))
    share = rng.choice([0.0, 0.2, 0.6])
    for i in range(1, len(r)):
        if rng.random() < share:
            # Radii fall: any before is larger; the largest are chosen most.
            other = int(i * rng.random() ** 2)
            angle, apart = rng.uniform(0, 2 * np.pi), rng.uniform(*_TOUCHING) * (r[i] + r[other])
            x[i], y[i] = x[other] + apart * np.cos(angle), y[other] + apart * np.sin(angle)
    return x, y


def _lamp(rng: np.random.Generator) -> Image:
    """Light of the lamp: uneven, and sometimes only in a window with a dark frame around it."""
    coarse = 1 + rng.uniform(0, 0.12) * rng.standard_normal((8, 8))
    light = cv2.resize(coarse.astype(np.float32), (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_CUBIC)
    if rng.random() < 0.6:
        corners = 8
        turn = rng.uniform(0, 2 * np.pi)
        centre = rng.uniform(0.2, 0.8, 2) * SIDE_PX
        at = turn + 2 * np.pi * np.arange(corners) / corners
        polygon = centre + rng.uniform(0.45, 0.9) * SIDE_PX * np.column_stack([np.cos(at), np.sin(at)])
        window = np.full((SIDE_PX, SIDE_PX), rng.uniform(0.0, 0.1), np.float32)
        cv2.fillPoly(window, [polygon.astype(np.int32)], 1.0)
        light = light * cv2.GaussianBlur(window, (0, 0), rng.uniform(1.5, 8.0))
    return np.asarray(light, np.float32)


def _dust(rng: np.random.Generator) -> Image:
    """Grain of the lamp and of what floats far out of focus."""
    grain = np.ones((SIDE_PX, SIDE_PX), np.float32)
    for blur, most in ((1.0, 0.05), (3.0, 0.06), (8.0, 0.08)):
        layer = cv2.GaussianBlur(rng.standard_normal(grain.shape).astype(np.float32), (0, 0), blur)
        grain += np.float32(rng.uniform(0, most)) * layer / layer.std()
    return np.clip(grain, 0.2, 1.3)


def _cover(picture: Image, bubbles: _Bubbles, i: int) -> None:
    """Multiply the picture with the light that bubble `i` lets through."""
    x, y, r, blur = bubbles.x[i], bubbles.y[i], bubbles.r[i], bubbles.blur[i]
    reach = int(np.ceil(1.2 * r + 3 * blur + 2))
    left, top = max(int(x) - reach, 0), max(int(y) - reach, 0)
    right, bottom = min(int(x) + reach + 1, SIDE_PX), min(int(y) + reach + 1, SIDE_PX)
    if left >= right or top >= bottom:
        return
    # Drawn three times as fine, for small bubbles have rims of less than a pixel.
    fine = 3 if r < 12 else 1
    steps = (np.arange(fine) - (fine - 1) / 2) / fine
    rows = (np.arange(top - reach, bottom + reach)[:, None] + steps).ravel() - y
    columns = (np.arange(left - reach, right + reach)[:, None] + steps).ravel() - x
    cosine, sine, long = np.cos(bubbles.angle[i]), np.sin(bubbles.angle[i]), np.sqrt(bubbles.stretch[i])
    along = (columns[None, :] * cosine + rows[:, None] * sine) / long
    across = (rows[:, None] * cosine - columns[None, :] * sine) * long
    distance = np.hypot(along, across) / r
    share = np.clip((bubbles.rim_from[i] - distance) / bubbles.softness[i] + 0.5, 0, 1)
    passed = np.where(distance > 1, 1.0, bubbles.rim[i] + (bubbles.centre[i] - bubbles.rim[i]) * share)
    passed += bubbles.halo[i] * np.exp(-0.5 * ((distance - _HALO_AT) / _HALO_WIDTH) ** 2) * (distance > 1)
    passed = cv2.GaussianBlur(passed.astype(np.float32), (0, 0), blur * fine)
    height, width = bottom - top + 2 * reach, right - left + 2 * reach
    passed = cv2.resize(passed, (width, height), interpolation=cv2.INTER_AREA)
    picture[top:bottom, left:right] *= passed[reach : height - reach, reach : width - reach]


def _visibility(bubbles: _Bubbles, picture: Image, r_min_px: float) -> npt.NDArray[np.str_]:
    """Visible are bubbles in focus of which most of the rim stands against light."""
    angle = 2 * np.pi * (np.arange(_N_ARC) + 0.5) / _N_ARC
    blur_share = bubbles.defocus / bubbles.r
    words = np.full(len(bubbles.r), Visibility.BORDERLINE.value, dtype="<U10")
    for i in range(len(words)):
        hidden, depth, inside = _rim_seen(bubbles, picture, i, angle)
        is_visible = blur_share[i] <= VISIBLE_BLUR and hidden <= _MOST_HIDDEN_VISIBLE and depth >= _LEAST_VISIBLE_DEPTH
        is_not = blur_share[i] > INVISIBLE_BLUR or hidden > _MOST_HIDDEN or depth < _LEAST_DEPTH or inside < 0.5
        if is_visible and inside >= 0.8 and bubbles.r[i] >= r_min_px:
            words[i] = Visibility.VISIBLE.value
        elif is_not or bubbles.r[i] < 0.7 * r_min_px:
            words[i] = Visibility.NOT.value
    return words


def _rim_seen(bubbles: _Bubbles, picture: Image, i: int, angle: Column) -> tuple[float, float, float]:
    """Share of the outline hidden by other rims, light just outside minus in the rim, share inside the frame."""
    x = bubbles.x[i] + (bubbles.r[i] + bubbles.blur[i]) * np.cos(angle)
    y = bubbles.y[i] + (bubbles.r[i] + bubbles.blur[i]) * np.sin(angle)
    is_inside = (x >= 0) & (y >= 0) & (x <= SIDE_PX - 1) & (y <= SIDE_PX - 1)
    if not is_inside.any():
        return 1.0, 0.0, 0.0
    distance = np.hypot(x[:, None] - bubbles.x, y[:, None] - bubbles.y) / bubbles.r
    is_dark = (distance < 1) & (distance > bubbles.rim_from) & (bubbles.rim < 0.5)
    is_dark[:, i] = False
    outside = picture[y[is_inside].astype(int), x[is_inside].astype(int)]
    inward = max(bubbles.r[i] * (1 + bubbles.rim_from[i]) / 2, 0.0)
    rim_x, rim_y = bubbles.x[i] + inward * np.cos(angle), bubbles.y[i] + inward * np.sin(angle)
    rim = picture[
        np.clip(rim_y[is_inside], 0, SIDE_PX - 1).astype(int), np.clip(rim_x[is_inside], 0, SIDE_PX - 1).astype(int)
    ]
    return float(is_dark.any(axis=1).mean()), float(np.mean(outside - rim)), float(is_inside.mean())
