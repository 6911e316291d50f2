"""Tracks a generated film without images, and says how well its links are the true ones."""

import itertools
import os
import signal
import sys
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from dropflow.parameters import parse_parameters
from dropflow.progress import Progress, silent
from dropflow.tracking.film import Film as TrackedFilm
from dropflow.tracking.track import TrackingResult, track_film
from tests.dropflow.tracking.generated import Film, film, true_links, vortices


def tracked(
    given: Film,
    folder: Path,
    method: str = "default",
    *,
    progress: Progress = silent,
    shortest_trajectory_frames: int = 3,
    flow: dict[str, int | str] | None = None,
    **about: Any,
) -> TrackingResult:
    """Track a generated film."""
    tracking = {"method": method, "shortest_trajectory_frames": shortest_trajectory_frames}
    parameters = parse_parameters({"tracking": tracking, "flow": flow or {}})
    without_images = TrackedFilm(given.times_s, given, None, None)
    return track_film(without_images, given.shape, given.experiment, parameters, folder, about, progress)


def link_scores(given: Film, trajectories: pa.Table) -> tuple[float, float]:
    """Precision and recall of the links between detections in a table of trajectories."""
    index = [
        {place: k for k, place in enumerate(zip(seen.x_px.tolist(), seen.y_px.tolist(), strict=True))}
        for seen in given.frames
    ]
    names = ("trajectory_id", "frame", "x_px", "y_px", "is_detected")
    rows = list(zip(*(trajectories[name].to_pylist() for name in names), strict=True))
    found = {
        (frame, index[frame][x, y], index[frame + 1][next_x, next_y])
        for (key, frame, x, y, is_here), (next_key, next_frame, next_x, next_y, is_there) in itertools.pairwise(rows)
        if key == next_key and next_frame == frame + 1 and is_here and is_there
    }
    true = true_links(given)
    return len(found & true) / max(len(found), 1), len(found & true) / len(true)


def read(result: TrackingResult) -> pa.Table:
    """The table of trajectories."""
    return pq.read_table(result.trajectories)


def long_film() -> Film:
    """Long enough for several checkpoints in every pass."""
    return film(flow=vortices(8, 250), n_frames=110, n_droplets=40, found_share=0.95, n_false=5, seed=5)


def main(folder: Path, method: str, dies_at: int | None) -> None:
    """Track the long film, saying where it starts and ends; this process kills itself where it is told to."""
    counts: list[int] = []

    def note(stage: str, done: int, total: int) -> None:
        counts.append(done)
        if dies_at is not None and done >= dies_at:
            sys.stdout.write(f"{counts[0]}\n")
            sys.stdout.flush()
            os.kill(os.getpid(), signal.SIGKILL)

    tracked(long_film(), folder, method, progress=note)
    sys.stdout.write(f"{counts[0]} {counts[-1]}\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]) if len(sys.argv) > 3 else None)
