"""Mean and rms of the flow over time."""

from pathlib import Path

import numpy as np
import pytest
import zarr

from dropflow.errors import ResultsError
from dropflow.statistics.flow_moments import flow_moments


def _write(folder: Path, velocity: np.ndarray, is_interpolated: np.ndarray) -> Path:
    times_s = np.arange(len(velocity)) * 0.5
    for name, values in (("velocity_um_s", velocity), ("is_interpolated", is_interpolated), ("time_s", times_s)):
        zarr.save_array(folder / "flow.zarr" / name, values)
    return folder / "flow.zarr"


def test_a_uniform_flow_has_its_own_velocity_as_mean_and_rms(tmp_path: Path) -> None:
    velocity = np.zeros((300, 2, 3, 4), np.float32)
    velocity[:, 0], velocity[:, 1] = 3.0, -4.0
    found = flow_moments(_write(tmp_path, velocity, np.zeros((300, 3, 4), bool)), up=(0.0, -1.0))
    assert np.allclose(found.mean_um_s, [3.0, 4.0])
    assert np.allclose(found.rms_um_s, [3.0, 4.0])
    assert np.array_equal(found.time_s, np.arange(300) * 0.5)


def test_directions_follow_gravity_and_not_the_image(tmp_path: Path) -> None:
    velocity = np.zeros((1, 2, 2, 2), np.float32)
    velocity[:, 0], velocity[:, 1] = 3.0, -4.0
    found = flow_moments(_write(tmp_path, velocity, np.zeros((1, 2, 2), bool)), up=(1.0, 0.0))
    assert np.allclose(found.mean_um_s, [[-4.0, 3.0]])


def test_interpolated_cells_do_not_count_and_a_step_without_others_has_no_value(tmp_path: Path) -> None:
    velocity = np.full((2, 2, 2, 2), 100.0, np.float32)
    velocity[0, :, 0, 0] = 1.0
    is_interpolated = np.ones((2, 2, 2), bool)
    is_interpolated[0, 0, 0] = False
    found = flow_moments(_write(tmp_path, velocity, is_interpolated), up=(0.0, -1.0))
    assert np.allclose(found.mean_um_s[0], [1.0, -1.0])
    assert np.isnan(found.mean_um_s[1]).all()
    assert np.isnan(found.rms_um_s[1]).all()


def test_a_folder_that_is_no_flow_field_is_an_error_that_names_it(tmp_path: Path) -> None:
    with pytest.raises(ResultsError, match="nothing"):
        flow_moments(tmp_path / "nothing", up=(0.0, -1.0))
