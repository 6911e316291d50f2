"""Periods of several experiments against what drives them."""

import shutil
import sys
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from dropflow.cli import main
from dropflow.results import open_results
from dropflow.statistics.comparison import DrivenPeriods, LeftOut, driven_periods, law_of, table_of
from dropflow.statistics.findings import Findings
from tests.dropflow.report.conftest import WAVES, results_folder, short_results

__all__ = ["results_folder", "short_results"]


def made(exponent: float, n_experiments: int = 6, scatter: float = 0.0) -> list[DrivenPeriods]:
    rng = np.random.default_rng(1)
    drivings = np.geomspace(3e-6, 4e-4, n_experiments)
    return [
        DrivenPeriods(str(xi), float(xi), 5.0 * xi**exponent * np.exp(rng.normal(0, scatter, 5)), np.ones(5))
        for xi in drivings
    ]


def test_the_exponent_put_in_comes_back_with_its_error() -> None:
    assert law_of(made(-3 / 7)).exponent == pytest.approx(-3 / 7)
    noisy = law_of(made(-0.5, n_experiments=12, scatter=0.2))
    assert abs(noisy.exponent + 0.5) < 4 * noisy.exponent_std < 0.3
    assert np.isnan(law_of([]).exponent)
    assert table_of(made(-0.5))["group"].to_list()[::5] == sorted(table_of(made(-0.5))["group"].to_list()[::5])


def test_an_experiment_without_driving_or_oscillations_is_left_out_with_the_reason(
    results_folder: Path, short_results: Path
) -> None:
    whole, short = (open_results(path) for path in (results_folder, short_results))
    unknown = driven_periods("a", Findings(whole.facts, whole.condensed))
    still = driven_periods("b", Findings(short.facts, short.condensed), driving_per_s=1e-5)
    assert isinstance(unknown, LeftOut)
    assert "temperature log" in unknown.reason
    assert isinstance(still, LeftOut)
    assert "oscillations" in still.reason


def test_the_command_draws_what_it_found_and_says_what_it_left_out(
    results_folder: Path, short_results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    shutil.copytree(results_folder, tmp_path / "waves")
    shutil.copytree(short_results, tmp_path / "still")
    folders = [str(tmp_path / name) for name in ("waves", "still")]
    written = ["-o", str(tmp_path / "p.html"), "--table", str(tmp_path / "p.csv")]
    monkeypatch.setattr(sys, "argv", ["dropflow", "periods", *folders, "--xi", "1e-5", "--xi", "2e-5", *written])
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    assert "left out: still" in capsys.readouterr().err
    assert (tmp_path / "p.html").stat().st_size > 1e6
    found = pl.read_csv(tmp_path / "p.csv")
    np.testing.assert_allclose(found["period_s"].median(), np.median(np.diff(WAVES.starts_s[1:5])), rtol=0.3)
