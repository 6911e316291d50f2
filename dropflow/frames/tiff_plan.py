"""Which pages of a TIFF file are the frames, and when they were taken: plain, ImageJ and OME files."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from math import prod

import numpy as np
import tifffile

from dropflow.errors import FramesError
from dropflow.frames import ome
from dropflow.frames.choice import Axes, Choice, check_single, pick, select
from dropflow.frames.contract import Times, check_count
from dropflow.frames.findings import Finding, finding

_SECONDS = {"s": 1.0, "sec": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "msec": 1e-3, "min": 60.0, "h": 3600.0}
_METAMORPH_PLANES_TAG = 33629


@dataclass(frozen=True)
class Plan:
    """The frames of one TIFF file."""

    pages: Sequence[int]
    """Page of each frame; with `is_one_block`, place of each frame in the data of page 0."""
    times_s: Times | None = None
    findings: tuple[Finding, ...] = ()
    is_one_block: bool = False
    """One page stands for all: its data is followed by that of the other frames (ImageJ beyond 4 GB, MetaMorph)."""


def plan(first: tifffile.TiffPage, n_pages: int, choice: Choice, name: str) -> Plan:
    """Read what the first page says of all."""
    description = first.description or ""
    if first.is_ome:
        chosen = ome.choose(ome.parse(description), n_pages, first.samplesperpixel, choice, name)
        return Plan(chosen.pages, chosen.times_s, fewer(len(chosen.pages), chosen.n_said))
    if description.startswith("ImageJ="):
        return _imagej(_fields(description), n_pages, choice, name)
    n_in_block = _n_in_block(first, description) if n_pages == 1 else 1
    check_single(choice, file=name)
    check_count(n_in_block, name)
    return Plan(range(max(n_pages, n_in_block)), is_one_block=n_in_block > 1)


def fewer(n_found: int, n_said: int) -> tuple[Finding, ...]:
    """What to say of a file that holds fewer frames than it says."""
    if n_found >= n_said:
        return ()
    message = f"The file says it holds {n_said} frames, but {n_found} are in it: the film may have been stopped early."
    return (finding("stack.frames_fewer", message, (), n=n_said - n_found),)


def _fields(description: str) -> dict[str, str]:
    return dict(line.split("=", 1) for line in description.splitlines() if "=" in line)


def _imagej(fields: dict[str, str], n_pages: int, choice: Choice, name: str) -> Plan:
    """Pages are in the order channel, slice, frame. ImageJ calls the pages of any film slices until it is told."""
    n_channels, n_slices, n_times = (max(1, _int(fields.get(key))) for key in ("channels", "slices", "frames"))
    n_images = max(_int(fields.get("images")), 1)
    if n_channels * n_slices * n_times != n_images:
        n_channels, n_slices, n_times = 1, 1, n_images
    if n_times == 1:
        n_times, n_slices = n_slices, 1
    is_one_block = n_pages == 1 and n_images > 1
    n_there = n_images if is_one_block else n_pages
    pick("position", 1, choice.position, file=name)
    chosen = select(Axes(n_times, n_slices, n_channels), choice, file=name)
    check_count(chosen.n, name)
    pages = []
    for index in range(chosen.n):
        time, z_plane = chosen.place(index)
        page = chosen.channel + n_channels * (z_plane + n_slices * time)
        if page < n_there:
            pages.append(page)
    if not pages:
        raise FramesError("The chosen images are not in the file.", code="frames.empty", file=name)
    return Plan(pages, _imagej_times_s(fields, len(pages)), fewer(len(pages), chosen.n), is_one_block)


def _imagej_times_s(fields: dict[str, str], n_frames: int) -> Times | None:
    try:
        interval_s = float(fields.get("finterval", "0")) * _SECONDS[fields.get("tunit", "s").strip().lower()]
    except (ValueError, KeyError):
        return None
    return np.arange(n_frames, dtype=np.float64) * interval_s if 0 < interval_s < np.inf else None


def _n_in_block(first: tifffile.TiffPage, description: str) -> int:
    """Frames in the data of a single page, as MetaMorph and tifffile say it."""
    if first.is_stk and (tag := first.tags.get(_METAMORPH_PLANES_TAG)) is not None:
        return int(tag.count)
    if description.startswith("{") and '"shape"' in description:
        try:
            said = json.loads(description)
            shape = tuple(map(int, said["shape"])) if said.get("truncated") else ()
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            return 1
        if shape[-2:] == (first.imagelength, first.imagewidth):
            return prod(shape[:-2])
    return 1


def _int(text: str | None) -> int:
    try:
        return int(text or 0)
    except ValueError:
        return 0
