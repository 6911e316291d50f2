"""What an OME-Zarr group (OME-NGFF 0.1 to 0.5) says of its arrays: which one is full size, and what its axes mean."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

_SECONDS = {
    "nanosecond": 1e-9,
    "microsecond": 1e-6,
    "millisecond": 1e-3,
    "second": 1.0,
    "minute": 60.0,
    "hour": 3600.0,
    "day": 86400.0,
}
_OLD_AXES = ("t", "c", "z", "y", "x")
"""Of all images before version 0.3."""


@dataclass(frozen=True)
class OmeArray:
    """The full-size array of an image."""

    path: str
    axes: tuple[str, ...]
    interval_s: float | None
    channel_names: tuple[str, ...]


def described(attributes: Mapping[str, Any]) -> list[OmeArray]:
    """The images that the attributes of a group describe, empty if it is no OME-Zarr."""
    about: Any = attributes.get("ome", attributes)
    return [_described(image, about) for image in about.get("multiscales", ())]


def _described(image: Mapping[str, Any], about: Mapping[str, Any]) -> OmeArray:
    axes = [axis if isinstance(axis, dict) else {"name": axis} for axis in image.get("axes", _OLD_AXES)]
    full_size = image["datasets"][0]
    names = tuple(str(axis["name"]).lower() for axis in axes)
    return OmeArray(
        path=str(full_size["path"]).strip("/"),
        axes=names,
        interval_s=_interval_s(axes, names, [full_size, image]),
        channel_names=tuple(str(channel.get("label", "")) for channel in about.get("omero", {}).get("channels", ())),
    )


def _interval_s(axes: list[dict[str, Any]], names: tuple[str, ...], scaled: list[Mapping[str, Any]]) -> float | None:
    """The step along the time axis, if both its scale and its unit are said."""
    if "t" not in names or (unit := axes[names.index("t")].get("unit")) not in _SECONDS:
        return None
    scales = [step["scale"] for by in scaled for step in by.get("coordinateTransformations", ()) if "scale" in step]
    if not scales:
        return None
    interval_s = _SECONDS[str(unit)]
    for scale in scales:
        interval_s *= float(scale[names.index("t")])
    return interval_s if 0 < interval_s < float("inf") else None
