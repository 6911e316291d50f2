import numpy as np
import pytest

from dropflow.simulation.flow import random_flow
from dropflow.simulation.scenario import DENSE, EASY, changed
from dropflow.tracking.grid import Grid

SEEDS = range(30)


def _points(n: int = 4000, extent_um: float = 4000.0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(7)
    return rng.uniform(0, extent_um, n), rng.uniform(0, extent_um, n)


@pytest.mark.parametrize("kspread", [0.0, 0.6])
def test_the_flow_has_no_divergence(kspread: float) -> None:
    flow = random_flow(changed(EASY, {"kspread": kspread}), np.random.default_rng(0))
    x, y = _points()
    h = 0.5
    du_dx = (flow.velocity_um_s(x + h, y, 5.0)[0] - flow.velocity_um_s(x - h, y, 5.0)[0]) / (2 * h)
    dv_dy = (flow.velocity_um_s(x, y + h, 5.0)[1] - flow.velocity_um_s(x, y - h, 5.0)[1]) / (2 * h)
    assert np.std(du_dx) > 0.01
    assert np.max(np.abs(du_dx + dv_dy)) < 1e-3 * np.std(du_dx)


def test_the_flow_has_the_rms_and_the_drift_of_the_scenario() -> None:
    scenario = changed(DENSE, {"drift_x_um_s": 3.0, "drift_y_um_s": -2.0, "flow_depth_rms_um_s": 0.7})
    x, y = _points()
    velocities = [random_flow(scenario, np.random.default_rng(s)).velocity_um_s(x, y, 0.0) for s in SEEDS]
    velocity = np.concatenate(velocities, axis=1)
    assert velocity.mean(axis=1) == pytest.approx([3.0, -2.0, 0.0], abs=0.15)
    assert velocity.std(axis=1) == pytest.approx([8.0, 8.0, 0.7], rel=0.05)


@pytest.mark.parametrize(("distance_um", "time_s"), [(100.0, 0.0), (200.0, 0.0), (0.0, 30.0), (0.0, 60.0)])
def test_the_flow_correlates_over_the_length_and_time_of_the_scenario(distance_um: float, time_s: float) -> None:
    x, y = _points()
    here, there = [], []
    for seed in SEEDS:
        flow = random_flow(changed(EASY, {"drift_y_um_s": 0.0}), np.random.default_rng(seed))
        here.append(flow.velocity_um_s(x, y, 0.0)[0])
        there.append(flow.velocity_um_s(x + distance_um, y, time_s)[0])
    # Along its own direction velocity correlates as the stream function does: exp(-d^2/2L^2 - t^2/2T^2).
    expected = np.exp(-0.5 * (distance_um / 200.0) ** 2 - 0.5 * (time_s / 30.0) ** 2)
    assert np.corrcoef(np.ravel(here), np.ravel(there))[0, 1] == pytest.approx(expected, abs=0.05)


def test_kspread_adds_small_and_large_eddies_at_the_same_rms() -> None:
    narrow, broad = (random_flow(changed(EASY, {"kspread": k}), np.random.default_rng(1)) for k in (0.0, 0.7))
    energies = []
    for flow in (narrow, broad):
        k2 = flow.kx_per_um**2 + flow.ky_per_um**2
        energies.append(np.sum(flow.amplitude_um2_s**2 * k2))
    spread = [np.std(np.log(np.hypot(flow.kx_per_um, flow.ky_per_um))) for flow in (narrow, broad)]
    assert energies[0] == pytest.approx(energies[1])
    assert spread[1] > 1.2 * spread[0]


def test_the_grid_holds_the_flow_at_the_centres_of_its_cells() -> None:
    flow = random_flow(EASY, np.random.default_rng(2))
    grid = Grid(height_px=100, width_px=200, n_rows=4, n_columns=5)
    field = flow.on_grid(grid, pixel_size_um=0.5, time_s=1.5)
    centre = flow.velocity_um_s(np.array([0.5 * grid.x_px[3]]), np.array([0.5 * grid.y_px[1]]), 1.5)
    assert field.shape == (2, 4, 5)
    assert field[:, 1, 3] == pytest.approx(centre[:2, 0])


def test_the_quick_sines_are_those_of_numpy() -> None:
    flow = random_flow(EASY, np.random.default_rng(3))
    x, y = _points(100)
    angle = flow.kx_per_um[:, None] * x + flow.ky_per_um[:, None] * y + (flow.omega_per_s * 1e4 + flow.phase)[:, None]
    u = (flow.amplitude_um2_s * flow.ky_per_um) @ np.cos(angle) + flow.drift_x_um_s
    w = flow.depth_amplitude_um_s @ np.cos(angle + flow.depth_phase[:, None])
    velocity = flow.velocity_um_s(x, y, 1e4)
    assert velocity[0] == pytest.approx(u, abs=1e-5)
    assert velocity[2] == pytest.approx(w, abs=1e-5)
