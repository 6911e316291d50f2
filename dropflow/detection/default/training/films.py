"""Scenes from simulated films with constants drawn anew."""

from typing import Any

import numpy as np

from dropflow.detection.default.training.scenes import Scene
from dropflow.simulation.film import Film
from dropflow.simulation.render import Renderer
from dropflow.simulation.scenario import SCENARIOS, changed, vary

HEIGHT_PX, WIDTH_PX = 800, 1000
_SEED = 0xD0
EDGE_INSIDE = 0.85
"""How far inside the radius a blurred sphere is steepest, in standard deviations of its blur; .7 to 1.1 as measured."""


def film_scene(seed: int) -> Scene:
    """First frame of a varied film; scenarios take turns. A third is seen at another magnification."""
    rng = np.random.default_rng([_SEED, seed])
    scenario = vary(list(SCENARIOS.values())[seed % len(SCENARIOS)], rng)
    changes: dict[str, Any] = {"height_px": HEIGHT_PX, "width_px": WIDTH_PX}
    if rng.random() < 1 / 3:
        zoom = float(np.exp(rng.uniform(np.log(0.4), np.log(1.6))))
        changes |= {
            "pixel_size_um": scenario.pixel_size_um / zoom,
            "point_spread_px": max(0.5, scenario.point_spread_px * min(zoom, 1.0)),
            "defocus_px_per_um": scenario.defocus_px_per_um * zoom,
            # As many droplets in the picture, within bounds that leave it readable.
            "n_droplets": scenario.n_droplets * float(np.clip(1 / zoom, 0.7, 2.0)),
            "margin_um": 100.0,
        }
    scenario = changed(scenario, changes)
    film = Film(scenario, seed + 10_000)
    moment = next(film.moments(1))
    renderer = Renderer(scenario, film.seed)
    truth = moment.truth(scenario).to_pydict()
    r_px = np.array(truth["r_px"])
    return Scene(
        family=scenario.name,
        frame=renderer.frame(moment.cloud, 0),
        flat_field=renderer.flat_field(),
        tone=scenario.droplets,
        r_min_px=scenario.radius_min_um / scenario.pixel_size_um,
        r_max_px=scenario.radius_max_um / scenario.pixel_size_um,
        x_px=np.array(truth["x_px"]),
        y_px=np.array(truth["y_px"]),
        r_px=r_px,
        visibility=np.array(truth["visibility"], dtype=str),
        # A sphere's brightness falls as a square root at its edge: its blur moves the steepest place inwards.
        edge_px=np.maximum(r_px - EDGE_INSIDE * np.array(truth["blur_px"]), 0.5 * r_px),
    )
