"""How droplets of a frame are followed into the next: the real tracking, of a film of a few frames."""

import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import zarr

from dropflow import pipeline
from dropflow.detections import write_droplets
from dropflow.errors import FieldProblem, ParametersError
from dropflow.frames import Frame, Frames
from dropflow.parameters import Parameters
from dropflow.statistics.quality import flow_at
from worker.preview_films import Film

N_FRAMES = 4
"""Enough for the flow to be known, few enough to wait for."""


class Part(Frames):
    """Some frames of a film as a film of their own."""

    def __init__(self, frames: Frames, start: int, stop: int) -> None:
        self._frames, self._start, self._n = frames, start, stop - start
        self.shape, self.dtype = frames.shape, frames.dtype

    def __len__(self) -> int:
        return self._n

    def label(self, index: int) -> str:
        """As the whole film calls it."""
        return self._frames.label(self._start + index)

    def read(self, index: int) -> Frame:
        """One of its frames."""
        return self._frames.read(self._start + index)

    def close(self) -> None:
        """The film stays open for others."""


def followed(film: Film, frame: int, parameters: Parameters) -> dict[str, Any]:
    """Droplets of a frame, where they are predicted and where they are found next, as JSON."""
    began_s = time.monotonic()
    stop = min(frame + N_FRAMES, film.index.n_frames)
    n_frames = stop - frame
    if n_frames < 2:
        problem = FieldProblem("frame", "is the last one: there is none to follow droplets into")
        raise ParametersError("There is no next frame.", fields=[problem])
    # A film this short must not lose what is not followed to its end.
    tracking = parameters.tracking.model_copy(update={"shortest_trajectory_frames": 2})
    short = parameters.model_copy(update={"tracking": tracking})
    times_s = film.index.times_s[frame:stop]
    index = film.index.model_copy(update={"n_frames": n_frames, "times_s": times_s})
    with tempfile.TemporaryDirectory(prefix="preview-") as name:
        folder = Path(name)
        found = [film.detection(parameters, frame + step).droplets for step in range(n_frames)]
        pixel_size_um = film.experiment.pixel_size_um
        tables = [
            droplets.to_table(frame=step, time_s=times_s[step], pixel_size_um=pixel_size_um)
            for step, droplets in enumerate(found)
        ]
        write_droplets(folder / "droplets.parquet", iter(tables), metadata={})
        pipeline.track_film(
            Part(film.frames, frame, stop),
            index,
            film.experiment,
            short,
            film.measured(parameters),
            droplets=folder / "droplets.parquet",
            folder=folder,
        )
        rows = _first_step(folder, times_s[1] - times_s[0], film)
    return {"frame": frame, "n_frames": n_frames, "took_s": time.monotonic() - began_s, **rows}


def _first_step(folder: Path, step_s: float, film: Film) -> dict[str, Any]:
    rows = pl.read_parquet(folder / "trajectories.parquet")
    place = ["trajectory_id", "x_px", "y_px", "r_px"]
    after = rows.filter(pl.col("frame") == 1).select(place).rename({name: f"next_{name}" for name in place[1:]})
    here = rows.filter(pl.col("frame") == 0).join(after, on="trajectory_id", how="left").sort("trajectory_id")
    velocity = np.asarray(zarr.open_array(folder / "flow.zarr" / "velocity_um_s", mode="r")[:1])
    grid = [
        np.asarray(zarr.open_array(folder / "flow.zarr" / name, mode="r")[:]) for name in ("grid_x_px", "grid_y_px")
    ]
    x_px, y_px, sinking = (here[name].to_numpy() for name in ("x_px", "y_px", "sedimentation_um_s"))
    flow = flow_at(velocity, grid, np.zeros(here.height, np.int64), x_px, y_px)
    px_per_um_s = step_s / film.experiment.pixel_size_um
    up = film.experiment.up
    predicted = {
        "predicted_x_px": x_px + (flow[0] + sinking * up[0]) * px_per_um_s,
        "predicted_y_px": y_px + (flow[1] + sinking * up[1]) * px_per_um_s,
    }
    shown = here.select(*place[1:], "is_detected", *(f"next_{name}" for name in place[1:])).with_columns(**predicted)
    return shown.with_columns(pl.col(pl.Float64).fill_nan(None)).to_dict(as_series=False)
