import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from dropflow.parameters import PaperFlow
from dropflow.tracking.grid import Grid
from dropflow.tracking.paper.cell_average import cell_average, fill, smooth

GRID = Grid(height_px=200, width_px=250, n_rows=4, n_columns=5)
velocities = st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
seeds = st.integers(0, 2**31)


def places(seed: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.uniform(0, GRID.width_px - 1, n), rng.uniform(0, GRID.height_px - 1, n)


@settings(max_examples=50, deadline=None)
@given(seeds, st.integers(1, 60), velocities)
def test_a_uniform_flow_is_returned_exactly(seed: int, n: int, velocity: tuple[float, float]) -> None:
    """Averages, interpolated cells and border cells all have weights that sum to one."""
    x, y = places(seed, n)
    uniform = np.repeat(np.array(velocity)[:, None], n, axis=1)
    flow = cell_average(GRID, x, y, uniform, PaperFlow())
    np.testing.assert_allclose(flow.velocity_um_s[0], velocity[0], atol=1e-9)
    np.testing.assert_allclose(flow.velocity_um_s[1], velocity[1], atol=1e-9)
    assert flow.droplet_count.sum() == n


@settings(max_examples=30, deadline=None)
@given(seeds, velocities)
def test_adding_a_velocity_to_every_droplet_adds_it_to_the_field(seed: int, extra: tuple[float, float]) -> None:
    """The field is linear in the droplets' velocities, and its error does not depend on their mean."""
    x, y = places(seed, 40)
    advection = np.random.default_rng(seed).normal(size=(2, 40))
    flow = cell_average(GRID, x, y, advection, PaperFlow())
    shifted = cell_average(GRID, x, y, advection + np.array(extra)[:, None], PaperFlow())
    np.testing.assert_allclose(shifted.velocity_um_s, flow.velocity_um_s + np.array(extra)[:, None, None], atol=1e-9)
    np.testing.assert_allclose(shifted.velocity_std_um_s, flow.velocity_std_um_s, atol=1e-6)


@settings(max_examples=30, deadline=None)
@given(seeds)
def test_moving_every_droplet_by_a_cell_moves_the_averages_by_a_cell(seed: int) -> None:
    """No cell is treated unlike another, away from the border."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(60, 140, 20), rng.uniform(60, 140, 20)
    advection = rng.normal(size=(2, 20))
    here = cell_average(GRID, x, y, advection, PaperFlow(n_smoothings=0))
    there = cell_average(GRID, x + 50, y, advection, PaperFlow(n_smoothings=0))
    computed = ~here.is_interpolated[:, :-1]
    np.testing.assert_allclose(
        here.velocity_um_s[:, :, :-1][:, computed], there.velocity_um_s[:, :, 1:][:, computed], atol=1e-9
    )


def test_droplets_of_the_four_neighbours_count_half() -> None:
    """Eq. 6 by hand: two droplets in the cell, one beside it, one diagonal that does not count."""
    x = np.array([75.0, 76.0, 125.0, 125.0])
    y = np.array([75.0, 74.0, 75.0, 125.0])
    advection = np.array([[1.0, 2.0, 6.0, 100.0], [0.0, 0.0, 0.0, 0.0]])
    flow = cell_average(GRID, x, y, advection, PaperFlow(n_smoothings=0))
    assert flow.velocity_um_s[0, 1, 1] == (1 + 2 + 6 / 2) / (2 + 1 / 2)
    assert flow.droplet_count[1, 1] == 2


def test_a_cell_is_interpolated_if_neither_it_nor_a_cell_beside_it_has_a_droplet() -> None:
    """One droplet: a cross of computed cells around it, all else interpolated."""
    flow = cell_average(GRID, np.array([125.0]), np.array([75.0]), np.array([[1.0], [2.0]]), PaperFlow())
    cross = np.zeros((4, 5), bool)
    cross[1, 1:4] = cross[0:3, 2] = True
    np.testing.assert_array_equal(~flow.is_interpolated, cross)
    assert np.isfinite(flow.velocity_um_s).all()
    assert np.isfinite(flow.velocity_std_um_s).all()


def test_without_droplets_there_is_no_flow() -> None:
    """NaN everywhere, and nothing counts as computed."""
    flow = cell_average(GRID, np.empty(0), np.empty(0), np.empty((2, 0)), PaperFlow())
    assert not flow.is_known
    assert np.isnan(flow.velocity_um_s).all()
    np.testing.assert_array_equal(flow.mean_um_s(), 0)


def test_smoothing_has_the_papers_weights() -> None:
    """Eq. 7: 1/4, 1/8 beside, 1/16 diagonal."""
    spike = np.zeros((5, 5))
    spike[2, 2] = 16
    expected = np.array([[1, 2, 1], [2, 4, 2], [1, 2, 1]])
    np.testing.assert_allclose(smooth(spike)[1:4, 1:4], expected)
    assert smooth(spike).sum() == 16


@settings(max_examples=50, deadline=None)
@given(arrays(bool, (4, 5)), seeds)
def test_interpolated_cells_stay_between_the_computed_ones(computed: np.ndarray, seed: int) -> None:
    """Laplace's equation has no extremum inside."""
    if not computed.any():
        return
    values = np.random.default_rng(seed).normal(size=(2, 4, 5))
    filled = fill(values, computed)
    np.testing.assert_array_equal(filled[:, computed], values[:, computed])
    assert (filled.max(axis=(1, 2)) <= values[:, computed].max(axis=1) + 1e-9).all()
    assert (filled.min(axis=(1, 2)) >= values[:, computed].min(axis=1) - 1e-9).all()


def test_the_error_of_a_cell_is_that_of_its_mean() -> None:
    """Over many draws the error says how far a cell's value is from the true flow (upper bound: smoothing helps)."""
    x, y = places(1, 400)
    rng = np.random.default_rng(2)
    draws = [cell_average(GRID, x, y, rng.normal(0, 3, (2, 400)), PaperFlow(n_smoothings=0)) for _ in range(200)]
    seen = np.std([flow.velocity_um_s for flow in draws], axis=0)
    said = np.mean([flow.velocity_std_um_s for flow in draws], axis=0)
    np.testing.assert_allclose(said, seen, rtol=0.25)


@settings(max_examples=50, deadline=None)
@given(seeds, st.floats(-5, 5), st.floats(-5, 5))
def test_sampling_is_exact_for_a_flow_that_is_linear_in_place(seed: int, along: float, down: float) -> None:
    """Bilinear inside the outermost centres; the value at a centre is the cell's."""
    flow = cell_average(GRID, *places(seed, 30), np.ones((2, 30)), PaperFlow())
    flow.velocity_um_s[:] = along * GRID.x_px + down * GRID.y_px[:, None]
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(GRID.x_px[0], GRID.x_px[-1], 20), rng.uniform(GRID.y_px[0], GRID.y_px[-1], 20)
    np.testing.assert_allclose(flow.sample(x, y)[0], along * x + down * y, atol=1e-9)
