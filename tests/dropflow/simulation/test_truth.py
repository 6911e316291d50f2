import numpy as np
import polars as pl
import pytest

from dropflow.simulation.film import Film
from dropflow.simulation.scenario import DARK, DENSE, FAST
from dropflow.simulation.truth import TRUTH, hidden_fraction, inside_fraction, visibility
from tests.dropflow.simulation.scenes import clean, cloud, slope, small


@pytest.mark.parametrize(
    ("blur_over_r", "contrast", "inside", "hidden", "expected"),
    [
        (0.22, 8.0, 0.75, 0.5, "visible"),
        (0.05, 90.0, 1.0, 0.0, "visible"),
        (0.221, 90.0, 1.0, 0.0, "borderline"),
        (0.36, 90.0, 1.0, 0.0, "borderline"),
        (0.361, 90.0, 1.0, 0.0, "not"),
        (0.05, 7.9, 1.0, 0.0, "borderline"),
        (0.05, 4.0, 1.0, 0.0, "borderline"),
        (0.05, 3.9, 1.0, 0.0, "not"),
        (0.05, 90.0, 0.74, 0.0, "borderline"),
        (0.05, 90.0, 0.4, 0.0, "borderline"),
        (0.05, 90.0, 0.39, 0.0, "not"),
        (0.05, 90.0, 1.0, 0.51, "borderline"),
        (0.05, 90.0, 1.0, 0.9, "borderline"),
        (0.05, 90.0, 1.0, 0.91, "not"),
        (0.3, 90.0, 1.0, 0.95, "not"),
    ],
)
def test_visibility_follows_the_rules(
    blur_over_r: float, contrast: float, inside: float, hidden: float, expected: str
) -> None:
    columns = (np.array([value]) for value in (blur_over_r, contrast, inside, hidden))
    assert visibility(*columns).tolist() == [expected]


def test_the_inside_fraction_is_the_area_in_the_frame() -> None:
    x = np.array([50.0, -0.5, -0.5, 99.5, -30.0, 50.0, 49.5])
    y = np.array([50.0, 50.0, -0.5, 50.0, 50.0, 84.5, 49.5])
    r = np.array([20.0, 20.0, 20.0, 20.0, 20.0, 20.0, 500.0])
    # A disk cut at three quarters of its diameter keeps 1 - (acos(1/2) - sqrt(3)/4) / pi.
    cut = 1 - (np.pi / 3 - np.sqrt(3) / 4) / np.pi
    y[5] = 99.5 - 10.0
    expected = [1.0, 0.5, 0.25, 0.5, 0.0, cut, 100 * 100 / (np.pi * 500**2)]
    assert inside_fraction(x, y, r, 100, 100) == pytest.approx(expected, abs=2e-3)


def test_only_nearer_droplets_hide_and_as_much_as_they_are_opaque() -> None:
    scenario = clean(opacity=0.8, opacity_depth_um=1.0)
    hidden = hidden_fraction(cloud((0, 0, 0, 10), (0, 0, 50, 30), (200, 0, 0, 10), (211, 0, 5, 10)), scenario)
    assert hidden[0] == pytest.approx(0.8, abs=0.01)
    assert hidden[1] == 0
    assert 0.1 < hidden[2] < 0.5
    assert hidden[3] == 0


def test_a_droplet_behind_several_is_hidden_by_their_product() -> None:
    scenario = clean(opacity=0.5, opacity_depth_um=0.1)
    hidden = hidden_fraction(cloud((0, 0, 0, 5), (0, 0, 40, 20), (0, 0, 80, 20)), scenario)
    assert hidden[0] == pytest.approx(0.75, abs=0.01)


@pytest.mark.parametrize("scenario", [FAST, DARK, DENSE], ids=lambda s: s.name)
def test_stokes_velocity_is_recovered_from_the_truth(scenario: object) -> None:
    film = Film(small(scenario, height_px=700, width_px=700), seed=4)
    rows = pl.concat([pl.from_arrow(moment.truth(film.scenario)) for moment in film.moments(4)])
    r_um = rows["r_um"].to_numpy()
    relative = -(rows["v_um_s"] - rows["flow_v_um_s"]).to_numpy()
    physics = -2 / 9 * 9.81 * film.scenario.delta_density_kg_m3 / film.scenario.viscosity_pa_s * 1e-6
    assert slope(r_um**2, relative) == pytest.approx(physics, rel=0.01)
    assert slope(r_um**2, rows["sedimentation_um_s"].to_numpy()) == pytest.approx(physics, rel=1e-6)
    assert (rows["u_um_s"] - rows["flow_u_um_s"]).abs().max() < 1e-6


def test_velocities_lead_to_the_place_in_the_next_frame() -> None:
    film = Film(small(FAST), seed=1)
    here, there = (pl.from_arrow(moment.truth(film.scenario)) for moment in film.moments(2))
    both = here.join(there, on="droplet_id", suffix="_next")
    assert len(both) > 5
    for axis, velocity in (("x_um", "u_um_s"), ("y_um", "v_um_s")):
        reached = (both[axis] + both[velocity] * 0.5).to_numpy()
        assert reached == pytest.approx(both[f"{axis}_next"].to_numpy())


def test_rows_are_sorted_in_the_frame_and_have_the_units_of_their_names() -> None:
    film = Film(small(DENSE), seed=1)
    for moment in film.moments(2):
        table = moment.truth(film.scenario)
        assert table.schema == TRUTH
        rows = pl.from_arrow(table)
        assert rows["droplet_id"].is_sorted()
        assert rows["inside_fraction"].min() > 0
        assert rows["contrast"].min() >= 0.5
        assert (rows["r_um"] / rows["r_px"]).to_numpy() == pytest.approx(np.full(len(rows), 0.625))


def test_the_number_of_visible_droplets_is_that_of_the_scenario() -> None:
    scenario = small(DENSE, height_px=1029, width_px=1224, n_droplets=400)
    counts = []
    for seed in range(6):
        truth = pl.from_arrow(next(Film(scenario, seed).moments(1)).truth(scenario))
        is_theirs = (truth["blur_px"] <= 0.22 * truth["r_px"]) & (truth["inside_fraction"] >= 0.5)
        counts.append((is_theirs & (truth["contrast"] >= 8)).sum())
    assert np.mean(counts) == pytest.approx(100, abs=4 * np.sqrt(100 / 6))


def test_contrast_follows_the_light_of_the_sheet() -> None:
    scenario = clean(gradient=0.8)
    film = Film(scenario, 0)
    moment = next(film.moments(1))
    rows = pl.from_arrow(moment.truth(scenario))
    flat = pl.from_arrow(next(Film(clean(gradient=0.0), 0).moments(1)).truth(clean(gradient=0.0)))
    both = rows.join(flat, on="droplet_id", suffix="_flat").filter(pl.col("y_px").is_between(0, 191))
    light = 1 + 0.8 * ((both["y_px"] + 0.5) / 192 - 0.5)
    assert (both["contrast"] / both["contrast_flat"]).to_numpy() == pytest.approx(light.to_numpy())
