import json
import math

import numpy as np
import plotly.graph_objects as go
import pyarrow as pa
import pytest

from dropflow import figures
from dropflow.figures.layout import log_colour_bar, with_error
from dropflow.statistics.histograms import FrameHistograms, frame_histograms, merge, radius_edges_um

EDGES_UM = radius_edges_um(4.0, 40.0)
AREA_UM2 = 1300.0 * 1500.0


def simulated_histograms(n_frames: int, n_droplets: int = 20) -> FrameHistograms:
    rng = np.random.default_rng(1)
    frame = np.repeat(np.arange(n_frames, dtype=np.int32), n_droplets)
    table = pa.table({"frame": frame, "r_um": rng.uniform(4, 40, len(frame))})
    return frame_histograms(table, EDGES_UM, range(n_frames), np.arange(n_frames) * 0.5)


def words_of(figure: go.Figure) -> str:
    return json.dumps(figure.to_plotly_json(), default=str)


def test_a_film_of_20000_frames_makes_small_figures() -> None:
    histograms = simulated_histograms(20_000, 5)
    for make in (figures.size_distribution, figures.moments):
        assert len(make(histograms, area_um2=AREA_UM2).to_json()) < 300_000


@pytest.mark.parametrize(("depth_um", "unit", "other"), [(20.0, "−4", "−3"), (None, "−3", "−4")])
def test_the_colour_bar_says_per_volume_or_per_area(depth_um: float | None, unit: str, other: str) -> None:
    figure = figures.size_distribution(simulated_histograms(5), area_um2=AREA_UM2, observation_depth_um=depth_um)
    title = figure.data[0].colorbar.title.text
    assert f"µm<sup>{unit}</sup>" in title
    assert f"µm<sup>{other}</sup>" not in title


def test_the_heat_map_shows_density_as_decadic_logarithm() -> None:
    histograms = simulated_histograms(3, 400)
    figure = figures.size_distribution(histograms, area_um2=AREA_UM2, observation_depth_um=10.0)
    expected = histograms.counts[1, 5] / (AREA_UM2 * 10.0 * (EDGES_UM[6] - EDGES_UM[5]))
    assert figure.data[0].z[5, 1] == pytest.approx(np.log10(expected), rel=1e-5)


def test_missing_frames_leave_an_empty_column_as_wide_as_they_are() -> None:
    whole = simulated_histograms(30)
    heat = figures.size_distribution(merge(whole[:10], whole[20:]), area_um2=AREA_UM2).data[0]
    assert np.isnan(heat.z[:, 10]).all()
    assert heat.x[11] - heat.x[10] == pytest.approx(10 * 0.5)


@pytest.mark.parametrize("n_frames", [0, 1])
def test_no_droplets_give_an_empty_labelled_figure(n_frames: int) -> None:
    histograms = simulated_histograms(n_frames, 0)
    for make in (figures.size_distribution, figures.moments):
        assert "no droplets" in words_of(make(histograms, area_um2=AREA_UM2))


def test_one_frame_is_drawn() -> None:
    assert figures.size_distribution(simulated_histograms(1), area_um2=AREA_UM2).data[0].z.shape == (48, 1)


def test_computed_and_interpolated_arrows_stand_apart_in_micrometres() -> None:
    velocity = np.ones((2, 3, 4))
    is_interpolated = np.zeros((3, 4), bool)
    is_interpolated[0, :2] = True
    figure = figures.flow_field(
        velocity, is_interpolated, np.arange(4) * 100.0, np.arange(3) * 100.0, pixel_size_um=0.5, frame=7
    )
    arrows = {trace.name: trace for trace in figure.data}
    assert len(arrows["flow, interpolated"].x) == 2
    assert len(arrows["flow, from droplets"].x) == 10
    assert max(arrows["flow, from droplets"].x) == 150.0
    assert "frame 7" in figure.layout.title.text


def test_a_step_without_flow_says_so() -> None:
    nothing = np.full((2, 3, 4), np.nan)
    figure = figures.flow_field(
        nothing, np.ones((3, 4), bool), np.arange(4.0), np.arange(3.0), pixel_size_um=0.5, frame=0
    )
    assert "no flow" in words_of(figure)


def test_flow_over_a_frame_carries_the_frame_as_its_background() -> None:
    image = np.random.default_rng(0).normal(100, 10, (2058, 2448))
    figure = figures.flow_field(
        np.ones((2, 3, 4)),
        np.zeros((3, 4), bool),
        np.arange(4) * 600.0,
        np.arange(3) * 600.0,
        pixel_size_um=0.5,
        frame=0,
        image=image,
    )
    (layer,) = figure.layout.images
    assert (layer.sizex, layer.sizey) == (1224.0, 1029.0)
    assert len(figure.to_json()) < 600_000


def test_flow_moments_draw_both_components_and_say_when_there_is_none() -> None:
    time_s, values = np.arange(8.0), np.ones((8, 2))
    names = {trace.name for trace in figures.flow_moments(time_s, values, values).data}
    assert names == {"mean horizontal", "mean vertical", "rms horizontal", "rms vertical"}
    assert "no flow" in words_of(figures.flow_moments(time_s, values * np.nan, values * np.nan))


def test_a_caption_stands_under_the_figure() -> None:
    caption = figures.caption_of({"experiment": "ramp 3", "method": "paper", "note": None})
    assert caption == "experiment: ramp 3 · method: paper"
    assert "ramp 3" in words_of(figures.moments(simulated_histograms(2), area_um2=1.0, caption=caption))


def test_a_long_caption_breaks_between_words_and_not_within_names() -> None:
    name = "water-isobutoxyethanol-illustrative"
    for n_before in range(60, 120):
        words = words_of(figures.moments(simulated_histograms(2), area_um2=1.0, caption=f"{'x' * n_before} {name}"))
        assert name in words


def test_moments_of_one_frame_are_points() -> None:
    shown = figures.moments(simulated_histograms(1), area_um2=1.0)
    assert {trace.mode for trace in shown.data if trace.name} == {"markers"}


@pytest.mark.parametrize(
    ("value", "std", "said"),
    [
        (-24598.2, 631.4, "(−2.460 ± 0.063)·10⁴ s/m²"),
        (1.6586, 0.14, "1.66 ± 0.14 s/m²"),
        (108.85, 4.53, "108.8 ± 4.5 s/m²"),
        (2.3e-5, 4e-6, "(2.30 ± 0.40)·10⁻⁵ s/m²"),
        (3.0, math.nan, "3 s/m²"),
        (-25000.0, math.nan, "−2.5·10⁴ s/m²"),
        (0.0, 0.3, "0.00 ± 0.30 s/m²"),
        (250.0, 0.0, "250 s/m²"),
        (math.nan, 1.0, "not known"),
    ],
)
def test_numbers_have_as_many_digits_as_their_errors_allow(value: float, std: float, said: str) -> None:
    assert with_error(value, std, "s/m²") == said


def test_a_colour_bar_within_one_decade_has_more_than_one_tick() -> None:
    bar = log_colour_bar("n", 0.0, math.log10(7))
    shown = [text for at, text in zip(bar["tickvals"], bar["ticktext"], strict=True) if 0 <= at <= math.log10(7)]
    assert len(shown) >= 3
