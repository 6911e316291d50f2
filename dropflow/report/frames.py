"""The figures of single frames in a report: of the frame in the middle of the film."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go
import polars as pl
import zarr

from dropflow.figures import Direction, caption_of
from dropflow.figures.entry import Entry
from dropflow.figures.example import WORKING_PANELS, Example, draw_example
from dropflow.figures.of_frame import COLUMNS, FlowStep, displacement_of, flow_field_of, tracking_step_of
from dropflow.statistics.findings import Findings

DIRECTIONS = {"forward_tracking": Direction.FORWARD, "backward_tracking": Direction.BACKWARD}


@dataclass(frozen=True)
class FrameSource:
    """Where single frames come from."""

    trajectories: Path
    """``trajectories.parquet``."""
    flow: Path
    """``flow.zarr``."""
    example: Example | None
    """The frame that the analysis kept; older results have none."""


def draw_of_frame(entry: Entry, found: Findings, source: FrameSource) -> go.Figure | None:
    """Draw a figure of one frame; None for a working panel where no frame was kept."""
    example = source.example
    if entry.name in WORKING_PANELS:
        if example is None:
            return None
        caption = caption_of(found.facts.caption())
        return draw_example(entry.name, example, parameters=found.facts.parameters, title=entry.title, caption=caption)
    frame = found.facts.n_frames // 2 if example is None else example.frame
    image = None if example is None else example.whole()
    table = pl.scan_parquet(source.trajectories)
    flow = zarr.open_group(source.flow, mode="r")
    if entry.name in DIRECTIONS:
        return _tracking(entry, found, flow, frame, table, image)
    step = FlowStep.read(flow, frame)
    rows = table.filter(pl.col("frame").is_between(frame, frame + 1)).select(COLUMNS).collect()
    drawn = displacement_of if entry.name == "displacement" else flow_field_of
    return drawn(found.facts, step, rows, title=entry.title, image=image)


def _tracking(
    entry: Entry,
    found: Findings,
    flow: zarr.Group,
    frame: int,
    table: pl.LazyFrame,
    image: npt.NDArray[np.float32] | None,
) -> go.Figure:
    """Of the longest trajectory through the frame and both its neighbours."""
    through = found.condensed.trajectories.filter(
        (pl.col("first_frame") < frame) & (pl.col("last_frame") > frame)
    ).sort("n_frames", "trajectory_id", descending=[True, False])
    number = through["trajectory_id"][0] if len(through) else -1
    rows = table.filter(pl.col("trajectory_id") == number).select(COLUMNS).collect()
    direction = DIRECTIONS[entry.name]
    step = FlowStep.read(flow, frame if direction is Direction.FORWARD else frame - 1)
    return tracking_step_of(found.facts, step, rows, frame, direction=direction, title=entry.title, image=image)
