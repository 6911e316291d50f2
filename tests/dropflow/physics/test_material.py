import pytest

from dropflow.errors import ExperimentError
from dropflow.experiment import Experiment, FixedMaterial, parse_experiment
from dropflow.physics.material import resolve
from dropflow.physics.material_files import find_material, known_names


def experiment_of(material: object) -> Experiment:
    return parse_experiment(
        {"name": "a", "pixel_size_um": 0.6, "frame_interval_s": 1.0, "droplets": "bright", "material": material}
    )


def test_fixed_values_pass_through() -> None:
    given = {"delta_density_kg_m3": -60.0, "viscosity_pa_s": 0.002}
    assert resolve(experiment_of(given)) == FixedMaterial(**given)


def test_a_name_gives_the_numbers_of_its_file() -> None:
    assert resolve(experiment_of("air-in-water-25c")) == FixedMaterial(
        delta_density_kg_m3=-995.86, viscosity_pa_s=8.90e-4
    )


def test_an_unknown_name_is_an_error_on_the_field_that_lists_the_known_names() -> None:
    with pytest.raises(ExperimentError) as caught:
        resolve(experiment_of("unobtainium"))
    (problem,) = caught.value.fields
    assert problem.field == "material"
    assert "air-in-water-25c" in problem.message


@pytest.mark.parametrize("name", known_names())
def test_every_packaged_file_is_valid_and_named_as_its_file(name: str) -> None:
    assert find_material(name).name == name
