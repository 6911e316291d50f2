"""The figures that need more than histograms: each draws what it is given and says so where there is nothing."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
import pytest

from dropflow import figures
from dropflow.figures import working
from dropflow.figures.following import Direction
from dropflow.parameters import PaperDetection
from dropflow.physics.material import MixtureProperties
from dropflow.physics.material_files import MaterialFile, find_material
from dropflow.physics.ramp import temperature_ramp
from dropflow.statistics.coalescence import CoalescenceRates
from dropflow.statistics.histograms import radius_edges_um

R_MIN_PX, R_MAX_PX = 5.0, 40.0


@pytest.fixture(scope="module")
def material() -> MaterialFile:
    return find_material("water-isobutoxyethanol-illustrative")


@pytest.fixture(scope="module")
def two_overlapping() -> np.ndarray:
    """Two blurred disks of radius 20 and 14 that overlap, levels 0 to 255."""
    y, x = np.mgrid[:120, :140].astype(np.float32)
    edges = [r - np.hypot(x - at_x, y - at_y) for at_x, at_y, r in ((55, 60, 20), (86, 60, 14))]
    light = np.clip(np.maximum(*edges) / 4 + 0.5, 0, 1)
    return (30 + 180 * light + np.random.default_rng(0).normal(0, 2, light.shape)).astype(np.float32)


def words_of(figure: go.Figure) -> str:
    return json.dumps(figure.to_plotly_json(), default=str)


def test_every_figure_of_an_illustrative_material_says_that_it_is_not_measured(material: MaterialFile) -> None:
    ramp = temperature_ramp(MixtureProperties(material).binodal, driving_per_s=1e-5, n_steps=500)
    for figure in (
        figures.phase_diagram(material),
        figures.viscosity(material),
        figures.temperature_ramp(ramp, material),
    ):
        assert "illustrative, not measured" in words_of(figure)


def test_curves_of_viscosity_stand_in_the_order_of_the_papers_figure(material: MaterialFile) -> None:
    """From top to bottom: top phase, isobutoxyethanol, bottom phase, water (Fig. 16), at 40 C."""
    at_40 = [float(np.interp(40.0, trace.x, trace.y)) for trace in figures.viscosity(material).data]
    names = [trace.name for trace in figures.viscosity(material).data]
    order = [name for _, name in sorted(zip(at_40, names, strict=True), reverse=True)]
    assert order == ["top phase", "isobutoxyethanol", "bottom phase", "water"]


def test_periods_against_driving_show_groups_fit_and_theory() -> None:
    driving = np.geomspace(3e-6, 1e-3, 12)
    figure = figures.periods_against_driving({str(xi): (xi, np.array([2 * xi ** (-3 / 7)] * 3)) for xi in driving})
    names = [trace.name for trace in figure.data]
    assert sum("ξ" in name for name in names) == 6
    assert any("−0.43" in name for name in names)
    assert any("−3/7" in name for name in names)
    assert "no experiment" in words_of(figures.periods_against_driving({}))


def test_panels_of_thresholding_and_watershed_show_both_droplets(two_overlapping: np.ndarray) -> None:
    by_distance = working.thresholding(two_overlapping, 120.0, r_min_px=R_MIN_PX, r_max_px=R_MAX_PX)
    by_watershed = working.watershed(two_overlapping, maxima_height=20, r_min_px=R_MIN_PX, r_max_px=R_MAX_PX)
    for figure in (by_distance, by_watershed):
        assert sum(trace.type == "heatmap" for trace in figure.data) == 4
        (drawn,) = (trace for trace in figure.data if trace.name == "droplets")
        assert np.isnan(np.asarray(drawn.x, float)).sum() >= 1


def test_panels_of_an_empty_piece_have_no_droplets() -> None:
    flat = np.full((40, 50), 100, np.float32)
    for figure in (
        working.thresholding(flat, 120.0, r_min_px=R_MIN_PX, r_max_px=R_MAX_PX),
        working.watershed(flat, maxima_height=20, r_min_px=R_MIN_PX, r_max_px=R_MAX_PX),
    ):
        assert all(trace.name != "droplets" for trace in figure.data)


def test_the_match_is_highest_near_the_droplet(two_overlapping: np.ndarray) -> None:
    figure = working.match(two_overlapping, 55.0, 60.0, 20.0, knobs=PaperDetection())
    curve = next(trace for trace in figure.data if trace.xaxis == "x2")
    assert abs(curve.x[int(np.argmax(curve.y))] - 20.0) < 4


def test_displacement_shows_red_green_and_arrows() -> None:
    here = tuple(np.array([50.0]) for _ in "xyr")
    figure = figures.displacement(
        np.ones((2, 2, 2)),
        np.zeros((2, 2), bool),
        np.array([25.0, 75.0]),
        np.array([25.0, 75.0]),
        here_px=here,
        next_px=here,
        pixel_size_um=0.5,
        frame=4,
    )
    assert {"droplets, frame 4", "flow, from droplets", "droplets, frame 5"} <= {trace.name for trace in figure.data}


@pytest.mark.parametrize(("direction", "number", "expected"), [("forward", 0, 12.0), ("backward", 1, 8.0)])
def test_a_step_of_tracking_predicts_with_sedimentation_and_flow(direction: str, number: int, expected: float) -> None:
    trajectory = (np.array([10.0, 12.0]), np.array([40.0, 30.0]), np.array([4.0, 4.0]))
    start = trajectory[0][number]
    figure = figures.tracking_step(
        trajectory,
        number,
        velocity_um_s=(2.0 if direction == "forward" else 4.0, 0.0),
        sedimentation_um_s=(0.0, -10.0),
        interval_s=1.0,
        pixel_size_um=1.0,
        direction=Direction(direction),
    )
    advection = next(trace for trace in figure.data if trace.name == "advection")
    assert advection.x[0] == start
    assert advection.x[1] == pytest.approx(expected)


def test_a_step_beyond_the_trajectory_says_so() -> None:
    one = tuple(np.array([10.0]) for _ in "xyr")
    figure = figures.tracking_step(
        one, 0, velocity_um_s=(0, 0), sedimentation_um_s=(0, 0), interval_s=1.0, pixel_size_um=1.0
    )
    assert "no frame" in words_of(figure)


def test_coalescence_writes_the_number_into_each_bin() -> None:
    edges = radius_edges_um(4, 40, 4)
    counts = np.zeros((4, 4), int)
    counts[1, 2] = 7
    figure = figures.coalescence(CoalescenceRates(edges, counts, counts / 1e6))
    assert "7" in np.asarray(figure.data[0].text).ravel().tolist()
    assert "no coalescence" in words_of(figures.coalescence(CoalescenceRates(edges, counts * 0, counts * 0.0)))


def test_importing_statistics_needs_no_figures() -> None:
    """A worker that only counts droplets must not load Plotly."""
    code = "import sys, dropflow.statistics.histograms; sys.exit('plotly' in sys.modules)"
    root = Path(__file__).parents[3]
    assert subprocess.run([sys.executable, "-c", code], cwd=root, check=False, timeout=60).returncode == 0
