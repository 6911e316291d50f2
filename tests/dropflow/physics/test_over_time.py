import numpy as np
import pytest

from dropflow.errors import ExperimentError
from dropflow.experiment import Experiment, parse_experiment
from dropflow.physics.material import resolve_at
from dropflow.physics.material_files import find_material
from dropflow.physics.over_time import check_material, material_over_time

MIXTURE = "water-isobutoxyethanol-illustrative"


def experiment(**more: object) -> Experiment:
    about = {"name": "ramp", "pixel_size_um": 0.6, "frame_interval_s": 1.0, "droplets": "bright", "material": MIXTURE}
    return parse_experiment(about | more)


@pytest.mark.parametrize("phase", ["bottom", "top"])
def test_each_frame_has_the_material_of_its_temperature(phase: str) -> None:
    about = experiment(phase=phase, temperature_log="log.csv")
    found = material_over_time(about, 3, [27.0, 35.0, 50.0])
    for frame, temperature_c in enumerate((27.0, 35.0, 50.0)):
        expected = resolve_at(find_material(MIXTURE), temperature_c=temperature_c, phase=about.phase)
        assert found.at(frame).delta_density_kg_m3 == pytest.approx(expected.delta_density_kg_m3)
        assert found.at(frame).viscosity_pa_s == pytest.approx(expected.viscosity_pa_s)
    assert not found.is_constant
    assert (np.sign(found.delta_density_kg_m3) == (-1 if phase == "bottom" else 1)).all()


def test_a_fixed_material_needs_neither_phase_nor_temperature() -> None:
    found = material_over_time(experiment(material="air-in-water-25c"), 4)
    assert found.is_constant
    assert found.mean == found.at(3)


@pytest.mark.parametrize(
    ("more", "fields"),
    [
        ({}, ["temperature_log", "phase"]),
        ({"phase": "top"}, ["temperature_log"]),
        ({"temperature_log": "l"}, ["phase"]),
    ],
)
def test_what_a_mixture_needs_is_named_before_there_is_a_film(more: dict[str, str], fields: list[str]) -> None:
    with pytest.raises(ExperimentError) as caught:
        check_material(experiment(**more))
    assert [problem.field for problem in caught.value.fields] == fields


@pytest.mark.parametrize("temperature_c", [25.0, 90.0])
def test_a_temperature_at_which_the_fluids_do_not_demix_names_its_frame(temperature_c: float) -> None:
    with pytest.raises(ExperimentError, match="range of the material") as caught:
        material_over_time(experiment(phase="top"), 3, [30.0, temperature_c, 31.0])
    assert (caught.value.frame, caught.value.fields[0].field) == (1, "temperature_log")
