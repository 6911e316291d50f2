from pathlib import Path

import numpy as np
import pytest

from dropflow.errors import ExperimentError
from dropflow.physics.material import MixtureProperties
from dropflow.physics.material_files import find_material
from dropflow.physics.ramp import temperature_ramp
from dropflow.physics.temperature_log import driving_from_log, read_temperature_log

HEAD = "time_s,temperature_c\n"


def written(folder: Path, text: str) -> Path:
    path = folder / "temperature.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("time_s,temperature_k\n0,300\n1,300\n", "temperature_k"),
        ("minutes,temperature_c\n0,30\n", "minutes"),
        ("", "none"),
        (HEAD + "0,30\n", "two entries"),
        (HEAD + "0,30\n5,31\n5,32\n", "line 4"),
        (HEAD + "0,30\n9,31\n5,32\n", "line 4"),
        (HEAD + "0,30\n10,30\n900,31\n", "gap of 890 s"),
        (HEAD + "0,300\n1,301\n", "kelvin"),
        (HEAD + "0,warm\n1,30\n", "not a number"),
        (HEAD + "0,nan\n1,30\n", "finite"),
        (HEAD + "0\n1,30\n", "not a number"),
    ],
)
def test_a_bad_log_is_an_error_on_its_field_that_says_what_is_wrong(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(ExperimentError, match=says) as caught:
        read_temperature_log(written(tmp_path, text))
    assert [problem.field for problem in caught.value.fields] == ["temperature_log"]


def test_a_log_is_linear_between_entries_and_ends_where_it_ends(tmp_path: Path) -> None:
    log = read_temperature_log(written(tmp_path, HEAD + "0,30\n10,31\n20,31.5\n"))
    np.testing.assert_allclose(log.at([5.0, 15.0]), [30.5, 31.25])
    with pytest.raises(ExperimentError, match=r"covers 0 to 20.*frame_interval_s"):
        log.at([25.0])


def test_the_driving_of_a_ramp_comes_back_from_its_noisy_log(tmp_path: Path) -> None:
    """A thermometer with 5 mK of noise, and windows of an hour: each within 4 of its standard errors."""
    binodal = MixtureProperties(find_material("water-isobutoxyethanol-illustrative")).binodal
    ramp = temperature_ramp(binodal, driving_per_s=1e-4)
    rng = np.random.default_rng(5)
    seconds = np.arange(0, ramp.duration_s, 10.0)
    noisy = ramp.at(seconds) + rng.normal(0, 0.005, len(seconds))
    lines = "".join(f"{t},{value:.4f}\n" for t, value in zip(seconds, noisy, strict=True))
    driving = driving_from_log(read_temperature_log(written(tmp_path, HEAD + lines)), binodal, window_s=1200.0)
    assert len(driving.time_s) == pytest.approx(ramp.duration_s / 1200, abs=1)
    off = np.abs(driving.driving_per_s - 1e-4)
    assert (off < 4 * driving.driving_std_per_s + 1e-6).all()
    assert driving.driving_per_s.mean() == pytest.approx(1e-4, rel=0.02)
