"""The figures of a run, from its histograms and its flow field."""

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from backend.models import Run
from backend.platform.packing import unpack
from backend.results.schemas import FrameDroplets, FrameFlow
from dropflow import figures
from dropflow.experiment import Experiment, parse_experiment
from dropflow.frames import Frame
from dropflow.statistics.flow_moments import FlowMoments
from dropflow.statistics.histograms import FrameHistograms, merge

TITLES = {
    "detect": "Droplet size distribution before tracking",
    "track": "Droplet size distribution after tracking",
}


def size_distribution(run: Run, shape: tuple[int, int], task: str, packed: Sequence[bytes]) -> go.Figure:
    """The size distribution over time, of the frames that are done."""
    experiment = parse_experiment(run.document)
    return figures.size_distribution(
        _merged(packed),
        area_um2=_area_um2(experiment, shape),
        observation_depth_um=experiment.observation_depth_um,
        title=TITLES[task],
        caption=_caption(run),
    )


def moments(run: Run, shape: tuple[int, int], packed: Sequence[bytes]) -> go.Figure:
    """Number, radii and fraction over time, of the frames that are done."""
    experiment = parse_experiment(run.document)
    return figures.moments(
        _merged(packed),
        area_um2=_area_um2(experiment, shape),
        observation_depth_um=experiment.observation_depth_um,
        caption=_caption(run),
    )


def flow_field(run: Run, flow: FrameFlow, droplets: FrameDroplets, image: Frame) -> go.Figure:
    """Arrows over a frame and its droplets."""
    return figures.flow_field(
        np.array([flow.u_um_s, flow.v_um_s], np.float64),
        np.array(flow.is_interpolated),
        np.array(flow.grid_x_px),
        np.array(flow.grid_y_px),
        pixel_size_um=parse_experiment(run.document).pixel_size_um,
        frame=flow.frame,
        droplets_px=(np.array(droplets.x_px), np.array(droplets.y_px), np.array(droplets.r_px)),
        image=image,
        caption=_caption(run),
    )


def flow_moments(run: Run, packed: bytes) -> go.Figure:
    """Mean and rms of the flow over time."""
    found = unpack(FlowMoments, packed)
    return figures.flow_moments(found.time_s, found.mean_um_s, found.rms_um_s, caption=_caption(run))


def as_json(figure: go.Figure) -> str:
    """A figure as the page takes it."""
    text: str = figure.to_json()
    return text


def _merged(packed: Sequence[bytes]) -> FrameHistograms:
    return merge(*(unpack(FrameHistograms, content) for content in packed))


def _caption(run: Run) -> str:
    name = parse_experiment(run.document).name
    method = run.parameters["detection"]["method"]
    return figures.caption_of({"experiment": name, "run": run.number, "method": method, "dropflow": run.version})


def _area_um2(experiment: Experiment, shape: tuple[int, int]) -> float:
    return shape[0] * shape[1] * experiment.pixel_size_um**2
