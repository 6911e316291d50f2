"""What the page draws its forms from."""

from tests.house import House


def test_the_form_of_an_experiment_has_units_meanings_and_known_materials(house: House) -> None:
    schema = house.ok(house.api.get("schemas/experiment"))
    assert "micrometres" in schema["properties"]["pixel_size_um"]["description"]
    assert set(schema["required"]) >= {"name", "pixel_size_um", "droplets", "material"}
    (names,) = [choice["examples"] for choice in schema["properties"]["material"]["oneOf"] if "examples" in choice]
    assert names
    house.experiment(material=names[0])


def test_the_form_of_parameters_has_defaults_ranges_units_and_the_paper_s_values(house: House) -> None:
    schema = house.ok(house.api.get("schemas/parameters"))
    radius = schema["$defs"]["DetectionParameters"]["properties"]["radius_min_um"]
    assert (radius["default"], radius["unit"], radius["paper_value"], radius["minimum"]) == (4.0, "um", 4.0, 1e-3)
