"""The films: simulated ones with unseen seeds, and droplets on the exact paths of a direct numerical simulation."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow.parquet as pq
from scipy.interpolate import RBFInterpolator

from dropflow.physics.stokes import sedimentation_um_s
from dropflow.scoring.links import links_of
from dropflow.simulation.cloud import Cloud, Origin
from dropflow.simulation.film import Film
from dropflow.simulation.scenario import FULL_HEIGHT_PX, FULL_WIDTH_PX, Scenario, changed, named_scenario
from dropflow.simulation.write import render_positions, write_experiment

Floats = npt.NDArray[np.float64]

SHAPE = (FULL_HEIGHT_PX, FULL_WIDTH_PX)
_UNIT_UM = FULL_WIDTH_PX * 0.625
"""Edge of the cube of the direct numerical simulation: it fills the width of the frame."""
N_NEAREST = 60
"""Tracers from which the true flow between them is interpolated."""


def simulated(folder: Path, name: str, seed: int, n_frames: int, *, with_images: bool, **changes: float) -> Path:
    """A film of a scenario; one that is there already is taken."""
    words = [name, str(seed), str(n_frames), *(f"{key}-{value:g}" for key, value in changes.items())]
    film = folder / "_".join([*words, "images" if with_images else "tables"])
    if not film.exists():
        scenario = changed(named_scenario(name), changes)
        write_experiment(film, Film(scenario, seed), n_frames, with_images=with_images)
    return film


def convection(folder: Path, tracers: Path, *, with_images: bool) -> Path:
    """Droplets on the paths of tracers in convection, each with its Stokes drift from the middle of the film on."""
    film = folder / f"convection_{'images' if with_images else 'tables'}"
    if not film.exists():
        particles = np.load(tracers)["particles"].astype(np.float64)
        scenario = changed(named_scenario("easy"), {"name": "convection", "delta_density_kg_m3": -15.0})
        scenario = changed(scenario, {"frame_interval_s": 1.0})
        n_frames = len(particles)
        clouds = _clouds(particles, scenario)
        flow = _PlaneFlow(particles, scenario)
        render_positions(film, scenario, clouds, n_frames, seed=3, flow_at=flow, with_images=with_images)
    return film


def _clouds(particles: Floats, scenario: Scenario) -> Iterator[Cloud]:
    """Z of the simulation is up, y becomes the depth."""
    n = particles.shape[1]
    rng = np.random.default_rng(3)
    radii = np.exp(rng.normal(np.log(scenario.radius_median_um), scenario.radius_spread, n))
    r_um = np.clip(radii, scenario.radius_min_um, scenario.radius_max_um)
    rise = sedimentation_um_s(
        r_um, delta_density_kg_m3=scenario.delta_density_kg_m3, viscosity_pa_s=scenario.viscosity_pa_s
    )
    interval_s = scenario.frame_interval_s
    origin = np.full(n, int(Origin.START), np.int8)
    for frame, places in enumerate(particles):
        x_um, y_um, z_um = _in_frame(places)
        y_um = y_um - rise * interval_s * (frame - (len(particles) - 1) / 2)
        yield Cloud(np.arange(n), x_um, y_um, z_um, r_um, origin)


def _in_frame(places: Floats) -> tuple[Floats, Floats, Floats]:
    height_um = FULL_HEIGHT_PX * 0.625
    up, depth, x = places[:, 0], places[:, 1], places[:, 2]
    return x * _UNIT_UM, height_um / 2 - (up - 0.5) * _UNIT_UM, (depth - 0.5) * _UNIT_UM


class _PlaneFlow:
    """The flow in the focal plane, from the displacements of all tracers around it."""

    def __init__(self, particles: Floats, scenario: Scenario) -> None:
        self._particles, self._scenario = particles, scenario
        grid = scenario.grid
        x_um, y_um = (part.ravel() * scenario.pixel_size_um for part in np.meshgrid(grid.x_px, grid.y_px))
        self._at = np.column_stack([x_um, y_um, np.zeros(x_um.size)])

    def __call__(self, time_s: float) -> Floats:
        interval_s = self._scenario.frame_interval_s
        frame = int(time_s / interval_s)
        here, there = (np.column_stack(_in_frame(self._particles[k])) for k in (frame, frame + 1))
        values = ((there - here) / interval_s)[:, :2]
        flow = RBFInterpolator((here + there) / 2, values, neighbors=N_NEAREST)(self._at)
        grid = self._scenario.grid
        return np.asarray(flow.T.reshape(2, grid.n_rows, grid.n_columns))


def spacing_over_displacement(film: Path) -> float:
    """Mean spacing of visible droplets over the mean displacement between frames."""
    truth = pq.read_table(film / "truth.parquet")
    truth = truth.filter(truth["visibility"].to_numpy(zero_copy_only=False) == "visible")
    first, second = links_of(truth["droplet_id"].to_numpy(), truth["frame"].to_numpy())
    x, y = truth["x_px"].to_numpy(), truth["y_px"].to_numpy()
    displacement = np.hypot(x[second] - x[first], y[second] - y[first]).mean()
    n_frames = int(truth["frame"].to_numpy().max()) + 1
    return float(np.sqrt(SHAPE[0] * SHAPE[1] * n_frames / len(truth)) / displacement)
