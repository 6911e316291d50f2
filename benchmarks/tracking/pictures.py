"""Pictures of tracking to look at: `python -m benchmarks.tracking.pictures FRAMES RESULTS OUT [--every 10]`.

FRAMES is what was analysed, RESULTS the folder of trajectories and flow. Green circles were detected, red ones
found where they were predicted; lines are the paths of the last frames, yellow arrows the flow, blue crosses
coalescences.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet as pq
import zarr

from dropflow.droplets import Droplets
from dropflow.experiment import Experiment, parse_experiment
from dropflow.figures.overlay import Picture, draw_overlay
from dropflow.frames import Choice, open_frames

GREEN, RED, YELLOW, BLUE, WHITE = (60, 230, 60), (240, 50, 50), (255, 220, 0), (80, 160, 255), (255, 255, 255)
N_TAIL = 8
_FRAMES_PER_S = 5.0
_FRAMES_AN_ARROW = 1.0
"""An arrow is as long as the way that the flow goes in so many frames."""


def draw(picture: Picture, results: Path, frame: int) -> None:
    """Draw what tracking found on a picture of the frame."""
    rows = pq.read_table(results / "trajectories.parquet", filters=pc.field("frame") <= frame)
    rows = rows.filter(pc.field("frame") > frame - N_TAIL)
    ids, frames = rows["trajectory_id"].to_numpy(), rows["frame"].to_numpy()
    x, y, r = (rows[name].to_numpy() for name in ("x_px", "y_px", "r_px"))
    for one in np.flatnonzero((ids[1:] == ids[:-1]) & np.isin(ids[1:], ids[frames == frame])):
        cv2.line(picture, _at(x[one], y[one]), _at(x[one + 1], y[one + 1]), WHITE, 1, cv2.LINE_AA)
    for one in np.flatnonzero(frames == frame):
        colour = GREEN if rows["is_detected"][int(one)].as_py() else RED
        cv2.circle(picture, _at(x[one], y[one]), round(float(r[one])), colour, 1, cv2.LINE_AA)
    _draw_flow(picture, results, frame)
    events = pq.read_table(results / "events.parquet", filters=pc.field("kind") == "coalescence")
    for event in events.to_pylist():
        if frame - N_TAIL < event["frame"] <= frame:
            cv2.drawMarker(picture, _at(event["x_px"], event["y_px"]), BLUE, cv2.MARKER_CROSS, 24, 2, cv2.LINE_AA)


def _draw_flow(picture: Picture, results: Path, frame: int) -> None:
    store = zarr.open_group(results / "flow.zarr", mode="r")
    steps = store["velocity_um_s"]
    if frame >= steps.shape[0]:
        return
    times_s = store["time_s"][:2]
    px = _FRAMES_AN_ARROW * (times_s[1] - times_s[0]) / _experiment(results).pixel_size_um
    for row, y in enumerate(store["grid_y_px"][:]):
        for column, x in enumerate(store["grid_x_px"][:]):
            u, v = steps[frame, :, row, column] * px
            if np.isfinite(u):
                cv2.arrowedLine(picture, _at(x, y), _at(x + u, y + v), YELLOW, 1, cv2.LINE_AA, tipLength=0.25)


def _experiment(results: Path) -> Experiment:
    return parse_experiment(zarr.open_group(results / "flow.zarr", mode="r").attrs["experiment"])


def _at(x: float, y: float) -> tuple[int, int]:
    return round(float(x)), round(float(y))


def draw_film(frames_path: Path, results: Path, out: Path, *, every: int) -> None:
    """All frames as a film beside the folder `out`, and every so many in it."""
    out.mkdir(parents=True, exist_ok=True)
    with open_frames(frames_path, Choice.of(_experiment(results))) as frames:
        n_rows, n_columns = frames.shape
        codec = cv2.VideoWriter.fourcc(*"mp4v")
        film = cv2.VideoWriter(str(out.with_suffix(".mp4")), codec, _FRAMES_PER_S, (n_columns, n_rows))
        for frame in range(len(frames)):
            picture = np.ascontiguousarray(draw_overlay(frames[frame], Droplets.empty()))
            draw(picture, results, frame)
            film.write(picture[..., ::-1])
            if frame % every == 0:
                cv2.imwrite(str(out / f"frame_{frame:05d}.png"), picture[..., ::-1])
        film.release()


def main() -> None:
    """The film, and one PNG for every so many frames."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frames", type=Path)
    parser.add_argument("results", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--every", type=int, default=10)
    given = parser.parse_args()
    draw_film(given.frames, given.results, given.out, every=given.every)


if __name__ == "__main__":
    main()
