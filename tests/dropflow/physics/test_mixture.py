"""The appendix of the paper: viscosity of the mixture, and what else a material file says."""

import numpy as np
import pytest

from dropflow.errors import ExperimentError
from dropflow.experiment import Phase
from dropflow.physics.density import (
    ExcessVolume,
    ExpandingDensity,
    mixture_density_kg_m3,
    water_density_kg_m3,
)
from dropflow.physics.material import MixtureProperties, resolve_at
from dropflow.physics.material_files import MaterialFile, find_material
from dropflow.physics.material_report import describe
from dropflow.physics.response import response_time_s, stokes_number

NAME = "water-isobutoxyethanol-illustrative"


@pytest.fixture(scope="module")
def material() -> MaterialFile:
    return find_material(NAME)


@pytest.fixture(scope="module")
def properties(material: MaterialFile) -> MixtureProperties:
    return MixtureProperties(material)


def test_isobutoxyethanol_at_25_c_is_2_89_mpa_s(properties: MixtureProperties) -> None:
    assert properties.mixture.second.viscosity.at(25.0) == pytest.approx(2.89e-3, abs=0.005e-3)


def test_water_follows_the_international_standard_within_a_percent(properties: MixtureProperties) -> None:
    from iapws import IAPWS95

    for temperature_c in (20.0, 25.0, 40.0, 60.0):
        expected = IAPWS95(T=temperature_c + 273.15, P=0.101325).mu
        assert properties.mixture.first.viscosity.at(temperature_c) == pytest.approx(expected, rel=0.01)


def test_the_polynomial_has_the_stated_ends(properties: MixtureProperties) -> None:
    at_ends = properties.mixture.viscosity.at([0.0, 1.0])
    np.testing.assert_allclose(at_ends, [0.91e-3, 2.89e-3], rtol=1e-9)


def test_both_ends_of_the_interpolation_are_the_pure_fluids_within_the_fits_error(properties) -> None:
    water, organic = properties.viscosity_pa_s([0.0, 1.0], 25.0)
    assert water == pytest.approx(0.91e-3, abs=1e-6)
    assert properties.mixture.first.viscosity.at(25.0) == pytest.approx(0.890e-3, abs=1e-6)
    assert organic == pytest.approx(float(properties.mixture.second.viscosity.at(25.0)), rel=1e-3)


def test_the_mixture_is_most_viscous_at_three_quarters(properties: MixtureProperties) -> None:
    composition = np.linspace(0, 1, 2001)
    viscosity = properties.viscosity_pa_s(composition, 25.0)
    assert viscosity.max() == pytest.approx(3.91e-3, rel=0.01)
    assert 0.74 < composition[viscosity.argmax()] < 0.81


def test_the_papers_response_time_and_stokes_number() -> None:
    """36 us for r = 40 um where density over viscosity is 1.0e5 s/m2; far below 1e-5 of the flow's 30 s."""
    response_s = response_time_s(40.0, density_kg_m3=101.25, viscosity_pa_s=1e-3)
    assert response_s == pytest.approx(36e-6, rel=1e-3)
    assert stokes_number(response_s, 30.0) < 2e-6


def test_water_is_that_of_the_equation_of_state() -> None:
    np.testing.assert_allclose(water_density_kg_m3([4.0, 25.0, 51.3]), [999.97, 997.047, 987.45], atol=0.02)
    with pytest.raises(ExperimentError, match="water"):
        water_density_kg_m3(120.0)


def test_a_mixture_without_excess_adds_volumes_and_its_ends_are_the_pure_fluids() -> None:
    half = mixture_density_kg_m3([0.0, 0.5, 1.0], (1000.0, 500.0), (18.0, 118.0), None)
    np.testing.assert_allclose(half, [1000.0, 1000 / 1.5, 500.0])


def test_a_negative_excess_volume_makes_the_mixture_denser_by_its_share() -> None:
    excess = ExcessVolume(coefficients_cm3_mol=(-4.0,), source="test")
    mass_g, volume_cm3 = 0.5 * 18 + 0.5 * 90, 0.5 * 18 + 0.5 * 100
    composition = 0.5 * 90 / mass_g
    found = mixture_density_kg_m3(composition, (1000.0, 900.0), (18.0, 90.0), excess)
    assert found == pytest.approx(1e3 * mass_g / (volume_cm3 - 1.0))


def test_thermal_expansion_thins_a_fluid() -> None:
    fluid = ExpandingDensity(
        reference_kg_m3=900, reference_temperature_c=25, thermal_expansion_per_k=1e-3, source="test"
    )
    assert fluid.at(35.0) == pytest.approx(900 / 1.01)


def test_droplets_rise_in_the_bottom_phase_and_sink_in_the_top_phase(material: MaterialFile) -> None:
    bottom, top = (resolve_at(material, temperature_c=50.0, phase=phase) for phase in (Phase.BOTTOM, Phase.TOP))
    assert bottom.delta_density_kg_m3 == -top.delta_density_kg_m3 < 0
    assert bottom.viscosity_pa_s < top.viscosity_pa_s
    assert -bottom.delta_density_kg_m3 / bottom.viscosity_pa_s == pytest.approx(1.0e5, rel=0.15)


@pytest.mark.parametrize(
    "missing", ["binodal", "viscosity", "first.density", "second.viscosity", "first.molar_mass_g_mol"]
)
def test_a_property_that_the_file_lacks_is_named_when_it_is_needed(material: MaterialFile, missing: str) -> None:
    document = material.model_dump()
    *path, last = missing.split(".")
    inner = document["mixture"]
    for part in path:
        inner = inner[part]
    inner[last] = None
    with pytest.raises(ExperimentError, match=last.split("_")[0]) as caught:
        resolve_at(MaterialFile.model_validate(document), temperature_c=40.0, phase=Phase.BOTTOM)
    assert caught.value.code == "material.property_missing"


def test_a_report_says_value_unit_and_source_of_each_property_and_that_it_is_illustrative(material) -> None:
    report = describe(material, temperature_c=40.0, composition=0.3)
    assert report["is_illustrative"] is True
    assert {"density", "viscosity", "composition_bottom", "bottom_phase_delta_density"} <= set(report["properties"])
    assert all(set(entry) == {"value", "unit", "source"} for entry in report["properties"].values())
    assert "not measured" in material.label


def test_compositions_are_mass_fractions(properties: MixtureProperties) -> None:
    with pytest.raises(ExperimentError, match="0 to 1"):
        properties.viscosity_pa_s(1.2, 25.0)
