import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dropflow.simulation.cloud import Origin
from dropflow.simulation.flow import random_flow
from dropflow.simulation.optics import reach_um
from dropflow.simulation.population import Population
from dropflow.simulation.scenario import FAST, Scenario
from tests.dropflow.simulation.scenes import small

QUIET = {"growth_um_s": 0.0, "collision_efficiency": 0.0, "nucleation_per_s": 0.0}


def _population(scenario: Scenario, seed: int = 0) -> Population:
    rng = np.random.default_rng(seed)
    return Population(scenario, random_flow(scenario, rng), rng)


@pytest.mark.parametrize("delta_density", [-100.0, 60.0])
def test_in_still_fluid_droplets_move_with_stokes_velocity_alone(delta_density: float) -> None:
    still = small(
        FAST, delta_density_kg_m3=delta_density, flow_rms_um_s=0, flow_depth_rms_um_s=0, drift_y_um_s=0, **QUIET
    )
    population = _population(still)
    before = population.cloud
    population.advance(0.2)
    stays = np.isin(before.droplet_id, population.cloud.droplet_id)
    now = np.searchsorted(population.cloud.droplet_id, before.droplet_id[stays])
    # 2/9 drho g r^2 / eta; heavy droplets sink, which is down the image.
    down_um_s = 2 / 9 * delta_density * 9.81 * (before.r_um[stays] * 1e-6) ** 2 / still.viscosity_pa_s * 1e6
    assert stays.sum() > 10
    assert population.cloud.y_um[now] - before.y_um[stays] == pytest.approx(0.2 * down_um_s)
    assert population.cloud.x_um[now] == pytest.approx(before.x_um[stays])


def test_fast_droplets_follow_the_flow_on_their_curved_way() -> None:
    scenario = small(FAST, height_px=512, width_px=512, **QUIET)
    population = _population(scenario)
    flow, before = population._flow, population.cloud
    carried, _ = population.advance(0.5)
    stays = np.isfinite(carried[0])
    now = np.searchsorted(population.cloud.droplet_id, before.droplet_id[stays])
    rise = population.rise_um_s(before.r_um)
    for start, end in list(zip(np.flatnonzero(stays), now, strict=True))[:40]:

        def velocity(time_s: float, place: np.ndarray, up: float = rise[start]) -> np.ndarray:
            u, v, w = flow.velocity_um_s(place[:1], place[1:2], time_s)[:, 0]
            return np.array([u, v - up, w])

        begin = [before.x_um[start], before.y_um[start], before.z_um[start]]
        exact = solve_ivp(velocity, (0, 0.5), begin, rtol=1e-8, atol=1e-8).y[:, -1]
        cloud = population.cloud
        assert [cloud.x_um[end], cloud.y_um[end], cloud.z_um[end]] == pytest.approx(exact, abs=0.02)
        moved_um_s = (exact[:2] - begin[:2]) / 0.5
        assert carried[:, start] == pytest.approx(moved_um_s + np.array([0, rise[start]]), abs=0.05)


def test_number_and_sizes_stay_the_same_while_droplets_stream_through() -> None:
    scenario = small(FAST, height_px=700, width_px=700, n_droplets=600, **QUIET)
    population = _population(scenario)
    first = population.cloud
    counts, radii, rows = [], [], []
    for _ in range(40):
        population.advance(0.5)
        counts.append(len(population.cloud))
        radii.append(population.cloud.r_um)
        rows.append(population.cloud.y_um)
    assert not np.isin(first.droplet_id[first.r_um > 20], population.cloud.droplet_id).any()
    assert np.mean(counts) == pytest.approx(len(first), rel=0.12)
    assert np.concatenate(radii).mean() == pytest.approx(first.r_um.mean(), rel=0.06)
    thirds, _ = np.histogram(np.concatenate(rows), 3)
    assert thirds / thirds.mean() == pytest.approx([1, 1, 1], abs=0.12)


def test_no_droplet_is_farther_from_the_focal_plane_than_the_light_reaches() -> None:
    scenario = small(FAST, **QUIET)
    population = _population(scenario)
    population.advance(2.0)
    assert np.all(np.abs(population.cloud.z_um) <= reach_um(population.cloud.r_um, scenario))


def test_droplets_come_in_over_borders_and_in_depth_and_nucleate() -> None:
    population = _population(small(FAST, flow_depth_rms_um_s=20, nucleation_per_s=2000))
    population.advance(1.0)
    assert set(population.cloud.origin) >= {Origin.START, Origin.BORDER, Origin.FOCUS, Origin.NUCLEATION}
    born = population.cloud.origin == Origin.NUCLEATION
    assert population.cloud.r_um[born] == pytest.approx(4.0, abs=0.03)


def test_droplets_grow_as_the_scenario_says() -> None:
    population = _population(small(growth_um_s=0.5, growth_exponent=-1.0, collision_efficiency=0, nucleation_per_s=0))
    before = population.cloud
    population.advance(2.0)
    stays = np.isin(population.cloud.droplet_id, before.droplet_id)
    was = np.searchsorted(before.droplet_id, population.cloud.droplet_id[stays])
    # dr/dt = 0.5 (10 / r): r^2 grows evenly.
    gained = population.cloud.r_um[stays] ** 2 - before.r_um[was] ** 2
    assert gained == pytest.approx(np.full(len(gained), 2 * 2.0 * 0.5 * 10), rel=0.05)


def test_coalescing_droplets_keep_their_volume() -> None:
    population = _population(small(FAST, height_px=700, width_px=700, n_droplets=3000, collision_efficiency=1.0))
    radii = dict(zip(population.cloud.droplet_id.tolist(), population.cloud.r_um.tolist(), strict=True))
    n_checked = 0
    for _ in range(5):
        before = population.cloud
        radii |= dict(zip(before.droplet_id.tolist(), before.r_um.tolist(), strict=True))
        _, events = population.advance(0.01)
        for event in events:
            if all(parent in radii for parent in event.parents):
                n_checked += 1
                assert event.r_um**3 == pytest.approx(sum(radii[parent] ** 3 for parent in event.parents), rel=1e-3)
            radii[event.product] = event.r_um
    assert n_checked > 5


def test_wakes_disturb_small_droplets_near_large_ones_and_are_off_by_default() -> None:
    plain, disturbed = (_population(small(FAST, wake_strength=strength, **QUIET)) for strength in (0.0, 1.0))
    velocity, flow = plain.velocity_um_s(plain.cloud, 0.0)
    assert velocity[0] == pytest.approx(flow[0])
    velocity, flow = disturbed.velocity_um_s(disturbed.cloud, 0.0)
    assert np.std(velocity[0] - flow[0]) > 1.0


def test_an_empty_volume_stays_empty() -> None:
    population = _population(small(n_droplets=0, nucleation_per_s=0))
    carried, events = population.advance(1.0)
    assert (len(population.cloud), carried.shape, events) == (0, (2, 0), [])
