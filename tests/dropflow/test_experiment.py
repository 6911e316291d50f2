"""experiment.yaml: what it may say, and how it says what is wrong."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from dropflow.errors import ExperimentError, ParametersError
from dropflow.experiment import FixedMaterial, load_experiment, parse_experiment
from dropflow.parameters import Parameters, parse_parameters

GOOD: dict[str, Any] = {
    "name": "bottom phase, xi = 1.05e-5 1/s",
    "pixel_size_um": 0.625,
    "frame_interval_s": 1.0,
    "droplets": "bright",
    "phase": "bottom",
    "material": {"delta_density_kg_m3": -50.0, "viscosity_pa_s": 1e-3},
}


def wrong_fields(**changes: Any) -> list[str]:
    """The fields named in the error that the good document with these changes raises (None removes a field)."""
    content = {key: value for key, value in (GOOD | changes).items() if value is not None}
    with pytest.raises(ExperimentError) as raised:
        parse_experiment(content)
    assert raised.value.code == "experiment.invalid"
    return [problem.field for problem in raised.value.fields]


def test_a_good_document_is_read_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "experiment.yaml"
    path.write_text(yaml.safe_dump(GOOD))
    experiment = load_experiment(path)
    assert experiment.up == (0.0, -1.0)
    assert experiment.material == FixedMaterial(delta_density_kg_m3=-50.0, viscosity_pa_s=1e-3)


@pytest.mark.parametrize("field", ["name", "pixel_size_um", "droplets", "material"])
def test_a_missing_field_is_named(field: str) -> None:
    assert wrong_fields(**{field: None}) == [field]


@pytest.mark.parametrize("value", [0, -1.0, True, "wide", float("nan"), float("inf")])
@pytest.mark.parametrize("field", ["pixel_size_um", "frame_interval_s"])
def test_zero_negative_and_words_are_no_lengths_or_times(field: str, value: Any) -> None:
    assert wrong_fields(**{field: value}) == [field]


def test_a_viscosity_of_zero_is_named_with_its_place() -> None:
    assert wrong_fields(material={"delta_density_kg_m3": 1.0, "viscosity_pa_s": 0}) == ["material.viscosity_pa_s"]


def test_unknown_fields_are_errors_at_any_depth() -> None:
    assert wrong_fields(pixel_size_mm=1.0) == ["pixel_size_mm"]
    assert "material.colour" in wrong_fields(material={**GOOD["material"], "colour": "red"})


def test_time_comes_from_exactly_one_place() -> None:
    assert wrong_fields(frame_interval_s=None) == ["frame_interval_s"]
    assert wrong_fields(timestamps="times.csv") == ["frame_interval_s"]


def test_up_must_be_a_direction() -> None:
    assert wrong_fields(up=[0, 0]) == ["up"]
    assert parse_experiment(GOOD | {"up": [0, 3]}).up == (0.0, 1.0)


def test_what_is_no_yaml_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "experiment.yaml"
    path.write_text("name: [unclosed")
    with pytest.raises(ExperimentError) as raised:
        load_experiment(path)
    assert "\n" not in str(raised.value)


def test_parameters_have_defaults_and_name_what_is_wrong() -> None:
    assert parse_parameters({}) == Parameters()
    with pytest.raises(ParametersError) as raised:
        parse_parameters({"detection": {"radius_min_um": 50, "radius_max_um": 40}, "flow": {"n_rows": 1}})
    assert {problem.field for problem in raised.value.fields} == {"detection.radius_min_um", "flow.n_rows"}


def test_every_number_among_the_parameters_says_its_unit_and_meaning() -> None:
    definitions = Parameters.model_json_schema()["$defs"]
    for definition in definitions.values():
        for name, field in definition.get("properties", {}).items():
            assert field.get("description") or "$ref" in field, name
            if field.get("type") in {"number", "integer"}:
                assert {"unit", "paper_value", "minimum", "maximum"} <= field.keys(), name


@pytest.mark.parametrize("phase", ["bottom", "top"])
def test_both_phases_of_the_paper_are_examples(phase: str) -> None:
    experiment = load_experiment(Path(__file__).parents[2] / "examples" / f"{phase}-phase.yaml")
    assert experiment.phase == phase
    assert isinstance(experiment.material, FixedMaterial)
    assert (experiment.material.delta_density_kg_m3 < 0) == (phase == "bottom")
