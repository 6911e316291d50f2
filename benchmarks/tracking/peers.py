"""The peers: trackpy with its predictor, and laptrack. Each is given the search range with which it does best."""

import warnings
from collections.abc import Callable, Iterator

import laptrack
import numpy as np
import pandas as pd
import pyarrow as pa
import trackpy

from benchmarks.tracking.given import Given
from benchmarks.tracking.limited import within

SEARCH_RANGES = (0.25, 0.5, 0.75, 1.0, 1.5)
"""In mean spacings of droplets; all are tried, and the best by the truth is reported."""
LIMIT_S = 30
"""A search range with which a peer takes longer is left out."""
_SHORTEST_FRAMES = 3

Linker = Callable[[pd.DataFrame, float], pd.Series]


def points(given: Given) -> pd.DataFrame:
    """Columns frame, x, y and the radius."""
    table = given.table()
    return pd.DataFrame({"frame": table["frame"], "x": table["x_px"], "y": table["y_px"], "r_px": table["r_px"]})


def trackpy_velocity(droplets: pd.DataFrame, range_px: float) -> pd.Series:
    """Trackpy with `NearestVelocityPredict`, its best predictor, and the adaptive search advised for dense data."""
    predictor = trackpy.predict.NearestVelocityPredict()
    linked = predictor.link_df(droplets.copy(), range_px, adaptive_stop=range_px / 20, adaptive_step=0.8)
    return linked["particle"].reindex(droplets.index)


def trackpy_plain(droplets: pd.DataFrame, range_px: float) -> pd.Series:
    """`trackpy.link` as it comes."""
    return trackpy.link(droplets.copy(), range_px)["particle"].reindex(droplets.index)


def laptrack_nearest(droplets: pd.DataFrame, range_px: float) -> pd.Series:
    """laptrack: one assignment a frame over squared distances, gaps closed as by default."""
    tracker = laptrack.LapTrack(cutoff=range_px**2, gap_closing_cutoff=range_px**2)
    tracks, _, _ = tracker.predict_dataframe(
        droplets.copy(), coordinate_cols=["x", "y"], frame_col="frame", only_coordinate_cols=False, index_offset=0
    )
    tracks = tracks.reset_index(drop=True)
    keys = ["frame_y" if "frame_y" in tracks else "frame", "x", "y"]
    tracks = tracks.rename(columns={keys[0]: "frame"})
    merged = droplets.reset_index().merge(tracks[["frame", "x", "y", "track_id"]], on=["frame", "x", "y"], how="left")
    return merged.drop_duplicates("index").set_index("index")["track_id"]


def tables_of(given: Given, link: Linker) -> Iterator[tuple[float, pa.Table]]:
    """Trajectories of at least three frames for each search range, in spacings; ranges it cannot do are left out."""
    trackpy.quiet()
    droplets = points(given)
    for share in SEARCH_RANGES:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                ids = within(LIMIT_S, link, droplets, share * given.spacing_px)
            except trackpy.linking.utils.SubnetOversizeException:
                continue
        if ids is None:
            continue
        yield share, trajectories(given, ids.to_numpy())


def trajectories(given: Given, ids: np.ndarray) -> pa.Table:
    """Rows in trajectories of at least three frames."""
    known = ~pd.isna(ids)
    ids = np.where(known, ids, -1).astype(np.int64)
    counts = np.bincount(ids[known], minlength=1)
    is_kept = known & (counts[ids] >= _SHORTEST_FRAMES)
    table = given.table().append_column("trajectory_id", pa.array(ids))
    return table.filter(pa.array(is_kept))
