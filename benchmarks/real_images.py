"""Detection on real images: what is found, and where somebody labelled them, how much of it is right.

    python benchmarks/real_images.py DATA [--overlays FOLDER] [--parameters FILE]

DATA is the folder with `trackpy_bulk_water`, `boilercv_boiling` and `bubbles_zerog_gold`. Overlays are pictures
of the frames with the found droplets drawn on them.
"""

import argparse
import csv
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from dropflow.detection import make_detector
from dropflow.droplets import Droplets
from dropflow.experiment import Experiment, GreyFrom, parse_experiment
from dropflow.figures.overlay import draw_overlay
from dropflow.frames import Choice, open_frames
from dropflow.parameters import Parameters, load_parameters
from dropflow.preprocess import estimate_stack

MIN_IOU = 0.5
TRUSTED_RADIUS_PX = 8.0
"""Smaller bubbles of `bubbles_zerog_gold` are labelled in two quadrants only."""
SMALL_RADIUS_PX = 4.0
"""Below it the radius of a label is that of the dark core of a blurred bubble."""
QUADRANTS = {"ZeroG_FlightDay_Test_C1S0014_img018008", "ZeroG_FlightDay_Test__C1S0004_IMG_S0001005070"}


@dataclass(frozen=True)
class Set:
    """One data set and the radii that are in it."""

    path: str
    pixel_size_um: float
    radii_um: tuple[float, float]
    grey_from: GreyFrom | None = None

    def experiment(self) -> Experiment:
        fields = {"name": self.path, "pixel_size_um": self.pixel_size_um, "frame_interval_s": 1.0, "droplets": "dark"}
        return parse_experiment(fields | {"material": "unknown"})

    def parameters(self, base: Parameters) -> Parameters:
        low, high = self.radii_um
        detection = base.detection.model_copy(update={"radius_min_um": low, "radius_max_um": high})
        return base.model_copy(update={"detection": detection})


WATER = Set("trackpy_bulk_water", 1 / 2.85, (0.71, 5.0), GreyFrom.LUMINANCE)
BOILING = Set("boilercv_boiling/boiling_binarized_101x800x600_uint8.tif", 1.0, (4.0, 60.0))
BUBBLES = Set("bubbles_zerog_gold/frames", 1.0, (2.0, 80.0))


def detect(images: Set, frame: npt.NDArray[Any], base: Parameters) -> tuple[Droplets, float]:
    """Droplets of one frame and the CPU time it took, ms."""
    film, knobs = images.experiment(), images.parameters(base)
    detector = make_detector(film, knobs, estimate_stack([frame], film, knobs))
    start = time.process_time()
    droplets = detector.detect(detector.prepare(frame)).droplets
    return droplets, (time.process_time() - start) * 1e3


