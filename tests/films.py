"""Small films whose analysis takes a moment: a few discs that rise, in frames of any file format."""

import io
from dataclasses import dataclass
from functools import cache
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import tifffile

N_FRAMES, ROWS, COLUMNS = 6, 160, 200
_START_PX = ((40.0, 120.0, 8.0), (90.0, 60.0, 12.0), (150.0, 100.0, 6.0), (60.0, 40.0, 5.0), (170.0, 45.0, 10.0))
_STEP_PX = (1.5, -2.0)

EXPERIMENT: dict[str, Any] = {
    "name": "five discs",
    "pixel_size_um": 1.0,
    "frame_interval_s": 1.0,
    "droplets": "bright",
    "material": {"delta_density_kg_m3": -20.0, "viscosity_pa_s": 0.001},
}
# The methods of the paper, which are the quickest on so few droplets.
PARAMETERS: dict[str, Any] = {
    "detection": {"method": "paper", "radius_min_um": 4.0, "radius_max_um": 20.0},
    "tracking": {"method": "paper"},
    "flow": {"n_columns": 5, "n_rows": 4},
}


@dataclass(frozen=True)
class Upload:
    """One file as it is uploaded."""

    name: str
    content: bytes
    role: str = "frames"


@cache
def frame(index: int, shape: tuple[int, int] = (ROWS, COLUMNS)) -> npt.NDArray[np.uint8]:
    """Discs that all move alike, on a noisy ground; the same index gives the same frame."""
    noise = np.random.default_rng(index).normal(30, 1.5, shape)
    image = noise.astype(np.float32)
    for x, y, r in _START_PX:
        centre = (round((x + index * _STEP_PX[0]) * 16), round((y + index * _STEP_PX[1]) * 16))
        disc = np.zeros(shape, np.float32)
        cv2.circle(disc, centre, round(r * 16), 120.0, -1, cv2.LINE_AA, shift=4)
        image += disc
    return np.clip(cv2.GaussianBlur(image, None, 1.0), 0, 255).astype(np.uint8)


def tiff(*frames: npt.NDArray[Any]) -> bytes:
    """Frames as a TIFF of so many pages."""
    packed = io.BytesIO()
    tifffile.imwrite(packed, np.stack(frames), photometric="minisblack")
    return packed.getvalue()


def png(image: npt.NDArray[Any]) -> bytes:
    """An image as PNG."""
    return bytes(cv2.imencode(".png", image)[1].tobytes())


def film(n_frames: int = N_FRAMES) -> list[Upload]:
    """A folder of frames."""
    return [Upload(f"frames/frame{index}.tif", tiff(frame(index))) for index in range(n_frames)]
