"""One frame of a film kept for the working panels: a prepared piece of it, and the frame itself, small.

Detection is imported where it is used: it takes long to load, and the service starts without it.
"""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import cv2
import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from dropflow.droplets import Droplets
from dropflow.experiment import Experiment
from dropflow.figures.images import MAX_EDGE_PX
from dropflow.figures.layout import new_figure, say_empty
from dropflow.parameters import Parameters
from dropflow.radius_range import radius_range_px

if TYPE_CHECKING:
    from dropflow.preprocess import StackEstimate

Image = npt.NDArray[np.float32]

EXAMPLE_FILE = "example.npz"
WORKING_PANELS = ("thresholding", "watershed", "match")
"""Figures that are drawn from an example alone."""
_SMALLEST_PX, _LARGEST_PX = 120, 260
_RADII_WIDE = 8.0
"""Sides of the piece in largest radii, between the limits above."""


@dataclass(frozen=True)
class Example:
    """What the working panels are drawn from."""

    frame: int
    left_px: int
    top_px: int
    """Where the piece is in the frame."""
    prepared: Image
    """The piece as the paper's detection prepares it, shape (rows, columns), levels 0 to 255."""
    level: float
    """Threshold for small, faint droplets."""
    maxima_height: float
    r_min_px: float
    r_max_px: float
    droplet_px: npt.NDArray[np.float64]
    """x, y and r of a droplet in the piece, shape (3,); shape (0,) where it has none."""
    small: npt.NDArray[np.uint8]
    """The whole frame, small."""
    shape: npt.NDArray[np.int64]
    """Rows and columns of the whole frame."""

    def whole(self) -> Image:
        """The whole frame in its own size, as a background."""
        rows, columns = self.shape.tolist()
        return np.asarray(cv2.resize(self.small, (columns, rows), interpolation=cv2.INTER_LINEAR), np.float32)

    def save(self, path: Path) -> None:
        """Write it; the file appears whole or not at all."""
        unfinished = path.with_name(path.name + ".part")
        with unfinished.open("wb") as file:
            arrays: dict[str, Any] = {field.name: np.asarray(getattr(self, field.name)) for field in fields(self)}
            arrays["prepared"] = np.rint(self.prepared).astype(np.uint8)
            np.savez_compressed(file, **arrays)
        unfinished.replace(path)

    @staticmethod
    def load(file: BinaryIO) -> "Example":
        """Read what `save` wrote."""
        with np.load(file, allow_pickle=False) as arrays:
            values = {field.name: arrays[field.name] for field in fields(Example)}
        values["prepared"] = values["prepared"].astype(np.float32)
        return Example(**{name: value if value.ndim else value.item() for name, value in values.items()})


def make_example(
    image: npt.NDArray[Any],
    frame: int,
    droplets: Droplets,
    experiment: Experiment,
    parameters: Parameters,
    measured: "StackEstimate",
) -> Example:
    """Prepare a piece of a frame where there are many droplets, as sections 3.1.1 to 3.1.3 do.

    Parameters
    ----------
    image
        The frame as read.
    frame
        Its number.
    droplets
        What was detected in it.
    experiment, parameters, measured
        What the detector is made of.
    """
    from dropflow.detection.paper.detector import PaperDetector
    from dropflow.detection.paper.thresholding import background_level, threshold_levels
    from dropflow.preprocess import noise_std

    r_min_px, r_max_px = radius_range_px(experiment, parameters, measured.shape)
    knobs = parameters.detection.paper
    detector = PaperDetector(measured, experiment.droplets, r_min_px, r_max_px, knobs)
    prepared = detector.prepare(image)
    noise = noise_std(prepared, apart_px=r_min_px, blur_px=detector.blurs()[1].sigma_x)
    level = float(min(threshold_levels(background_level(prepared), noise, knobs)))
    side = int(np.clip(_RADII_WIDE * r_max_px, _SMALLEST_PX, _LARGEST_PX))
    left, top = _busy_place(droplets, prepared.shape, side)
    piece = np.ascontiguousarray(prepared[top : top + side, left : left + side])
    return Example(
        frame=frame,
        left_px=left,
        top_px=top,
        prepared=piece,
        level=level,
        maxima_height=float(max(knobs.maxima_height, knobs.noise_margin * noise)),
        r_min_px=r_min_px,
        r_max_px=r_max_px,
        droplet_px=_droplet(droplets, left, top, piece.shape),
        small=_small(image),
        shape=np.array(image.shape[:2]),
    )


