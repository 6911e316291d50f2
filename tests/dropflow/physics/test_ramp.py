import numpy as np
import pytest

from dropflow.errors import ExperimentError, ParametersError
from dropflow.physics.binodal import BinodalPoint, ScalingBinodal, TableBinodal
from dropflow.physics.material import MixtureProperties
from dropflow.physics.material_files import find_material
from dropflow.physics.ramp import LONGEST_S, N_STEPS, Protocol, ramp_csv, ramp_rows, temperature_ramp

DRIVING_PER_S = 1.05e-5


@pytest.fixture(scope="module")
def scaling() -> ScalingBinodal:
    binodal = MixtureProperties(find_material("water-isobutoxyethanol-illustrative")).binodal
    assert isinstance(binodal, ScalingBinodal)
    return binodal


@pytest.fixture(scope="module")
def table(scaling: ScalingBinodal) -> TableBinodal:
    """A table as dense as the paper's, measured on the scaling form."""
    temperatures_c = np.linspace(25.6, 50.5, 30)
    bottom, top = scaling.phases(temperatures_c)
    points = tuple(
        BinodalPoint(temperature_c=float(t), bottom=float(b), top=float(u))
        for t, b, u in zip(temperatures_c, bottom, top, strict=True)
    )
    return TableBinodal(points=points, source="test")


@pytest.mark.parametrize("kind", ["scaling", "table"])
def test_the_slope_is_the_derivative_of_the_half_width(kind: str, request: pytest.FixtureRequest) -> None:
    binodal = request.getfixturevalue(kind)
    t, step = np.linspace(27.0, 49.0, 12), 1e-2
    numeric = (binodal.half_width(t + step) - binodal.half_width(t - step)) / (2 * step)
    np.testing.assert_allclose(binodal.half_width_slope_per_k(t), numeric, rtol=2e-3)


def test_polynomials_of_sixth_and_fourth_order_follow_the_table(table: TableBinodal, scaling: ScalingBinodal) -> None:
    temperatures_c = np.linspace(28.0, 50.0, 50)
    for fitted, true in zip(table.phases(temperatures_c), scaling.phases(temperatures_c), strict=True):
        np.testing.assert_allclose(fitted, true, atol=0.01)
    assert max(table.residual_k) < 0.3


def test_outside_the_table_is_an_error_not_an_extrapolation(table: TableBinodal) -> None:
    with pytest.raises(ExperimentError, match="not at 25"):
        table.phases(25.0)
    with pytest.raises(ExperimentError):
        temperature_ramp(table, start_c=25.8, end_c=70.0, driving_per_s=DRIVING_PER_S)


def test_a_table_whose_gap_does_not_widen_is_refused() -> None:
    points = [BinodalPoint(temperature_c=30 + i, bottom=0.3, top=0.5 - 0.01 * i) for i in range(8)]
    with pytest.raises(ValueError, match="widen"):
        TableBinodal(points=tuple(points), source="test")


@pytest.mark.parametrize("kind", ["scaling", "table"])
def test_the_ramp_keeps_the_driving_constant(kind: str, request: pytest.FixtureRequest) -> None:
    binodal = request.getfixturevalue(kind)
    ramp = temperature_ramp(binodal, driving_per_s=DRIVING_PER_S)
    assert len(ramp.time_s) == N_STEPS + 1
    assert ramp.temperature_c[0] == 25.8
    assert ramp.temperature_c[-1] == 50.0
    driving = np.gradient(np.log(binodal.half_width(ramp.temperature_c)), ramp.time_s)
    np.testing.assert_allclose(driving[50:-50], DRIVING_PER_S, rtol=0.03)


def test_the_ramp_is_the_closed_form_of_the_scaling_law(scaling: ScalingBinodal) -> None:
    """Phi_0 grows as exp(xi t), so T - Tc grows as exp(xi t / beta)."""
    ramp = temperature_ramp(scaling, driving_per_s=DRIVING_PER_S)
    exact = 25.5 + 0.3 * np.exp(DRIVING_PER_S * ramp.time_s / scaling.exponent)
    np.testing.assert_allclose(ramp.temperature_c, exact, atol=0.03)
    assert ramp.duration_s == pytest.approx(scaling.exponent * np.log(24.5 / 0.3) / DRIVING_PER_S, rel=1e-3)


def test_a_given_duration_gives_its_driving(scaling: ScalingBinodal) -> None:
    by_xi = temperature_ramp(scaling, driving_per_s=DRIVING_PER_S)
    by_time = temperature_ramp(scaling, duration_s=by_xi.duration_s)
    assert by_time.driving_per_s == pytest.approx(DRIVING_PER_S)
    np.testing.assert_allclose(by_time.temperature_c, by_xi.temperature_c)


@pytest.mark.parametrize(
    "wrong",
    [
        {},
        {"driving_per_s": 1e-5, "duration_s": 10.0},
        {"driving_per_s": -1e-5},
        {"duration_s": 0.0},
        {"driving_per_s": 1e-5, "start_c": 50.0, "end_c": 30.0},
        {"driving_per_s": 1e-9},
        {"duration_s": 2 * LONGEST_S},
    ],
)
def test_an_impossible_ramp_is_refused(scaling: ScalingBinodal, wrong: dict[str, float]) -> None:
    with pytest.raises(ParametersError):
        temperature_ramp(scaling, **wrong)


def test_set_points_come_once_a_second_with_the_protocol_before_them(scaling: ScalingBinodal) -> None:
    ramp = temperature_ramp(scaling, duration_s=100.0)
    rows = list(ramp_rows(ramp, Protocol(mixing_s=3, equilibration_s=2)))
    assert [row[0] for row in rows] == list(range(3 + 2 + 101))
    assert [row[2] for row in rows[:6]] == ["mixing"] * 3 + ["equilibration"] * 2 + ["ramp"]
    assert rows[0][1] == 24.0
    assert rows[4][1] == rows[5][1] == 25.8
    lines = "".join(ramp_csv(ramp)).splitlines()
    assert len(lines) == 1 + 101
    assert lines[:2] == ["time_s,temperature_c,stage", "0,25.8000,ramp"]
