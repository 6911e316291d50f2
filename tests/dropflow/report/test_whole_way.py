"""From simulated frames of nucleation waves to the report: the whole way that a user goes."""

import sys
from pathlib import Path

import numpy as np
import pytest

from dropflow.cli import main
from dropflow.results import open_results
from dropflow.simulation.oscillating import OSCILLATING, Waves, write_oscillating
from dropflow.simulation.scenario import changed
from dropflow.statistics.findings import Findings


@pytest.mark.slow
def test_waves_put_into_frames_come_out_of_the_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Periods within 4 of their errors, drho/eta within 4 and 5 %, growth of droplets of 8 to 14 um within 30 %."""
    waves = Waves(n_waves=4, period_s=40.0, growth_um_s=0.3)
    scenario = changed(OSCILLATING, {"height_px": 512, "width_px": 612, "n_droplets": 900})
    film, results = tmp_path / "film", tmp_path / "results"
    write_oscillating(film, scenario=scenario, waves=waves, seed=3)
    words = ["analyse", str(film / "frames"), "--experiment", str(film / "experiment.yaml"), "--output", str(results)]
    other = ["--frame", "20", "--stack", str(film / "frames")]
    for command in (
        [*words, "--jobs", "1"],
        ["report", str(results), "-o", str(tmp_path / "report.html")],
        ["report", str(results), "-o", str(tmp_path / "other.html"), *other],
    ):
        monkeypatch.setattr(sys, "argv", ["dropflow", *command])
        with pytest.raises(SystemExit) as ended:
            main()
        assert not ended.value.code
    assert (tmp_path / "report.html").stat().st_size > 1e6
    assert "Frame 20, from" in (tmp_path / "other.html").read_text()
    opened = open_results(results)
    found = Findings(opened.facts, opened.condensed)
    true_s = np.diff(waves.starts_s[1:5])
    assert len(found.oscillations.period_s) == len(true_s)
    assert (np.abs(found.oscillations.period_s - true_s) < 4 * found.oscillations.period_std_s).all()
    expected = found.calibration.expected_s_m2
    off = abs(found.calibration.density_over_viscosity_s_m2 - expected)
    assert off < max(4 * found.calibration.std_s_m2, 0.05 * abs(expected))
    middle = (found.growth.rate.x > 8) & (found.growth.rate.x < 14) & (found.growth.rate.n > 10)
    assert found.growth.rate.mean[middle].mean() == pytest.approx(0.3, rel=0.3)
