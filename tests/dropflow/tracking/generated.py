"""Droplets with known paths: random places, a flow of turning vortices, Stokes' law by radius. No images."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.droplets import Droplets
from dropflow.experiment import DropletTone, Experiment, FixedMaterial
from dropflow.physics.stokes import sedimentation_um_s

Floats = npt.NDArray[np.float64]
Flow = Callable[[Floats, Floats, float], Floats]
"""Velocity, shape (2, n), px/s, at x, y and time."""


def vortices(speed_px_s: float, size_px: float, *, drift_px_s: tuple[float, float] = (0.0, 0.0)) -> Flow:
    """A Taylor-Green flow of vortices `size_px` wide with the given greatest speed, plus drift."""

    def velocity(x_px: Floats, y_px: Floats, time_s: float) -> Floats:
        along, down = np.pi * x_px / size_px, np.pi * y_px / size_px
        swing = np.cos(2 * np.pi * time_s / 60)
        u = speed_px_s * np.sin(along) * np.cos(down) * swing + drift_px_s[0]
        v = -speed_px_s * np.cos(along) * np.sin(down) * swing + drift_px_s[1]
        return np.stack([u, v])

    return velocity


@dataclass(frozen=True)
class Film:
    """Detections of each frame, and which droplet each is (-1: none, a false detection)."""

    experiment: Experiment
    shape: tuple[int, int]
    times_s: Floats
    frames: list[Droplets]
    truth: list[npt.NDArray[np.int64]]

    def __call__(self, frame: int) -> Droplets:
        return self.frames[frame]


def experiment(delta_density_kg_m3: float = -20.0, pixel_size_um: float = 0.625) -> Experiment:
    """A film of the bottom phase: bright droplets that rise."""
    return Experiment(
        name="generated",
        pixel_size_um=pixel_size_um,
        frame_interval_s=1.0,
        droplets=DropletTone.BRIGHT,
        material=FixedMaterial(delta_density_kg_m3=delta_density_kg_m3, viscosity_pa_s=1e-3),
    )


def film(
    *,
    flow: Flow,
    n_frames: int = 12,
    n_droplets: int = 150,
    shape: tuple[int, int] = (512, 612),
    seed: int = 0,
    found_share: float = 1.0,
    n_false: int = 0,
    radius_error: float = 0.0,
    interval_s: float | Floats = 1.0,
    strength: Floats | None = None,
) -> Film:
    """Follow random droplets through `flow` and report those inside the frame, in a new order each time.

    `strength` says how many times stronger than at first they sediment in each frame, shape (n_frames,).
    """
    rng = np.random.default_rng(seed)
    about = experiment()
    height, width = shape
    times = np.concatenate([[0.0], np.cumsum(np.broadcast_to(interval_s, n_frames - 1))])
    n_around = 3 * n_droplets
    x, y = rng.uniform(-width / 2, 1.5 * width, n_around), rng.uniform(-height / 2, 1.5 * height, n_around)
    r = np.exp(rng.normal(np.log(6.0), 0.35, n_around))
    material = about.material
    assert isinstance(material, FixedMaterial)
    rise = sedimentation_um_s(r * about.pixel_size_um, **material.model_dump()) / about.pixel_size_um
    frames, truth = [], []
    for frame in range(n_frames):
        inside = (x >= 0) & (x < width) & (y >= 0) & (y < height) & (rng.uniform(size=n_around) < found_share)
        seen = rng.permutation(np.flatnonzero(inside))
        seen_r = r[seen] * np.exp(rng.normal(0, radius_error, len(seen)))
        false_x, false_y = rng.uniform(0, width, n_false), rng.uniform(0, height, n_false)
        false_r = np.exp(rng.normal(np.log(6.0), 0.35, n_false))
        droplets = _droplets(np.append(x[seen], false_x), np.append(y[seen], false_y), np.append(seen_r, false_r))
        frames.append(droplets)
        truth.append(np.append(seen, np.full(n_false, -1)))
        if frame + 1 < n_frames:
            now = rise if strength is None else rise * strength[frame]
            x, y = _moved(x, y, now, flow, times[frame], times[frame + 1])
    return Film(about, shape, times, frames, truth)


def _moved(x: Floats, y: Floats, rise: Floats, flow: Flow, start_s: float, end_s: float) -> tuple[Floats, Floats]:
    n_steps = 8
    dt_s = (end_s - start_s) / n_steps
    for step in range(n_steps):
        u, v = flow(x, y, start_s + step * dt_s)
        x, y = x + dt_s * u, y + dt_s * (v - rise)
    return x, y


def _droplets(x: Floats, y: Floats, r: Floats) -> Droplets:
    certain = np.ones(len(x))
    return Droplets(x, y, r, 0.1 * certain, 0.05 * r, certain, certain)


def droplets_at(places: npt.ArrayLike) -> Droplets:
    """Droplets from rows of x, y and r in px."""
    x, y, r = np.asarray(places, np.float64).reshape(-1, 3).T
    return _droplets(x, y, r)


def true_links(given: Film) -> set[tuple[int, int, int]]:
    """(frame, index there, index in the next frame) of each droplet seen in two frames running."""
    links = set()
    for frame, (here, there) in enumerate(zip(given.truth[:-1], given.truth[1:], strict=True)):
        _, first, second = np.intersect1d(here[here >= 0], there[there >= 0], return_indices=True)
        start, stop = np.flatnonzero(here >= 0)[first], np.flatnonzero(there >= 0)[second]
        links |= {(frame, int(one), int(other)) for one, other in zip(start, stop, strict=True)}
    return links
