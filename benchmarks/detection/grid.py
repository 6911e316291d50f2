"""The grid of trackpy's pull request 807: discs without overlap, by size ratio, gap and noise."""

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.detection import make_detector
from dropflow.experiment import parse_experiment
from dropflow.parameters import parse_parameters
from dropflow.preprocess import estimate_stack

SIDE_PX, LEAST_RADIUS_PX = 500, 5.0
RATIOS, GAPS_PX, NOISES = (3, 5, 10), (24, 10, 3), (1, 5, 12)
N_FRAMES = 3
_FINE = 8


def grid() -> None:
    """Print recall, precision and radius error of `default` in each cell."""
    print(f"\n{SIDE_PX} x {SIDE_PX} px, radii from {LEAST_RADIUS_PX:g} px, {N_FRAMES} frames a cell")
    print(
        f"{'ratio':>6}{'gap px':>7}{'noise':>6}{'n':>5}{'recall':>8}{'precision':>10}{'r bias %':>9}{'largest %':>10}"
    )
    for ratio in RATIOS:
        for gap_px in GAPS_PX:
            for noise in NOISES:
                print(f"{ratio:>6}{gap_px:>7}{noise:>6}{_cell(ratio, gap_px, noise)}", flush=True)


def _cell(ratio: int, gap_px: int, noise: int) -> str:
    n_true = n_found = n_right = 0
    errors: list[float] = []
    for seed in range(N_FRAMES):
        frame, true = disc_frame(np.random.default_rng([807, ratio, gap_px, noise, seed]), ratio, gap_px, noise)
        found = _found(frame, LEAST_RADIUS_PX * ratio)
        distance = np.hypot(found[:, None, 0] - true[None, :, 0], found[:, None, 1] - true[None, :, 1])
        nearest = np.argmin(distance, axis=0) if len(found) else np.empty(0, np.int64)
        is_hit = distance[nearest, np.arange(len(true))] < 0.5 * true[:, 2]
        errors += list(found[nearest[is_hit], 2] / true[is_hit, 2] - 1)
        n_true, n_found, n_right = n_true + len(true), n_found + len(found), n_right + int(is_hit.sum())
    bias, most = 100 * np.median(errors), 100 * np.max(np.abs(errors))
    return f"{n_true:>5}{n_right / n_true:>8.3f}{n_right / max(n_found, 1):>10.3f}{bias:>+9.1f}{most:>10.1f}"


def _found(frame: npt.NDArray[np.uint8], largest_px: float) -> npt.NDArray[np.float64]:
    about = {"name": "grid", "pixel_size_um": 1.0, "frame_interval_s": 1.0, "droplets": "bright", "material": "none"}
    radii = {"radius_min_um": 0.8 * LEAST_RADIUS_PX, "radius_max_um": 1.2 * largest_px}
    film, knobs = parse_experiment(about), parse_parameters({"detection": radii})
    detector = make_detector(film, knobs, estimate_stack([frame], film, knobs))
    droplets = detector.detect(detector.prepare(frame)).droplets
    return np.column_stack([droplets.x_px, droplets.y_px, droplets.r_px])


def disc_frame(
    rng: np.random.Generator, ratio: float, gap_px: float, noise: float
) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float64]]:
    """Discs of level 200 on 20 with their truth x, y, r, shape (n, 3)."""
    placed = np.empty((0, 3))
    for _ in range(2000):
        r = rng.uniform(LEAST_RADIUS_PX, LEAST_RADIUS_PX * ratio)
        x, y = rng.uniform(r + gap_px, SIDE_PX - 1 - r - gap_px, 2)
        if np.all(np.hypot(placed[:, 0] - x, placed[:, 1] - y) >= placed[:, 2] + r + gap_px):
            placed = np.vstack([placed, [x, y, r]])
        if len(placed) >= 80:
            break
    fine = np.zeros((SIDE_PX * _FINE,) * 2, np.uint8)
    for x, y, r in placed:
        centre = round(((x + 0.5) * _FINE - 0.5) * 16), round(((y + 0.5) * _FINE - 0.5) * 16)
        cv2.circle(fine, centre, round(r * _FINE * 16), 255, -1, shift=4)
    share = cv2.resize(fine, (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_AREA) / 255
    levels = 20 + 180 * share + noise * rng.standard_normal(share.shape)
    return np.clip(np.rint(levels), 0, 255).astype(np.uint8), placed
