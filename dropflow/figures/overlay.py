"""A frame with its droplets drawn on it: the picture by which people judge a detection."""

from math import floor, log10
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets
from dropflow.errors import ResultsError

Picture = npt.NDArray[np.uint8]

SUBPIXEL_BITS = 4
"""OpenCV draws at fixed-point places with this many bits after the point."""
WHITE, BLACK, RED = (255, 255, 255), (0, 0, 0), (230, 50, 50)


def draw_overlay(
    frame: npt.NDArray[Any],
    droplets: Droplets,
    *,
    rejected: Droplets | None = None,
    pixel_size_um: float | None = None,
    scale: int = 1,
) -> Picture:
    """Draw circles around droplets, coloured by their match, and a scale bar.

    Parameters
    ----------
    frame
        Shape (rows, columns), any real dtype; its contrast is stretched between the 0.5 and 99.8 percentiles.
    droplets
        Droplets of this frame, px.
    rejected
        Candidates that were not accepted: drawn below the droplets, thin and red.
    pixel_size_um
        Makes the scale bar one of micrometres; without it it is one of pixels.
    scale
        Enlarges the picture this many times (for small droplets).

    Returns
    -------
    Shape (rows * scale, columns * scale, 3), uint8, RGB. Circles go from violet (lowest match) to yellow (highest).
    """
    grey = _stretched(frame)
    if scale > 1:
        grey = np.asarray(cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC), np.uint8)
    picture = np.asarray(cv2.cvtColor(grey, cv2.COLOR_GRAY2RGB), np.uint8)
    if rejected is not None:
        _draw_circles(picture, rejected, np.tile(np.array(RED, np.uint8), (len(rejected), 1)), scale)
    _draw_circles(picture, droplets, _colours(droplets.match), scale)
    _draw_scale_bar(picture, pixel_size_um, scale)
    return picture


def _draw_circles(picture: Picture, droplets: Droplets, colours: Picture, scale: int) -> None:
    """Circles of the colours, shape (n, 3), those with the best match on top."""
    offset = (scale - 1) / 2
    for i in np.argsort(droplets.match, kind="stable"):
        place = (droplets.x_px[i] * scale + offset, droplets.y_px[i] * scale + offset)
        centre = (_fixed(place[0]), _fixed(place[1]))
        colour = tuple(int(part) for part in colours[i])
        cv2.circle(picture, centre, _fixed(droplets.r_px[i] * scale), colour, 1, cv2.LINE_AA, SUBPIXEL_BITS)


def write_picture(path: Path, picture: Picture) -> None:
    """Write an RGB picture as PNG, and the folder it goes to. Raises `ResultsError` where it cannot."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(cv2.imencode(".png", np.ascontiguousarray(picture[..., ::-1]))[1].tobytes())
    except OSError as problem:
        message = f"The picture cannot be written ({problem.strerror})."
        raise ResultsError(message, code="results.not_written", file=str(path)) from None


def _stretched(frame: npt.NDArray[Any]) -> Picture:
    levels = frame.astype(np.float32)
    low, high = np.percentile(levels, [0.5, 99.8])
    if high <= low:
        low, high = float(levels.min()), float(levels.max())
    return np.asarray(np.clip((levels - low) * (255 / max(high - low, 1e-9)), 0, 255), np.uint8)


def _colours(match: npt.NDArray[np.float64]) -> Picture:
    """RGB rows of shape (n, 3), by the match between the lowest and the highest in the frame."""
    if len(match) == 0:
        return np.empty((0, 3), np.uint8)
    span = max(float(np.ptp(match)), 1e-9)
    levels = np.rint(60 + 195 * (match - match.min()) / span).astype(np.uint8)
    return np.asarray(cv2.applyColorMap(levels[:, None], cv2.COLORMAP_VIRIDIS)[:, 0, ::-1], np.uint8)


def _fixed(value: float) -> int:
    return round(value * (1 << SUBPIXEL_BITS))


def _draw_scale_bar(picture: Picture, pixel_size_um: float | None, scale: int) -> None:
    """A bar of 1, 2 or 5 times a power of ten, about a fifth of the picture long, at the lower left."""
    rows, columns = picture.shape[:2]
    unit, pixel = ("px", 1.0) if pixel_size_um is None else ("um", pixel_size_um)
    length = _round_length(columns / 5 / scale * pixel)
    length_px = round(length / pixel * scale)
    margin, thick = max(4, columns // 60), max(2, rows // 200)
    text, font, size = f"{length:g} {unit}", cv2.FONT_HERSHEY_SIMPLEX, max(0.35, rows / 1200)
    (text_width, text_height), below = cv2.getTextSize(text, font, size, 1)
    x, y = margin, rows - margin
    text_y = y - thick - below - 2
    # On black, for it must be read on any ground.
    corner = (x + max(length_px, text_width) + 3, y + 3)
    cv2.rectangle(picture, (x - 3, text_y - text_height - 3), corner, BLACK, cv2.FILLED)
    cv2.rectangle(picture, (x, y - thick), (x + length_px, y), WHITE, cv2.FILLED)
    cv2.putText(picture, text, (x, text_y), font, size, WHITE, 1, cv2.LINE_AA)


def _round_length(wanted: float) -> float:
    """The largest of 1, 2, 5, 10, ... (times any power of ten) that is not above `wanted`."""
    power = 10.0 ** floor(log10(wanted))
    return next(step * power for step in (5, 2, 1) if step * power <= wanted * (1 + 1e-12))
