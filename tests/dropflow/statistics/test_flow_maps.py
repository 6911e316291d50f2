"""Maps of the flow: means over the steps in which a cell was computed, and derivatives of flows that are known."""

import numpy as np
import pytest

from dropflow.statistics.flow_maps import divergence_per_s, flow_map, vorticity_per_s

X_UM, Y_UM = np.arange(10.0, 210, 20), np.arange(5.0, 100, 10)
X, Y = np.meshgrid(X_UM, Y_UM)


def test_only_computed_cells_count_and_a_cell_without_any_is_unknown() -> None:
    velocity = np.zeros((4, 2, 2, 2), np.float32)
    velocity[:, 0, 0, 0] = [1, 2, 3, 100]
    velocity[:, 1, 0, 0] = 2
    velocity[:, :, 1, 1] = np.nan
    is_interpolated = np.zeros((4, 2, 2), bool)
    is_interpolated[3, 0, 0] = is_interpolated[:, 0, 1] = True
    found = flow_map([(velocity[:3], is_interpolated[:3]), (velocity[3:], is_interpolated[3:])])
    assert found.u_um_s[0, 0] == pytest.approx(2)
    assert found.v_um_s[0, 0] == pytest.approx(2)
    assert found.rms_um_s[0, 0] == pytest.approx(np.sqrt((1 + 4 + 9) / 3 + 4))
    assert found.computed_share[0].tolist() == [0.75, 0.0]
    assert np.isnan([found.u_um_s[0, 1], found.rms_um_s[1, 1]]).all()


def test_of_one_step_interpolated_cells_are_shown_too() -> None:
    velocity = np.full((1, 2, 2, 2), 3.0)
    is_interpolated = np.array([[[True, False], [True, True]]])
    found = flow_map([(velocity, is_interpolated)], is_every_cell_taken=True)
    assert found.u_um_s.tolist() == [[3, 3], [3, 3]]
    assert found.computed_share.tolist() == [[0, 1], [0, 0]]


def test_a_solid_turn_has_twice_its_rate_as_vorticity_and_no_divergence() -> None:
    rate_per_s = 0.3
    # Anticlockwise as seen: what is right of the centre moves up, which is towards smaller y.
    u, v = rate_per_s * (Y - 50), -rate_per_s * (X - 100)
    assert np.allclose(vorticity_per_s(u, v, X_UM, Y_UM), 2 * rate_per_s)
    assert np.allclose(divergence_per_s(u, v, X_UM, Y_UM), 0)


def test_a_source_has_divergence_and_no_vorticity() -> None:
    assert np.allclose(divergence_per_s(0.1 * X, 0.2 * Y, X_UM, Y_UM), 0.3)
    assert np.allclose(vorticity_per_s(0.1 * X, 0.2 * Y, X_UM, Y_UM), 0)
