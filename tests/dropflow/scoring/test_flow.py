from pathlib import Path

import numpy as np
import pytest

from dropflow.errors import ResultsError
from dropflow.scoring import FlowSteps, read_flow, score_flow
from dropflow.simulation.film import Film
from dropflow.simulation.write import write_experiment
from tests.dropflow.simulation.scenes import small


def _steps(velocity: np.ndarray, *, is_interpolated: np.ndarray | None = None, extent_px: float = 100.0) -> FlowSteps:
    n_steps, _, rows, columns = velocity.shape
    no = np.zeros((n_steps, rows, columns), bool)
    y, x = ((np.arange(n) + 0.5) * extent_px / n for n in (rows, columns))
    return FlowSteps(velocity, no if is_interpolated is None else is_interpolated, x, y)


def _waves(rows: int = 10, columns: int = 12) -> FlowSteps:
    y, x = ((np.arange(n) + 0.5) * 100.0 / n for n in (rows, columns))
    u = np.sin(x[None] / 30) * np.cos(y[:, None] / 40)
    return _steps(np.stack([np.stack([u, 2 * u + 5.0]), np.stack([-u, u])]) * 4.0)


def test_the_truth_itself_has_no_error() -> None:
    score = score_flow(_waves(), _waves())
    assert (score.error_over_rms, score.computed_error_over_rms, score.computed_share) == (0, 0, 1)


def test_the_error_is_the_rms_of_the_vector_over_that_of_the_truth() -> None:
    true = _steps(np.full((3, 2, 4, 5), 3.0))
    found = _steps(np.full((3, 2, 4, 5), 3.0) + np.array([0.3, -0.4])[None, :, None, None])
    score = score_flow(found, true)
    assert score.rms_um_s == pytest.approx(3 * np.sqrt(2))
    assert score.error_um_s == pytest.approx(0.5)
    assert score.error_over_rms == pytest.approx(0.5 / (3 * np.sqrt(2)))
    assert score.error_over_fluctuation is None


def test_the_drift_counts_in_the_rms_but_not_in_the_fluctuation() -> None:
    zero = _steps(np.zeros((2, 2, 10, 12)))
    score = score_flow(zero, _waves())
    assert score.error_over_rms == pytest.approx(1)
    assert score.error_over_fluctuation > 1.2


def test_cells_that_were_computed_are_told_apart() -> None:
    true = _waves()
    wrong = true.velocity_um_s.copy()
    wrong[:, :, :5] += 7.0
    is_interpolated = np.zeros((2, 10, 12), bool)
    is_interpolated[:, :5] = True
    score = score_flow(_steps(wrong, is_interpolated=is_interpolated), true)
    assert score.computed_error_over_rms == 0
    assert score.computed_share == 0.5
    assert score.error_um_s == pytest.approx(7.0)


def test_a_step_without_a_value_counts_as_no_flow() -> None:
    true = _waves()
    unknown = true.velocity_um_s.copy()
    unknown[1] = np.nan
    error = score_flow(_steps(unknown, is_interpolated=np.ones((2, 10, 12), bool)), true)
    assert error.error_um_s == pytest.approx(np.sqrt(np.mean(np.sum(true.velocity_um_s[1] ** 2, axis=0)) / 2))
    assert error.computed_error_over_rms is None


def test_grids_of_another_size_are_compared_at_the_places_of_the_result() -> None:
    assert score_flow(_waves(7, 5), _waves(40, 40)).error_over_rms < 0.01


def test_flow_files_are_read_as_simulated(tmp_path: Path) -> None:
    film = Film(small(n_rows=5, n_columns=6), seed=0)
    write_experiment(tmp_path / "film", film, 3, with_images=False)
    steps = read_flow(tmp_path / "film" / "truth_flow.zarr")
    assert steps.velocity_um_s.shape == (2, 2, 5, 6)
    assert score_flow(steps, steps).error_over_rms == 0


def test_a_folder_that_is_no_flow_field_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ResultsError, match="no flow field"):
        read_flow(tmp_path)
