"""Trajectories as the XML that TrackMate reads (its simple interchange form with spots and tracks)."""

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import TextIO
from xml.sax.saxutils import quoteattr

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.dataset as ds
import pyarrow.parquet as pq

from dropflow.exports.tables import trajectory_rows
from dropflow.results import Results

_SPOT_FEATURES = (
    ("QUALITY", "Quality", "Quality", "QUALITY", "false"),
    ("POSITION_X", "X", "X", "POSITION", "false"),
    ("POSITION_Y", "Y", "Y", "POSITION", "false"),
    ("POSITION_Z", "Z", "Z", "POSITION", "false"),
    ("POSITION_T", "T", "T", "TIME", "false"),
    ("FRAME", "Frame", "Frame", "NONE", "true"),
    ("RADIUS", "Radius", "R", "LENGTH", "false"),
    ("VISIBILITY", "Visibility", "Visibility", "NONE", "true"),
)
_EDGE_FEATURES = (
    ("SPOT_SOURCE_ID", "Source spot ID", "Source ID", "NONE", "true"),
    ("SPOT_TARGET_ID", "Target spot ID", "Target ID", "NONE", "true"),
)
_TRACK_FEATURES = (
    ("TRACK_INDEX", "Track index", "Index", "NONE", "true"),
    ("TRACK_ID", "Track ID", "ID", "NONE", "true"),
)
_FRAMES_AT_ONCE = 1000


def write_trackmate(results: Results, output: Path) -> None:
    """Spots (um, s) by frame, and each trajectory as a track of edges. Spot ids are row numbers of the table.

    The table is sorted by trajectory and TrackMate wants spots by frame: some frames at a time are gathered from it.
    """
    with output.open("w", encoding="utf-8") as file:
        interval_s = float(np.median(np.diff(results.times_s))) if results.n_frames > 1 else 1.0
        file.write('<?xml version="1.0" encoding="UTF-8"?>\n<TrackMate version="7.11.1">\n')
        file.write(f"<Log>{_escaped(json.dumps(results.provenance))}</Log>\n")
        file.write('<Model spatialunits="µm" timeunits="s">\n<FeatureDeclarations>\n')
        for kind, features in (
            ("SpotFeatures", _SPOT_FEATURES),
            ("EdgeFeatures", _EDGE_FEATURES),
            ("TrackFeatures", _TRACK_FEATURES),
        ):
            file.write(f"<{kind}>\n")
            file.writelines(_declared(*feature) for feature in features)
            file.write(f"</{kind}>\n")
        file.write("</FeatureDeclarations>\n")
        _write_spots(results, file)
        _write_tracks(results, file)
        file.write("</Model>\n<Settings>\n")
        width_um, height_um = results.field_um
        pixel_um = results.experiment.pixel_size_um
        file.write(
            f'<ImageData filename="" folder="" width="{round(width_um / pixel_um)}" '
            f'height="{round(height_um / pixel_um)}" nslices="1" nframes="{results.n_frames}" pixelwidth="{pixel_um}" '
            f'pixelheight="{pixel_um}" voxeldepth="1.0" timeinterval="{interval_s}"/>\n'
        )
        file.write("</Settings>\n</TrackMate>\n")


def _declared(feature: str, name: str, short: str, dimension: str, is_int: str) -> str:
    return (
        f'<Feature feature="{feature}" name="{name}" shortname="{short}" dimension="{dimension}" isint="{is_int}"/>\n'
    )


def _write_spots(results: Results, file: TextIO) -> None:
    table = ds.dataset(results.trajectories, format="parquet")
    file.write(f'<AllSpots nspots="{table.count_rows()}">\n')
    for start in range(0, results.n_frames, _FRAMES_AT_ONCE):
        for frame, rows in _spots_of(table, start, start + _FRAMES_AT_ONCE):
            file.write(f'<SpotsInFrame frame="{frame}">\n')
            for spot, t, x, y, r, quality in rows:
                file.write(
                    f'<Spot ID="{spot}" name="ID{spot}" VISIBILITY="1" RADIUS="{r:.6g}" QUALITY="{quality:.6g}" '
                    f'POSITION_T="{t:.9g}" POSITION_X="{x:.9g}" POSITION_Y="{y:.9g}" FRAME="{frame}" '
                    f'POSITION_Z="0.0"/>\n'
                )
            file.write("</SpotsInFrame>\n")
    file.write("</AllSpots>\n")


def _spots_of(table: ds.Dataset, start: int, stop: int) -> Iterator[tuple[int, list[tuple[float, ...]]]]:
    """Rows of some frames with their place in the table, by frame."""
    found = []
    first_row = 0
    for batch in table.to_batches(columns=["frame", "time_s", "x_um", "y_um", "r_um", "match"]):
        rows = pa.Table.from_batches([batch]).append_column("spot", pa.array(np.arange(len(batch)) + first_row))
        first_row += len(batch)
        is_inside = pc.and_(pc.greater_equal(rows["frame"], start), pc.less(rows["frame"], stop))
        found.append(rows.filter(is_inside))
    rows = pa.concat_tables(found).sort_by([("frame", "ascending"), ("spot", "ascending")]) if found else None
    if rows is None or not len(rows):
        return
    frames = rows["frame"].to_numpy()
    values = zip(*(rows[name].to_pylist() for name in ("spot", "time_s", "x_um", "y_um", "r_um", "match")), strict=True)
    every = list(values)
    edges = np.flatnonzero(np.diff(frames, prepend=frames[0] - 1, append=frames[-1] + 1))
    for first, last in pairwise(edges.tolist()):
        yield int(frames[first]), every[first:last]


def _write_tracks(results: Results, file: TextIO) -> None:
    ids: list[int] = []
    file.write("<AllTracks>\n")
    last_id, spot = None, 0
    with pq.ParquetFile(results.trajectories) as table:
        for rows in trajectory_rows(table):
            for track in rows["trajectory_id"].to_pylist():
                if track != last_id:
                    if last_id is not None:
                        file.write("</Track>\n")
                    file.write(f'<Track name="Track_{track}" TRACK_ID="{track}" TRACK_INDEX="{len(ids)}">\n')
                    ids.append(track)
                else:
                    file.write(f'<Edge SPOT_SOURCE_ID="{spot - 1}" SPOT_TARGET_ID="{spot}"/>\n')
                last_id = track
                spot += 1
    file.write("</Track>\n</AllTracks>\n" if ids else "</AllTracks>\n")
    file.write("<FilteredTracks>\n")
    file.writelines(f'<TrackID TRACK_ID="{track}"/>\n' for track in ids)
    file.write("</FilteredTracks>\n")


def _escaped(text: str) -> str:
    return quoteattr(text)[1:-1]
