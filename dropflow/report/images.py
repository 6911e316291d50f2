"""Figures as files to print: PNG, SVG or PDF, drawn by kaleido with the Chromium of the machine."""

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from dropflow.errors import DropflowError

if TYPE_CHECKING:
    import plotly.graph_objects as go

_SCALE = 3
"""Pixels of a PNG per CSS pixel: 288 dpi."""


class ImageFormat(StrEnum):
    """What a printed figure may be."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


def write_images(figures: "Mapping[str, go.Figure]", folder: Path, kind: ImageFormat) -> list[Path]:
    """Write each figure to ``<name>.<kind>`` in `folder`; return the files.

    Raises
    ------
    DropflowError
        kaleido is not installed, or there is no Chromium it can start.
    """
    try:
        import kaleido
    except ImportError:
        raise DropflowError(
            "Figures as files need kaleido.", code="figures.no_kaleido", hint="Install dropflow[figures]."
        ) from None
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{name}.{kind}" for name in figures]
    options = {"format": str(kind), "scale": _SCALE if kind is ImageFormat.PNG else 1}
    jobs = [
        {"fig": figure.to_dict(), "path": path, "opts": options}
        for figure, path in zip(figures.values(), paths, strict=True)
    ]
    try:
        kaleido.write_fig_from_object_sync(jobs, cancel_on_error=True)
    except Exception as problem:  # kaleido hands on whatever its browser says, of no common class
        raise DropflowError(
            f"The figures could not be drawn ({type(problem).__name__}: {problem}).",
            code="figures.not_drawn",
            hint="kaleido needs a Chromium or Chrome on this machine.",
        ) from None
    return paths
