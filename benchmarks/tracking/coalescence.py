"""Coalescences that tracking claims, against those that happened."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet as pq

from benchmarks.tracking.given import Given
from benchmarks.tracking.scores import DEFAULT
from dropflow.progress import silent
from dropflow.simulation.truth import Visibility
from dropflow.tracking.film import Film
from dropflow.tracking.track import track_film

_MOST_FRAMES_APART = 2
_LEAST_REACH_PX = 5.0
_LEAST_RATIO = 0.4
"""A partner below this part of the other's radius leaves no trace in the volume at 3 % error of the radius."""


@dataclass(frozen=True)
class Merger:
    """Where and when two droplets became one, in px and frames."""

    frame: int
    x_px: float
    y_px: float
    r_px: float
    ratio: float
    """Of the radii of the partners, the smaller over the larger."""

    def is_near(self, other: "Merger") -> bool:
        """Whether both are one and the same."""
        reach_px = max(_LEAST_REACH_PX, self.r_px)
        is_here = np.hypot(self.x_px - other.x_px, self.y_px - other.y_px) < reach_px
        return bool(is_here) and abs(self.frame - other.frame) <= _MOST_FRAMES_APART


def print_row(given: Given, name: str, folder: Path) -> None:
    """Claimed and right, seen and found; of unlike and of like partners."""
    film = Film(given.times_s, lambda frame: given.droplets[frame], None, None)
    result = track_film(film, given.shape, given.experiment, DEFAULT, folder, {}, silent)
    happened, visible = _true_mergers(given)
    claimed = _claimed(result.events)
    n_right = sum(any(one.is_near(true) for true in happened) for one in claimed)
    like = [true for true in visible if true.ratio >= _LEAST_RATIO]
    n_found, n_like = (sum(any(true.is_near(one) for one in claimed) for true in some) for some in (visible, like))
    print(
        f"{name:<22} claimed {len(claimed):>4}, right {n_right:>4};   seen {len(visible):>4}, found {n_found:>4};   "
        f"partners above {_LEAST_RATIO} of the other {len(like):>4}, found {n_like:>4}",
        flush=True,
    )


def _claimed(events: Path) -> list[Merger]:
    rows = pq.read_table(events, filters=pc.field("kind") == "coalescence").to_pylist()
    return [Merger(row["frame"], row["x_px"], row["y_px"], row["r_px"], row["r_2_um"] / row["r_1_um"]) for row in rows]


def _true_mergers(given: Given) -> tuple[list[Merger], list[Merger]]:
    """All whose product is in view, and those of them whose three droplets are visible."""
    truth = given.truth.to_pandas().set_index(["droplet_id", "frame"])
    with (given.film / "events.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["kind"] == "coalescence"]
    happened, visible = [], []
    for row in rows:
        frame = int(row["frame"])
        keys = [(int(row["product_id"]), frame), *((int(row[name]), frame - 1) for name in ("droplet_id", "other_id"))]
        if keys[0] not in truth.index:
            continue
        product = truth.loc[keys[0]]
        parents = [truth.loc[key] for key in keys[1:] if key in truth.index]
        sizes = sorted(float(parent["r_px"]) for parent in parents)
        ratio = sizes[0] / sizes[1] if len(sizes) == 2 else 0.0
        merger = Merger(frame, product["x_px"], product["y_px"], product["r_px"], ratio)
        happened.append(merger)
        is_visible = all(one["visibility"] == str(Visibility.VISIBLE) for one in (product, *parents))
        if len(parents) == 2 and is_visible:
            visible.append(merger)
    return happened, visible
