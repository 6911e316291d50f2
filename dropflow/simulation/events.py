"""What happened to droplets, as ``events.csv``: births, coalescences and exits, as far as the truth shows them."""

import csv
from enum import StrEnum
from typing import IO, Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from dropflow.simulation.cloud import Cloud, Coalescence, Origin
from dropflow.simulation.film import Moment
from dropflow.simulation.scenario import Scenario
from dropflow.simulation.truth import inside_fraction

COLUMNS = (
    *("frame", "time_s", "kind", "cause", "droplet_id", "other_id", "product_id"),
    *("x_px", "y_px", "z_um", "r_px", "r_um"),
)
"""`frame` is the first in which the event can be seen: a born droplet is there, those that coalesced or left are not.

`kind` is birth, coalescence or exit; `cause` is nucleation, border, focus or coalescence. In a coalescence
`droplet_id` and `other_id` became `product_id`, and place and radius are those of the product; else they are those of
`droplet_id` in the frame where it was seen first or last.
"""


class Kind(StrEnum):
    """What happened."""

    BIRTH = "birth"
    COALESCENCE = "coalescence"
    EXIT = "exit"


class EventLog:
    """Writes events as the film goes on. The droplets of the first frame are no births."""

    def __init__(self, file: IO[str], scenario: Scenario) -> None:
        self._rows = csv.writer(file, lineterminator="\n")
        self._rows.writerow(COLUMNS)
        self._scenario = scenario
        self._before: tuple[Cloud, pa.Table] | None = None

    def add(self, moment: Moment, truth: pa.Table) -> None:
        """Compare a frame with the one before."""
        if self._before is not None:
            cloud, before = self._before
            merged = {parent for event in moment.coalescences for parent in event.parents}
            made = {event.product for event in moment.coalescences}
            self._births(moment, [row for row in _only_in(truth, before) if row["droplet_id"] not in made], cloud)
            shown = {*before["droplet_id"].to_pylist(), *truth["droplet_id"].to_pylist()}
            for event in moment.coalescences:
                if shown & {event.product, *event.parents}:
                    self._coalescence(moment, event)
            self._exits(moment, [row for row in _only_in(before, truth) if row["droplet_id"] not in merged])
        self._before = moment.cloud, truth

    def _births(self, moment: Moment, born: list[dict[str, Any]], before: Cloud) -> None:
        for row in born:
            was = np.flatnonzero(before.droplet_id == row["droplet_id"])
            if len(was):
                cause = "focus" if self._is_in_frame(before.x_um[was], before.y_um[was], before.r_um[was]) else "border"
            else:
                now = np.flatnonzero(moment.cloud.droplet_id == row["droplet_id"])[0]
                cause = Origin(moment.cloud.origin[now]).name.lower()
            self._write(moment, Kind.BIRTH, cause, row)

    def _exits(self, moment: Moment, gone: list[dict[str, Any]]) -> None:
        interval_s = self._scenario.frame_interval_s
        for row in gone:
            x_um = np.array([row["x_um"] + row["u_um_s"] * interval_s])
            y_um = np.array([row["y_um"] + row["v_um_s"] * interval_s])
            cause = "focus" if self._is_in_frame(x_um, y_um, np.array([row["r_um"]])) else "border"
            self._write(moment, Kind.EXIT, cause, row)

    def _is_in_frame(self, x_um: Any, y_um: Any, r_um: Any) -> bool:
        pixel, scenario = self._scenario.pixel_size_um, self._scenario
        share = inside_fraction(x_um / pixel, y_um / pixel, r_um / pixel, scenario.height_px, scenario.width_px)
        return bool(share[0] > 0)

    def _write(self, moment: Moment, kind: Kind, cause: str, row: dict[str, Any]) -> None:
        place = [f"{row[name]:.6g}" for name in ("x_px", "y_px", "z_um", "r_px", "r_um")]
        self._rows.writerow([moment.frame, f"{moment.time_s:.9g}", kind, cause, row["droplet_id"], "", "", *place])

    def _coalescence(self, moment: Moment, event: Coalescence) -> None:
        pixel = self._scenario.pixel_size_um
        lengths = (event.x_um / pixel, event.y_um / pixel, event.z_um, event.r_um / pixel, event.r_um)
        who = (*event.parents, event.product)
        what = (Kind.COALESCENCE, "coalescence", *who)
        self._rows.writerow([moment.frame, f"{event.time_s:.9g}", *what, *(f"{length:.6g}" for length in lengths)])


def _only_in(one: pa.Table, other: pa.Table) -> list[dict[str, Any]]:
    """Rows of `one` whose droplets have no row in `other`."""
    is_known = pc.is_in(one["droplet_id"], value_set=other["droplet_id"])
    return list(one.filter(pc.invert(is_known)).to_pylist())
