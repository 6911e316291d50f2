"""Every way of finding droplets, as a function from a still to a table of droplets and CPU milliseconds."""

import time
import warnings
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from benchmarks.detection.plain import plain_paper
from benchmarks.detection.stills import Still
from dropflow.detection import make_detector
from dropflow.droplets import Droplets
from dropflow.experiment import DropletTone
from dropflow.preprocess import estimate_stack

Found = tuple[Droplets, float]


def ours(still: Still, method: str) -> Found:
    """Droplets by a method of Dropflow; what is done once a stack is not counted."""
    film, knobs = still.experiment(), still.parameters(method)
    detector = make_detector(film, knobs, estimate_stack([still.frame], film, knobs, still.flat_field))
    start = time.process_time()
    droplets = detector.detect(detector.prepare(still.frame)).droplets
    return droplets, 1e3 * (time.process_time() - start)


def trackpy_located(still: Still) -> Found:
    """trackpy.locate with one diameter, that of the median visible droplet; size is taken for r / sqrt(2)."""
    import trackpy

    trackpy.quiet()
    radii = still.truth["r_px"].to_numpy()[still.truth["visibility"].to_numpy(zero_copy_only=False) == "visible"]
    diameter = 2 * round(float(np.median(radii))) + 1
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        start = time.process_time()
        rows = trackpy.locate(still.frame, diameter, invert=still.scenario.droplets is DropletTone.DARK)
        took = 1e3 * (time.process_time() - start)
    return _droplets(rows["x"], rows["y"], np.sqrt(2) * rows["size"], rows["mass"]), took


def plain(still: Still) -> Found:
    """The paper's steps with scikit-image, as a person would write them down."""
    start = time.process_time()
    x, y, r, match = plain_paper(
        still.frame,
        still.flat_field,
        is_dark=still.scenario.droplets is DropletTone.DARK,
        r_min_px=still.scenario.radius_min_um / still.scenario.pixel_size_um,
        r_max_px=still.scenario.radius_max_um / still.scenario.pixel_size_um,
    )
    return _droplets(x, y, r, match), 1e3 * (time.process_time() - start)


METHODS: dict[str, Callable[[Still], Found]] = {
    "default": lambda still: ours(still, "default"),
    "paper": lambda still: ours(still, "paper"),
    "trackpy": trackpy_located,
}


def table(found: Droplets, still: Still, frame: int = 0) -> pa.Table:
    """Droplets as scoring takes them."""
    return found.to_table(frame=frame, time_s=float(frame), pixel_size_um=still.scenario.pixel_size_um)


def _droplets(x: npt.ArrayLike, y: npt.ArrayLike, r: npt.ArrayLike, match: npt.ArrayLike) -> Droplets:
    columns = [np.asarray(column, np.float64) for column in (x, y, r)]
    columns[2] = np.maximum(columns[2], 0.1)
    unknown = np.full(len(columns[0]), np.nan)
    return Droplets(*columns, unknown, unknown, unknown, np.asarray(match, np.float64))
