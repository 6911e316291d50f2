"""What OME-XML says of the pages of a TIFF file: channels, z-planes, times (OME model 2016-06).

Only the file that carries it is ever read: names of other files in it are not followed.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any
from xml.etree import ElementTree

import numpy as np

from dropflow.errors import FramesError
from dropflow.frames.choice import Axes, Choice, pick, select
from dropflow.frames.contract import Times, check_count

_SECONDS = {"s": 1.0, "ms": 1e-3, "µs": 1e-6, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "d": 86400.0}
_AXES = {"T": 0, "Z": 1, "C": 2}


@dataclass(frozen=True)
class _Block:
    """A row of pages that hold planes in the image's order (TiffData)."""

    first_page: int
    start: tuple[int, int, int]
    """Time, z-plane and channel of the first."""
    n_planes: int | None
    """None: all that the file has."""


@dataclass
class OmeImage:
    """One image: a film, or a position of a stage."""

    n_times: int
    n_z_planes: int
    n_channels: int
    channel_names: tuple[str, ...]
    order: str
    """Fastest axis first, such as ``CZT``."""
    increment_s: float | None
    blocks: list[_Block] = field(default_factory=list)
    times_s: dict[tuple[int, int, int], float] = field(default_factory=dict)


@dataclass(frozen=True)
class Chosen:
    """The frames, and how many the file says there are."""

    pages: list[int]
    times_s: Times | None
    n_said: int


def parse(text: str) -> list[OmeImage]:
    """Read the XML in a page's description."""
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ValueError("its OME-XML declares entities")
    root = ElementTree.fromstring(text)  # noqa: S314 - entities are refused above, and nothing else can grow
    own_id = root.get("UUID")
    return [_image(pixels, own_id) for pixels in root.iter() if _tag(pixels) == "Pixels"]


def choose(images: list[OmeImage], n_pages: int, n_samples: int, choice: Choice, name: str) -> Chosen:
    """The pages of the chosen position, channel and z-plane in the order of time, and when each was taken."""
    image = images[pick("position", max(1, len(images)), choice.position, file=name)]
    n_channels = image.n_channels
    if n_samples > 1 and n_channels % n_samples == 0 and len(image.channel_names) != n_channels // n_samples:
        n_channels //= n_samples  # red, green and blue of one page
    elif image.channel_names:
        n_channels = len(image.channel_names)
    chosen = select(Axes(image.n_times, image.n_z_planes, n_channels, image.channel_names), choice, file=name)
    check_count(chosen.n, name)
    page_of = dict(_planes(image, n_channels, n_pages))
    places = [(*chosen.place(index), chosen.channel) for index in range(chosen.n)]
    there = [place for place in places if place in page_of]
    if not there:
        raise FramesError("The chosen images are not in this file.", code="frames.empty", file=name)
    return Chosen([page_of[place] for place in there], _times_s(image, there), chosen.n)


def _planes(image: OmeImage, n_channels: int, n_pages: int) -> Iterator[tuple[tuple[int, int, int], int]]:
    """Time, z-plane and channel of each page of this file."""
    sizes = {"T": image.n_times, "Z": image.n_z_planes, "C": n_channels}
    n_seen = 0
    for block in image.blocks:
        n_left = n_pages - block.first_page
        n_planes = n_left if block.n_planes is None else min(n_left, block.n_planes)
        n_seen += max(0, n_planes)
        if n_seen > n_pages:
            raise ValueError("its OME-XML names a page twice")
        first, stride = 0, 1
        for axis in image.order:
            first += block.start[_AXES[axis]] * stride
            stride *= sizes[axis]
        for offset in range(max(0, min(n_planes, stride - first))):
            place, rest = [0, 0, 0], first + offset
            for axis in image.order:
                rest, place[_AXES[axis]] = divmod(rest, sizes[axis])
            yield (place[0], place[1], place[2]), block.first_page + offset


def _times_s(image: OmeImage, places: list[tuple[int, int, int]]) -> Times | None:
    if any(place in image.times_s for place in places):
        return np.array([image.times_s.get(place, np.nan) for place in places], np.float64)
    if image.increment_s is not None and image.increment_s > 0:
        return np.array([place[0] for place in places], np.float64) * image.increment_s
    return None


def _image(pixels: ElementTree.Element, own_id: str | None) -> OmeImage:
    channels = [child for child in pixels if _tag(child) == "Channel"]
    image = OmeImage(
        n_times=_size(pixels, "SizeT"),
        n_z_planes=_size(pixels, "SizeZ"),
        n_channels=_size(pixels, "SizeC"),
        channel_names=tuple(channel.get("Name") or "" for channel in channels),
        order=_order(pixels),
        increment_s=_seconds(pixels, "TimeIncrement"),
    )
    for child in pixels:
        if _tag(child) == "TiffData" and _is_here(child, own_id):
            image.blocks.append(_block(child))
        elif _tag(child) == "Plane" and (time_s := _seconds(child, "DeltaT")) is not None:
            image.times_s[_int(child, "TheT"), _int(child, "TheZ"), _int(child, "TheC")] = time_s
    return image


def _is_here(tiff_data: ElementTree.Element, own_id: str | None) -> bool:
    """Whether these pages are in this file, not in another of a set."""
    ids = [(child.text or "").strip() for child in tiff_data if _tag(child) == "UUID"]
    return not ids or own_id is None or ids[0] == own_id.strip()


def _block(tiff_data: ElementTree.Element) -> _Block:
    has_page, n_planes = "IFD" in tiff_data.attrib, _int(tiff_data, "PlaneCount", -1)
    start = (_int(tiff_data, "FirstT"), _int(tiff_data, "FirstZ"), _int(tiff_data, "FirstC"))
    if min(_int(tiff_data, "IFD"), *start) < 0:
        raise ValueError("its OME-XML names a page before the first")
    if n_planes < 0:
        return _Block(_int(tiff_data, "IFD"), start, 1 if has_page else None)
    return _Block(_int(tiff_data, "IFD"), start, n_planes)


def _order(pixels: ElementTree.Element) -> str:
    order = pixels.get("DimensionOrder", "XYCZT")[2:]
    if sorted(order) != ["C", "T", "Z"]:
        raise ValueError(f"its OME-XML has the order {order!r}")
    return order


def _seconds(element: ElementTree.Element, attribute: str) -> float | None:
    if attribute not in element.attrib:
        return None
    unit = element.get(f"{attribute}Unit", "s").replace("μ", "µ")
    value = float(element.attrib[attribute]) * _SECONDS.get(unit, np.nan)
    return value if np.isfinite(value) else None


def _size(element: ElementTree.Element, attribute: str) -> int:
    if (size := _int(element, attribute, 1)) < 1:
        raise ValueError(f"its OME-XML has {attribute} {size}")
    return size


def _int(element: ElementTree.Element, attribute: str, default: int = 0) -> int:
    return int(element.get(attribute, default))


def _tag(element: Any) -> str:
    return str(element.tag).rpartition("}")[2]
