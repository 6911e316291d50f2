"""What detection finds in a frame or a part of it."""

import base64
import time
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from backend.platform.previews import PreviewRequest, Region
from dropflow.detection.contract import Detection, Image
from dropflow.droplets import Droplets
from dropflow.errors import FieldProblem, ParametersError
from dropflow.parameters import Parameters
from worker.preview_films import Film

_QUALITY = 88
_DARK_PERCENT, _BRIGHT_PERCENT = 0.5, 99.8
MOST_REJECTED = 20_000


def found_in(film: Film, request: PreviewRequest, parameters: Parameters) -> dict[str, Any]:
    """Droplets and rejected candidates, as JSON."""
    began_s = time.monotonic()
    image = film.prepared(parameters, request.frame)
    part = None if request.region is None else _checked(request.region, image.shape)
    detection = film.detection(parameters, request.frame) if part is None else _in_part(film, parameters, image, part)
    took_s = time.monotonic() - began_s
    rejected = detection.rejected.droplets
    return {
        "frame": request.frame,
        "region": None if part is None else part.model_dump(),
        **columns(detection.droplets, "x_px", "y_px", "r_px", "match", "probability"),
        "rejected": {
            **columns(rejected[:MOST_REJECTED], "x_px", "y_px", "r_px"),
            "reason": list(detection.rejected.reasons[:MOST_REJECTED]),
        },
        "took_s": took_s,
        "prepared_jpeg": picture(_cut(image, part)) if request.is_picture_wanted else None,
    }


def columns(droplets: Droplets, *names: str) -> dict[str, list[float | None]]:
    """Columns as JSON has them: what is not a number is null."""
    return {name: [float(value) if np.isfinite(value) else None for value in getattr(droplets, name)] for name in names}


def _in_part(film: Film, parameters: Parameters, image: Image, part: Region) -> Detection:
    """Look at the part and as much around it as the largest droplet needs; keep what lies in the part."""
    around = int(np.ceil(2 * parameters.detection.radius_max_um / film.experiment.pixel_size_um)) + 8
    left, top = max(0, part.x_px - around), max(0, part.y_px - around)
    right, bottom = part.x_px + part.width_px + around, part.y_px + part.height_px + around
    found = film.detector(parameters).detect(np.ascontiguousarray(image[top:bottom, left:right]))
    droplets, rejected = _moved(found.droplets, left, top), _moved(found.rejected.droplets, left, top)
    is_there = _lies_in(rejected, part)
    reasons = tuple(reason for reason, kept in zip(found.rejected.reasons, is_there, strict=True) if kept)
    kept_rejected = type(found.rejected)(rejected[is_there], reasons)
    return Detection(droplets[_lies_in(droplets, part)], kept_rejected)


def _moved(droplets: Droplets, left: int, top: int) -> Droplets:
    names = Droplets.__dataclass_fields__
    moved = {"x_px": droplets.x_px + left, "y_px": droplets.y_px + top}
    return Droplets(*(moved.get(name, getattr(droplets, name)) for name in names))


def _lies_in(droplets: Droplets, part: Region) -> npt.NDArray[np.bool_]:
    is_across = (droplets.x_px >= part.x_px) & (droplets.x_px < part.x_px + part.width_px)
    return np.asarray(is_across & (droplets.y_px >= part.y_px) & (droplets.y_px < part.y_px + part.height_px))


def _checked(region: Region, shape: tuple[int, ...]) -> Region:
    """The region within the frame."""
    rows, columns = shape
    left, top = max(0, region.x_px), max(0, region.y_px)
    right = min(columns, region.x_px + region.width_px)
    bottom = min(rows, region.y_px + region.height_px)
    if right - left < 1 or bottom - top < 1:
        problem = FieldProblem("region", f"lies outside the frame of {columns} x {rows} pixels")
        raise ParametersError("There is nothing of the frame in this region.", fields=[problem])
    return Region(x_px=left, y_px=top, width_px=right - left, height_px=bottom - top)


def _cut(image: Image, part: Region | None) -> Image:
    if part is None:
        return image
    return image[part.y_px : part.y_px + part.height_px, part.x_px : part.x_px + part.width_px]


def picture(image: Image) -> str:
    """A prepared frame, or a part of one, as a JPEG in base64."""
    step = max(1, max(image.shape) // 600)
    dark, bright = np.percentile(image[::step, ::step], (_DARK_PERCENT, _BRIGHT_PERCENT))
    grey = np.clip((image - dark) * (255 / max(bright - dark, 1e-9)), 0, 255).astype(np.uint8)
    is_encoded, content = cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    if not is_encoded:
        raise RuntimeError("OpenCV could not encode a JPEG image")
    return base64.b64encode(content.tobytes()).decode()
