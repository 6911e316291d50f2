"""Ways through a flow that turns, against a solver of differential equations."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp

from dropflow.tracking.probable.directions import turned
from dropflow.tracking.probable.least_squares import Observations
from dropflow.tracking.probable.observing import along_flow
from dropflow.tracking.probable.regression import WaveFlow, regress
from dropflow.tracking.probable.ways import ways
from tests.dropflow.tracking.probable.test_regression import UP, model, observations

Floats = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def flow() -> WaveFlow:
    """Vortices of 8 um/s and about 150 px, as droplets without noise show them."""
    seen = observations(200)
    u, v = 8 * np.sin(seen.y_px / 100), 8 * np.cos(seen.x_px / 90)
    across, along = turned(u, v, UP)
    return regress(replace(seen, across_um_s=across, along_um_s=along - 0.1 * seen.sedimentation_um_s), model())


def solved(flow: WaveFlow, start: Floats, own_um_s: Floats, px_per_um_s: float) -> Floats:
    """Ends of the ways."""

    def velocity(_: float, places: Floats) -> Floats:
        return ((flow.at(*places.reshape(2, -1)) + own_um_s) * px_per_um_s).ravel()

    return np.asarray(solve_ivp(velocity, (0, 1), start.ravel(), rtol=1e-8, atol=1e-8).y[:, -1].reshape(2, -1))


def starts(n: int = 80) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(5)
    return rng.uniform(100, 300, (2, n)), np.outer(UP, rng.uniform(0, 8, n))


@pytest.mark.parametrize("px_per_um_s", [0.5, 5.0, 15.0, -15.0])
def test_ways_lead_where_a_solver_says(flow: WaveFlow, px_per_um_s: float) -> None:
    """Short and long, forward and back; in thousandths of how far they lead."""
    start, own = starts()
    found = ways(flow, start, own, px_per_um_s)
    error = np.hypot(*(start + found.step_px - solved(flow, start, own, px_per_um_s)))
    length = np.hypot(*found.step_px)
    assert np.sqrt((error**2).mean()) < 0.01 * np.sqrt((length**2).mean())
    half = solved(flow, start, own, px_per_um_s / 2)
    off = np.hypot(*(found.middle_px - half))
    assert np.sqrt((off**2).mean()) < 0.03 * np.sqrt((length**2).mean())


def test_velocities_are_those_of_the_flow_however_far_droplets_go(flow: WaveFlow) -> None:
    """Straight from end to end they are not."""
    start, own = starts()
    px_per_um_s = 20.0
    end = solved(flow, start, own, px_per_um_s)
    velocity = (end - start) / px_per_um_s
    sedimentation = own[0] / UP[0]
    across, along = turned(velocity[0], velocity[1], UP)
    sure = np.ones(len(across))
    straight = Observations(
        *((start + end) / 2), across, along - sedimentation, sedimentation, 0.01 * sure, 0.01 * sure, sure
    )
    as_stokes_says = flow.amplitudes.copy()
    as_stokes_says[2] = -flow.model.factor_mean
    true = replace(flow, amplitudes=as_stokes_says)
    errors = []
    for seen in (straight, along_flow(straight, true, px_per_um_s)):
        u, v = true.at(seen.x_px, seen.y_px)
        across, along = turned(u, v, UP)
        off = np.concatenate([seen.across_um_s - across, seen.along_um_s - along])
        errors.append(float(np.sqrt((off**2).mean())))
    assert errors[0] > 0.9
    assert errors[1] < 0.05 * errors[0]


def test_short_ways_are_left_as_they_are(flow: WaveFlow) -> None:
    """Bit for bit."""
    seen = observations(30)
    assert along_flow(seen, flow, 0.1) is seen
