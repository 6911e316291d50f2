"""Quality of a run over a range of time and radius, at the resolution that is looked at."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl
import pyarrow.parquet as pq

from backend.models import Product
from backend.platform.object_store import QUALITY_BY_RADIUS_FILE, QUALITY_FILE, ObjectStore
from backend.platform.packing import unpack
from backend.quality.schemas import Column, Quality, QualityQuery
from backend.results.errors import NotYet
from backend.results.service import Asker
from dropflow.statistics.condensed_files import SUMMARY_FILE
from dropflow.statistics.quality import FrameQuality, QualityByRadius
from dropflow.statistics.scope import Scope

REJECTED_FILE = "rejected_trajectories.parquet"


@dataclass(frozen=True)
class _Columns:
    """Sums over neighbouring frames, one array a quantity."""

    first_frame: npt.NDArray[np.int64]
    n_frames: npt.NDArray[np.int64]
    sums: FrameQuality
    is_of_radii: bool
    """Whether they are of the radii that were asked for."""


def over(asker: Asker, store: ObjectStore, query: QualityQuery) -> Quality:
    """Means over the frames in a range of time, of droplets in a range of radius; at most `max_columns` of them."""
    scope = Scope(query.from_s, query.to_s, query.radius_min_um, query.radius_max_um)
    columns = _columns(store, asker.product("track"), scope)
    found, is_of_radii = columns.sums, columns.is_of_radii
    trajectories = _trajectories(asker, store, scope)
    inside = np.flatnonzero(scope.times(found.time_s))
    if not inside.size:
        empty: dict[str, Column] = {name: [] for name in Quality.model_fields if name not in _NO_COLUMNS}
        return Quality(is_of_radii=is_of_radii, trajectories=trajectories, **empty)
    starts = inside[:: -(-inside.size // query.max_columns)]

    def total(values: npt.NDArray[np.generic]) -> npt.NDArray[np.float64]:
        ends = np.append(starts[1:], inside[-1] + 1)
        sums = np.concatenate([[0.0], np.cumsum(values, dtype=np.float64)])
        return np.asarray(sums[ends] - sums[starts])

    n_frames = total(columns.n_frames)
    n_tracked, n_predicted = total(found.n_tracked), total(found.n_predicted)
    return Quality(
        is_of_radii=is_of_radii,
        trajectories=trajectories,
        first_frame=columns.first_frame[starts].tolist(),
        time_s=(total(found.time_s * columns.n_frames) / n_frames).tolist(),
        n_detected=_shares(total(found.n_detected), n_frames),
        n_tracked=_shares(n_tracked, n_frames),
        predicted_share=_shares(n_predicted, n_tracked),
        match=_shares(total(found.match_sum), n_tracked - n_predicted),
        radius_std_share=_shares(total(found.radius_std_sum), total(found.n_radius_std)),
        residual_px=_shares(total(found.residual_squared_sum_px), total(found.n_residuals), power=0.5),
    )


_NO_COLUMNS = ("is_of_radii", "trajectories")


def _columns(store: ObjectStore, tracked: Product, scope: Scope) -> _Columns:
    """By radius where radii are limited and the run counted so; else frame by frame over all radii."""
    if scope.has_radii:
        try:
            by_radius = unpack(QualityByRadius, store.read(tracked.prefix + QUALITY_BY_RADIUS_FILE))
        except FileNotFoundError:  # made by a version that counted over all radii only
            pass
        else:
            return _Columns(by_radius.first_frame, by_radius.n_frames, by_radius.within(scope), is_of_radii=True)
    try:
        found = unpack(FrameQuality, store.read(tracked.prefix + QUALITY_FILE))
    except FileNotFoundError:  # made by a version that did not count it
        raise NotYet from None
    frames = np.arange(len(found.time_s))
    return _Columns(frames, np.ones_like(frames), found, is_of_radii=not scope.has_radii)


def _trajectories(asker: Asker, store: ObjectStore, scope: Scope) -> dict[str, int] | None:
    """How many were kept and how many taken out by reason, whose middle in time and mean radius lie inside.

    None where nothing is limited, for then the summary of the run says it, and where the tables do not say it.
    """
    if scope == Scope() or "analyse" not in asker.done:
        return None
    pixel_um = asker.facts.experiment.pixel_size_um
    tracked, analysed = asker.product("track"), asker.product("analyse")
    try:
        with store.open(analysed.prefix + SUMMARY_FILE) as file:
            kept = pl.read_parquet(file, columns=["start_s", "end_s", "r_mean_um"])
        with store.open(tracked.prefix + REJECTED_FILE) as file:
            rejected = pl.DataFrame(pq.read_table(file, columns=["reason", "first_frame", "last_frame", "r_px"]))
        time_s = unpack(FrameQuality, store.read(tracked.prefix + QUALITY_FILE)).time_s
    except FileNotFoundError:
        return None
    times = pl.Series(time_s)
    timed = rejected.with_columns(
        start_s=times.gather(rejected["first_frame"]),
        end_s=times.gather(rejected["last_frame"]),
        r_mean_um=pl.col("r_px") * pixel_um,
    )
    reasons = scope.trajectories(timed).group_by("reason").len().sort("reason")
    taken_out = {reason: n for reason, n in reasons.iter_rows() if reason}
    every = dict.fromkeys((asker.run.summary or {}).get("n_rejected_trajectories", {}), 0)
    return {"kept": scope.trajectories(kept).height} | every | taken_out


def _shares(part: npt.NDArray[np.float64], whole: npt.NDArray[np.float64], *, power: float = 1.0) -> Column:
    return [
        float((above / below) ** power) if below > 0 and above >= 0 else None
        for above, below in zip(part, whole, strict=True)
    ]
