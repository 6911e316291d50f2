import numpy as np
import pytest

from dropflow.errors import ParametersError
from dropflow.experiment import Phase
from dropflow.simulation.film import Film
from dropflow.simulation.render import Renderer
from dropflow.simulation.scenario import DARK, DENSE, EASY, SCENARIOS, Scenario, changed, named_scenario, vary
from tests.dropflow.simulation.scenes import small


def test_the_scenarios_are_those_of_the_docs() -> None:
    assert {name: s.n_droplets for name, s in SCENARIOS.items()} == {
        "easy": 200,
        "fast": 500,
        "dirty": 500,
        "dense": 1000,
        "dark": 500,
    }
    assert all((s.height_px, s.width_px, s.pixel_size_um) == (2058, 2448, 0.625) for s in SCENARIOS.values())
    assert all((s.flow_length_um, s.flow_time_s) == (200, 30) for s in SCENARIOS.values())
    assert all((s.radius_min_um, s.radius_max_um) == (4, 40) for s in SCENARIOS.values())


def test_an_unknown_scenario_is_an_error_that_lists_those_there_are() -> None:
    with pytest.raises(ParametersError, match="scenario: there is no 'misty'; choose one of easy, dense"):
        named_scenario("misty")


@pytest.mark.parametrize(
    ("constants", "message"),
    [
        ({"opacity": 1.5}, "opacity: "),
        ({"bit_depth": 10}, "bit_depth: "),
        ({"viscosity_pa_s": 0}, "viscosity_pa_s: "),
        ({"flow_rms_um_s": float("nan")}, "flow_rms_um_s: "),
        ({"fog": 1}, "fog: "),
        ({"radius_min_um": 50}, "radius_min_um must be smaller"),
        ({"radius_max_um": 90}, "margin_um must be at least"),
    ],
)
def test_impossible_constants_are_errors_that_name_the_field(constants: dict[str, float], message: str) -> None:
    with pytest.raises(ParametersError, match=message):
        changed(EASY, constants)


def test_every_constant_says_what_it_is() -> None:
    assert [name for name, field in Scenario.model_fields.items() if not field.description] == []


def test_the_dark_scenario_is_the_papers_top_phase() -> None:
    experiment = DARK.experiment(seed=1)
    assert experiment.phase is Phase.TOP
    assert experiment.droplets == "dark"
    assert experiment.material.delta_density_kg_m3 > 0
    assert EASY.experiment(seed=1).material.delta_density_kg_m3 < 0


def test_variations_keep_motion_and_material_and_change_the_picture() -> None:
    rng = np.random.default_rng(0)
    drawn = [vary(DENSE, rng) for _ in range(20)]
    for scenario in drawn:
        assert (scenario.flow_rms_um_s, scenario.delta_density_kg_m3) == (8.0, -30.0)
    for name in ("opacity", "point_spread_px", "sheet_sigma_um", "electrons_per_level", "n_droplets", "gradient"):
        assert len({getattr(scenario, name) for scenario in drawn}) == 20
    assert {scenario.bit_depth for scenario in drawn} == {8, 12, 16}


@pytest.mark.parametrize("name", SCENARIOS)
def test_variations_of_every_scenario_can_be_filmed(name: str) -> None:
    for seed in range(4):
        scenario = small(vary(SCENARIOS[name], np.random.default_rng(seed)))
        frame = Renderer(scenario, seed).frame(next(Film(scenario, seed).moments(1)).cloud, 0)
        assert np.ptp(frame) > 0
        assert np.mean(frame == 2**scenario.bit_depth - 1) < 0.02


def test_the_same_seed_varies_in_the_same_way() -> None:
    assert vary(EASY, np.random.default_rng(3)) == vary(EASY, np.random.default_rng(3))
