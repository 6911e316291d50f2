"""Figures of single frames of a film, from its tables and its flow field (Figs. 6 to 8)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go
import polars as pl
import zarr

from dropflow.figures.flow_field import flow_field
from dropflow.figures.following import Direction, displacement, tracking_step
from dropflow.figures.layout import caption_of, new_figure, say_empty
from dropflow.statistics.facts import FilmFacts

Floats = npt.NDArray[np.float64]

COLUMNS = ["trajectory_id", "frame", "time_s", "x_px", "y_px", "r_px", "sedimentation_um_s"]
"""What is needed of ``trajectories.parquet``."""


@dataclass(frozen=True)
class FlowStep:
    """The flow between a frame and the next."""

    frame: int
    velocity_um_s: Floats
    """Shape (2, n_rows, n_columns)."""
    is_interpolated: npt.NDArray[np.bool_]
    grid_x_px: Floats
    grid_y_px: Floats

    @staticmethod
    def read(flow: zarr.Group, frame: int) -> "FlowStep":
        """From ``flow.zarr``; a frame that no step begins with has no flow anywhere."""
        arrays = {name: flow[name] for name in ("velocity_um_s", "is_interpolated", "grid_x_px", "grid_y_px")}
        x, y = (np.asarray(_array(arrays[f"grid_{axis}_px"])[:], np.float64) for axis in "xy")
        velocity, interpolated = _array(arrays["velocity_um_s"]), _array(arrays["is_interpolated"])
        if not 0 <= frame < velocity.shape[0]:
            return FlowStep(frame, np.full((2, len(y), len(x)), np.nan), np.ones((len(y), len(x)), bool), x, y)
        return FlowStep(frame, np.asarray(velocity[frame], np.float64), np.asarray(interpolated[frame]), x, y)

    def at(self, x_px: float, y_px: float) -> tuple[float, float]:
        """Flow in the cell that holds a place, along x and y; zero where it is not known."""
        column, row = (
            int(np.argmin(np.abs(axis - at))) for axis, at in ((self.grid_x_px, x_px), (self.grid_y_px, y_px))
        )
        u, v = np.nan_to_num(self.velocity_um_s[:, row, column])
        return float(u), float(v)


def _array(found: Any) -> zarr.Array[Any]:
    assert isinstance(found, zarr.Array)  # noqa: S101 - the store was written by us
    return found


def flow_field_of(
    facts: FilmFacts, step: FlowStep, rows: pl.DataFrame, *, title: str, image: npt.NDArray[Any] | None = None
) -> go.Figure:
    """Flow over a frame with its droplets; `rows` are of ``trajectories.parquet``, of this frame at least."""
    here = rows.filter(pl.col("frame") == step.frame)
    return flow_field(
        *_flow(step),
        pixel_size_um=facts.experiment.pixel_size_um,
        frame=step.frame,
        droplets_px=_places(here),
        image=image,
        title=f"{title}, frame {step.frame}",
        caption=caption_of(facts.caption()),
    )


def displacement_of(
    facts: FilmFacts, step: FlowStep, rows: pl.DataFrame, *, title: str, image: npt.NDArray[Any] | None = None
) -> go.Figure:
    """Droplets of a frame and where they are in the next; `rows` are of both frames at least."""
    here, later = (rows.filter(pl.col("frame") == step.frame + more).sort("trajectory_id") for more in (0, 1))
    later = later.filter(pl.col("trajectory_id").is_in(here["trajectory_id"].implode()))
    return displacement(
        *_flow(step),
        here_px=_places(here),
        next_px=_places(later),
        pixel_size_um=facts.experiment.pixel_size_um,
        frame=step.frame,
        image=image,
        title=f"{title}, {step.frame} and {step.frame + 1}",
        caption=caption_of(facts.caption()),
    )


def tracking_step_of(
    facts: FilmFacts,
    step: FlowStep,
    rows: pl.DataFrame,
    frame: int,
    *,
    direction: Direction,
    title: str,
    image: npt.NDArray[Any] | None = None,
) -> go.Figure:
    """One step of a trajectory from `frame`, forward or backward; `rows` are all of it, `step` the flow on the way."""
    caption = caption_of(facts.caption())
    rows = rows.sort("frame")
    number = int(rows["frame"].search_sorted(frame)) if len(rows) else 0
    if number >= len(rows) or rows["frame"][number] != frame:
        return say_empty(new_figure(title, caption), f"the trajectory has no frame {frame}")
    other = number + (1 if direction is Direction.FORWARD else -1)
    is_inside = 0 <= other < len(rows)
    interval_s = abs(rows["time_s"][other] - rows["time_s"][number]) if is_inside else 1.0
    along = float(rows["sedimentation_um_s"][number])
    up = facts.experiment.up
    return tracking_step(
        _places(rows),
        number,
        velocity_um_s=step.at(rows["x_px"][number], rows["y_px"][number]),
        sedimentation_um_s=(up[0] * along, up[1] * along),
        interval_s=interval_s,
        pixel_size_um=facts.experiment.pixel_size_um,
        direction=direction,
        image=image,
        title=f"{title}: trajectory {rows['trajectory_id'][0]} from frame {frame}",
        caption=caption,
    )


def _flow(step: FlowStep) -> tuple[Floats, npt.NDArray[np.bool_], Floats, Floats]:
    return step.velocity_um_s, step.is_interpolated, step.grid_x_px, step.grid_y_px


def _places(rows: pl.DataFrame) -> tuple[Floats, Floats, Floats]:
    x, y, r = (rows[name].to_numpy() for name in ("x_px", "y_px", "r_px"))
    return x, y, r
