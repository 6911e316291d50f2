"""Seconds of linking with flow beside trackpy's linking alone, and how right the links are, on the same droplets."""

import shutil
import tempfile
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import trackpy

from benchmarks.tracking import peers
from benchmarks.tracking.films import SHAPE, simulated
from benchmarks.tracking.given import Given, true_droplets
from benchmarks.tracking.limited import within
from benchmarks.tracking.scores import DEFAULT, PAPER, score
from dropflow.analysis import detect, open_film
from dropflow.droplets import Droplets
from dropflow.experiment import Experiment, load_experiment, parse_experiment
from dropflow.frames import Choice, open_frames
from dropflow.parameters import Parameters
from dropflow.pipeline import track_film as track_images
from dropflow.progress import silent
from dropflow.tracking.film import Film
from dropflow.tracking.track import track_film

_FIRST_FRAMES = _IMAGE_FRAMES = 12
_PLAIN_RANGE = 0.5
"""Search range of `trackpy.link`, in spacings; with more it raises SubnetOversize in this film."""
_PREDICTING_RANGE = 0.75
"""That with which trackpy's best predictor has the most right links in it."""
_LIMIT_S = 60
"""After which a peer is not waited for any longer."""
SIZES = (500, 2000, 8000, 20_000)
"""Droplets a frame; the frame grows with them."""


def seconds(given: Given, parameters: Parameters) -> float:
    """CPU seconds of tracking with flow, without images."""
    with tempfile.TemporaryDirectory() as folder:
        return _tracked(given, parameters, Path(folder))[0]


def seconds_of_trackpy(given: Given) -> float:
    """CPU seconds of `trackpy.link` with a search range of half a spacing."""
    return _linked(given, peers.trackpy_plain, _PLAIN_RANGE)[0]


def _tracked(given: Given, parameters: Parameters, folder: Path) -> tuple[float, pa.Table]:
    """CPU seconds of Dropflow, and its trajectories."""
    film = Film(given.times_s, lambda frame: given.droplets[frame], None, None)
    start = time.process_time()
    result = track_film(film, given.shape, given.experiment, parameters, folder, {}, silent)
    return time.process_time() - start, pq.read_table(result.trajectories)


def _linked(given: Given, link: peers.Linker, range_spacings: float) -> tuple[float, pa.Table]:
    """CPU seconds of a peer, and its trajectories."""
    trackpy.quiet()
    droplets = peers.points(given)
    start = time.process_time()
    ids = link(droplets, range_spacings * given.spacing_px)
    return time.process_time() - start, peers.trajectories(given, ids.to_numpy())


def print_beside_trackpy(scratch: Path, n_frames: int) -> None:
    """Each linker's time on one film and how right its links are, beside trackpy's time."""
    given = true_droplets(simulated(scratch, "fast", 5, n_frames, with_images=False), SHAPE)
    seconds(first(given, _FIRST_FRAMES), DEFAULT)
    seconds_of_trackpy(first(given, _FIRST_FRAMES))
    per_frame = np.mean([len(some) for some in given.droplets])
    print(f"{n_frames} frames x {per_frame:.0f} droplets: links alone (trackpy), or with the flow and its error")
    print(f"  {'':<38} {'CPU s':>7} {'ms/frame':>8} {'links':>13} {'F1':>5}  x plain, x predicting trackpy")
    with tempfile.TemporaryDirectory() as folder:
        plain = _linked(given, peers.trackpy_plain, _PLAIN_RANGE)
        predicting = _linked(given, peers.trackpy_velocity, _PREDICTING_RANGE)
        for label, (spent, found) in (
            (f"trackpy.link, {_PLAIN_RANGE} spacings", plain),
            (f"  NearestVelocityPredict, {_PREDICTING_RANGE} spacings", predicting),
            ("dropflow", _tracked(given, DEFAULT, Path(folder) / "default")),
            ("  the paper's mode", _tracked(given, PAPER, Path(folder) / "paper")),
        ):
            scores = score(given, found)
            links = f"{scores.links.precision or 0:.3f} / {scores.links.recall or 0:.3f}"
            ratios = f"{spent / plain[0]:7.2f} {spent / predicting[0]:8.2f}"
            rate = f"{spent:7.2f} {1000 * spent / n_frames:8.2f}"
            print(f"  {label:<38} {rate} {links:>13} {scores.f1:5.3f}  {ratios}", flush=True)


def print_images(scratch: Path, n_frames: int) -> None:
    """The sequential stage with its images, of films whose droplets were detected before."""
    print(f"\nTracking with images of 5 megapixels, {n_frames} frames, forward and back")
    for name in ("fast", "dirty"):
        film = simulated(scratch, name, 5, n_frames, with_images=True)
        experiment, parameters = load_experiment(film / "experiment.yaml"), Parameters()
        opened = open_film(film / "frames", experiment, parameters, beside=film)
        table = film / "droplets.parquet"
        detect(opened, table, n_processes=1)
        shutil.rmtree(film / "results", ignore_errors=True)  # of another time, which would not be done again
        with open_frames(opened.source, Choice.of(experiment)) as frames:
            cpu, wall = time.process_time(), time.perf_counter()
            track_images(
                frames, opened.index, experiment, parameters, opened.measured, droplets=table, folder=film / "results"
            )
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        print(f"  {name:<6} {n_frames / cpu:5.1f} frames a CPU second, {n_frames / wall:5.1f} frames/s", flush=True)


def first(given: Given, n_frames: int) -> Given:
    """The beginning of a film."""
    return Given(given.film, given.droplets[:n_frames], given.experiment, given.shape)


def many(n: int, n_frames: int) -> Given:
    """`n` droplets a frame that turn and sediment, with the spacing of the scenario `fast`, moving by half of it."""
    rng = np.random.default_rng(n)
    side = int(100 * np.sqrt(n))
    x, y = rng.uniform(0, side, (2, n))
    r = np.clip(np.exp(rng.normal(np.log(10), 0.4, n)), 4, 50)
    droplets, sure = [], np.ones(n)
    for _ in range(n_frames):
        droplets.append(Droplets(x, y, r * np.exp(rng.normal(0, 0.03, n)), 0.15 * sure, 0.03 * r, sure, sure))
        x = np.mod(x + 40 * np.sin(2 * np.pi * y / side), side)
        y = np.mod(y - 0.05 * r**2 + 30 * np.cos(2 * np.pi * x / side), side)
    return Given(Path(), droplets, _still_water(), (side, side))


def _still_water() -> Experiment:
    material = {"delta_density_kg_m3": -36.6, "viscosity_pa_s": 1e-3}
    return parse_experiment(
        {"name": "many", "pixel_size_um": 0.625, "frame_interval_s": 1.0, "droplets": "bright", "material": material}
    )


def print_table(scratch: Path, n_frames: int) -> None:
    """Linking beside trackpy, growth with the number of droplets, and the stage with its images."""
    print_beside_trackpy(scratch, n_frames)
    print("\nGrowth with the number of droplets, 4 frames, CPU s")
    for n in SIZES:
        some = many(n, 4)
        spent = seconds(some, DEFAULT)
        print(f"  {n:>6} droplets: dropflow {spent:6.2f} ({1e6 * spent / (3 * n):.0f} us a droplet and step), ", end="")
        try:
            reference = within(_LIMIT_S, seconds_of_trackpy, some)
        except trackpy.linking.utils.SubnetOversizeException:
            print("trackpy SubnetOversize", flush=True)
        else:
            print(f"trackpy {f'not ended in {_LIMIT_S} s' if reference is None else f'{reference:.2f}'}", flush=True)
    print_images(scratch, _IMAGE_FRAMES)