def _busy_place(droplets: Droplets, shape: tuple[int, ...], side: int) -> tuple[int, int]:
    """Left and top of the square with most of the droplets' area, among squares half a side apart.

    Droplets that lie whole in the square count before those that it cuts.
    """
    rows, columns = shape
    best, place = (0.0, 0.0), (max(0, (columns - side) // 2), max(0, (rows - side) // 2))
    area = droplets.r_px**2
    for top in _steps(rows - side, side // 2):
        for left in _steps(columns - side, side // 2):
            is_whole = _is_whole(droplets, left, top, (min(side, rows), min(side, columns)))
            is_in = (np.abs(droplets.x_px - left - side / 2) < side / 2) & (
                np.abs(droplets.y_px - top - side / 2) < side / 2
            )
            found = float(area[is_whole].sum()), float(area[is_in].sum())
            if found > best:
                best, place = found, (left, top)
    return place


def _steps(last: int, step: int) -> list[int]:
    """From 0 to `last`, which is among them."""
    return sorted({*range(0, max(last, 0) + 1, max(step, 1)), max(last, 0)})


def _is_whole(droplets: Droplets, left: int, top: int, shape: tuple[int, ...]) -> npt.NDArray[np.bool_]:
    """Which droplets lie in a piece with their ring."""
    x, y, r = droplets.x_px - left, droplets.y_px - top, droplets.r_px
    rows, columns = shape
    return (x > 1.5 * r) & (y > 1.5 * r) & (x < columns - 1.5 * r) & (y < rows - 1.5 * r)


def _droplet(droplets: Droplets, left: int, top: int, shape: tuple[int, ...]) -> npt.NDArray[np.float64]:
    """The best match among the droplets that lie whole in the piece."""
    inside = _is_whole(droplets, left, top, shape)
    if not inside.any():
        return np.empty(0)
    best = int(np.argmax(np.where(inside, droplets.match, -np.inf)))
    return np.array([droplets.x_px[best] - left, droplets.y_px[best] - top, droplets.r_px[best]], np.float64)


def _small(image: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
    # Made small first: percentiles of all pixels take ten times longer.
    scale = min(1.0, MAX_EDGE_PX / max(image.shape))
    grey: npt.NDArray[Any] = image.astype(np.float32)
    if scale < 1:
        grey = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    low, high = np.percentile(grey, [0.5, 99.8])
    return np.asarray(np.clip((grey - low) * (255 / max(high - low, 1e-9)), 0, 255), np.uint8)


def draw_example(name: str, example: Example, *, parameters: Parameters, title: str, caption: str) -> go.Figure:
    """The working panel ``thresholding``, ``watershed`` or ``match`` of an example."""
    from dropflow.figures import working

    radii = {"r_min_px": example.r_min_px, "r_max_px": example.r_max_px}
    where = f"Frame {example.frame}, from ({example.left_px}, {example.top_px}) px. {caption}"
    if name == "thresholding":
        return working.thresholding(example.prepared, example.level, **radii, title=title, caption=where)
    if name == "watershed":
        height = example.maxima_height
        return working.watershed(example.prepared, maxima_height=height, **radii, title=title, caption=where)
    if not len(example.droplet_px):
        return say_empty(new_figure(title, where), "no droplet was detected whole in this piece")
    x, y, r = example.droplet_px.tolist()
    knobs = parameters.detection.paper
    return working.match(example.prepared, x, y, r, knobs=knobs, title=title, caption=where)