def intersection_over_union(found: npt.NDArray[np.float64], true: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Shape (n found, n true) for circles given as columns x, y, r."""
    distance = np.hypot(found[:, None, 0] - true[None, :, 0], found[:, None, 1] - true[None, :, 1])
    r, s = found[:, None, 2] + 0 * distance, true[None, :, 2] + 0 * distance
    small = np.pi * np.minimum(r, s) ** 2
    safe = np.maximum(distance, 1e-9)
    a = np.arccos(np.clip((safe**2 + r**2 - s**2) / (2 * safe * r), -1, 1))
    b = np.arccos(np.clip((safe**2 + s**2 - r**2) / (2 * safe * s), -1, 1))
    lens = r**2 * (a - np.sin(2 * a) / 2) + s**2 * (b - np.sin(2 * b) / 2)
    shared = np.where(distance >= r + s, 0, np.where(distance <= np.abs(r - s), small, lens))
    return shared / (np.pi * (r**2 + s**2) - shared)


def labelled_bubbles(folder: Path, name: str) -> npt.NDArray[np.float64]:
    """Columns x, y, r of the labels of one image."""
    with (folder / "circles.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["image"] == name and row["label"] == "bubble"]
    return np.array([[float(row[key]) for key in ("cx_px", "cy_px", "r_eq_px")] for row in rows])


def labelled_region(folder: Path, name: str) -> tuple[float, ...]:
    with (folder / "valid_regions.csv").open() as file:
        return next(
            tuple(float(row[k]) for k in ("x0", "y0", "x1", "y1"))
            for row in csv.DictReader(file)
            if row["image"] == name
        )


def score_bubbles(folder: Path, name: str, droplets: Droplets) -> str:
    """Recall and radius error; precision only where every bubble was labelled."""
    true = labelled_bubbles(folder, name)
    is_whole = name in QUADRANTS
    x0, y0, x1, y1 = labelled_region(folder, name)
    found = np.column_stack([droplets.x_px, droplets.y_px, droplets.r_px])
    found = found[(found[:, 0] >= x0) & (found[:, 0] < x1) & (found[:, 1] >= y0) & (found[:, 1] < y1)]
    if not is_whole:
        true = true[true[:, 2] >= TRUSTED_RADIUS_PX]
    overlap = intersection_over_union(found, true)
    rows, columns = linear_sum_assignment(-overlap)
    is_hit = overlap[rows, columns] >= MIN_IOU
    n_hits = int(is_hit.sum())
    error = found[rows[is_hit], 2] / true[columns[is_hit], 2] - 1
    text = f"recall {n_hits / len(true):.2f} of {len(true)}"
    if is_whole:
        precision, recall = n_hits / max(len(found), 1), n_hits / len(true)
        text += f", precision {precision:.2f}, F1 {2 * precision * recall / max(precision + recall, 1e-9):.2f}"
    if n_hits:
        text += f", radius {100 * np.median(error):+.1f} +- {100 * error.std():.1f} %"
    return text + (f"; {placed(found, true)}" if is_whole else "")


def placed(found: npt.NDArray[np.float64], true: npt.NDArray[np.float64]) -> str:
    """How many labels have a circle of their own whose centre is within them, whatever its size."""
    distance = np.hypot(found[:, None, 0] - true[None, :, 0], found[:, None, 1] - true[None, :, 1])
    rows, columns = linear_sum_assignment(np.minimum(distance / true[:, 2], 1.0))
    is_within = distance[rows, columns] < true[columns, 2]
    ratio = found[rows[is_within], 2] / true[columns[is_within], 2]
    is_small = true[columns[is_within], 2] < SMALL_RADIUS_PX
    share, times = is_within.sum() / len(true), np.median(ratio[is_small])
    return f"{100 * share:.0f} % have a circle at their place, below {SMALL_RADIUS_PX:g} px {times:.2f} times as large"


def report(images: Set, label: str, frame: npt.NDArray[Any], base: Parameters, overlays: Path | None) -> Droplets:
    """Print one line about one frame."""
    droplets, cpu_ms = detect(images, frame, base)
    quartiles = np.percentile(droplets.r_px, [10, 50, 90]) if len(droplets) else np.full(3, np.nan)
    radii = " / ".join(f"{value:.1f}" for value in quartiles)
    print(f"{label:55} {len(droplets):5} droplets, radii {radii} px (10, 50, 90 %), {cpu_ms:5.0f} ms")
    if overlays is not None:
        overlays.mkdir(parents=True, exist_ok=True)
        pixel = None if images.pixel_size_um == 1.0 else images.pixel_size_um
        picture = draw_overlay(frame, droplets, pixel_size_um=pixel, scale=2)
        cv2.imwrite(str(overlays / f"{label.replace('/', '_')}.png"), np.ascontiguousarray(picture[..., ::-1]))
    return droplets


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("data", type=Path)
    arguments.add_argument("--overlays", type=Path)
    arguments.add_argument("--parameters", type=Path)
    given = arguments.parse_args()
    cv2.setNumThreads(1)
    base = load_parameters(given.parameters) if given.parameters else Parameters()
    for images, which in (WATER, (0, 25, 49)), (BOILING, (0, 50, 100)):
        with open_frames(given.data / images.path, Choice(grey_from=images.grey_from)) as frames:
            for i in which:
                report(images, f"{images.path.split('/')[0]} frame {i}", frames[i], base, given.overlays)
    bubbles(given.data, base, given.overlays)


def bubbles(data: Path, base: Parameters | None = None, overlays: Path | None = None) -> None:
    """Print what is found of the labelled bubbles."""
    for file in sorted((data / BUBBLES.path).glob("*.png")):
        with open_frames(file) as frames:
            droplets = report(BUBBLES, file.stem, frames[0], base or Parameters(), overlays)
        print(f"{'':55} {score_bubbles(data / 'bubbles_zerog_gold', file.stem, droplets)}")


if __name__ == "__main__":
    main()
