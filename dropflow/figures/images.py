"""A camera frame as the background of a figure: scaled to what the eye sees, and small enough for a page."""

import base64
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

MAX_EDGE_PX = 900


def as_image_layer(image: npt.NDArray[Any], pixel_size_um: float, *, max_edge_px: int = MAX_EDGE_PX) -> dict[str, Any]:
    """A layout image that covers the frame in micrometres, the centre of its top left pixel at (0, 0)."""
    n_rows, n_columns = image.shape[:2]
    return {
        "source": data_url(image, max_edge_px),
        "xref": "x",
        "yref": "y",
        "x": -pixel_size_um / 2,
        "y": -pixel_size_um / 2,
        "sizex": n_columns * pixel_size_um,
        "sizey": n_rows * pixel_size_um,
        "xanchor": "left",
        "yanchor": "top",
        "sizing": "stretch",
        "layer": "below",
    }


def data_url(image: npt.NDArray[Any], max_edge_px: int = MAX_EDGE_PX) -> str:
    """A grey image, stretched between its 0.5 and 99.8 percentiles, as a JPEG data URL no longer than `max_edge_px`."""
    small = np.asarray(image, np.float32)
    scale = max_edge_px / max(small.shape)
    if scale < 1:
        small = np.asarray(cv2.resize(small, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.float32)
    low, high = np.percentile(small, [0.5, 99.8])
    grey = np.clip((small - low) * (255 / max(high - low, 1e-9)), 0, 255).astype(np.uint8)
    is_encoded, content = cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, 85])
    if not is_encoded:
        raise RuntimeError("OpenCV could not encode a JPEG")
    return "data:image/jpeg;base64," + base64.b64encode(content.tobytes()).decode("ascii")
