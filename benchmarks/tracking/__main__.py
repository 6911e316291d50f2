"""Tables of tracking: `python -m benchmarks.tracking [TABLE ...] [--frames 20] [--seed 901] [--keep FOLDER]`.

images       whole pipeline from images of 2058 x 2448 px, five scenarios, beside the paper's whole chain
truth        with the true droplets given (0.15 px and 3 % of the radius off), beside the peers
sweep        the same for ever longer intervals between frames: spacing over displacement from 4 to 0.3
flows        broader spectra of the flow, and droplets that drag the fluid along (true droplets)
convection   exact paths of a direct numerical simulation with Stokes drift, true droplets and images
material     drho / eta wrong by 30 % either way (true droplets), and what the velocities say of it
coalescence  claimed and true coalescences (true droplets, every second pair that touches joins)
speed        seconds of linking with flow, beside trackpy; growth with the number of droplets; images at 5 megapixels

Seeds and numbers are printed; links are precision / recall; flow is rms error over rms; ISBI numbers have a gate of
5 px; L1 is the error of the size distribution before and after tracking.
"""

import argparse
import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

from benchmarks.tracking import coalescence, speed
from benchmarks.tracking.films import SHAPE, convection, simulated, spacing_over_displacement
from benchmarks.tracking.given import Given, detected_droplets, true_droplets
from benchmarks.tracking.limits import unknown_share, unshared_share
from benchmarks.tracking.scores import (
    DEFAULT,
    HEAD,
    dropflow_scores,
    error_at_droplets,
    error_of_velocities,
    print_all,
    print_peers,
    score,
)
from dropflow.analysis import detect, open_film
from dropflow.experiment import FixedMaterial, load_experiment
from dropflow.frames import Choice, open_frames
from dropflow.parameters import Method, Parameters, TrackingMethod, parse_parameters
from dropflow.pipeline import track_film
from dropflow.simulation.scenario import SCENARIOS
from dropflow.statistics.calibration import self_calibration
from dropflow.statistics.trajectories import open_trajectories, summarise_trajectories

TABLES = ("images", "truth", "sweep", "flows", "convection", "material", "coalescence", "speed")
REAL_DATA = Path(os.environ.get("DROPFLOW_REAL_DATA", "../shared/data"))
RBC = REAL_DATA / "proptv_dns_rbc/rbc_tracers_6000x30.npz"
RATIOS = (4.0, 3.0, 2.0, 1.5, 1.0, 0.7, 0.5, 0.4, 0.3)
_INTERVAL_AT_ONE_S = 1.25
"""Interval at which droplets of the scenario `fast` move by about their spacing."""


def from_images(film: Path, name: str, scratch: Path, n_frames: int) -> None:
    """Rows of the whole pipeline with either detector and either tracking, and of the peers on the same droplets."""
    for detector in Method:
        table = scratch / f"{film.name}-{detector}.parquet"
        for tracking in TrackingMethod:
            knobs = {"detection": {"method": str(detector)}, "tracking": {"method": str(tracking)}}
            results = scratch / f"{film.name}-{detector}-{tracking}"
            analysed(film, parse_parameters(knobs), table, results)
            given = detected_droplets(film, table, n_frames, SHAPE)
            found = pq.read_table(results / "trajectories.parquet")
            print(score(given, found, results).row(name, f"{detector} droplets, {tracking}"), flush=True)
        if detector == Parameters().detection.method:
            print_peers(given, name)


def analysed(film: Path, parameters: Parameters, table: Path, results: Path) -> None:
    """As `dropflow analyse` does; droplets that are there already are not detected again."""
    experiment = load_experiment(film / "experiment.yaml")
    opened = open_film(film / "frames", experiment, parameters, beside=film)
    if not table.exists():
        detect(opened, table, n_processes=1)
    with open_frames(opened.source, Choice.of(experiment)) as frames:
        track_film(frames, opened.index, experiment, parameters, opened.measured, droplets=table, folder=results)


def print_images(scratch: Path, seed: int, n_frames: int, names: list[str]) -> None:
    """The five scenarios."""
    for name in names:
        from_images(simulated(scratch, name, seed, n_frames, with_images=True), name, scratch, n_frames)


def print_truth(scratch: Path, seed: int, n_frames: int, names: list[str]) -> None:
    """The five scenarios with true droplets."""
    for name in names:
        film = simulated(scratch, name, seed, n_frames, with_images=False)
        print_all(true_droplets(film, SHAPE), name, scratch / f"truth-{name}")


def print_sweep(scratch: Path, seed: int, n_frames: int, _names: list[str]) -> None:
    """The scenario `fast` at ever longer intervals."""
    for ratio in RATIOS:
        interval_s = _INTERVAL_AT_ONE_S / ratio
        film = simulated(scratch, "fast", seed, n_frames, with_images=False, frame_interval_s=interval_s)
        print_all(
            true_droplets(film, SHAPE), f"{spacing_over_displacement(film):.2f} ({interval_s:.2f} s)", film / "results"
        )


def print_flows(scratch: Path, seed: int, n_frames: int, names: list[str]) -> None:
    """Other flows than those that the estimator knows best, of `fast` and `dense` where these are asked for."""
    cases = ({"kspread": 0.4}, {"kspread": 0.8}, {"wake_strength": 0.5}, {"wake_strength": 1.0})
    for changes in cases:
        for name in (name for name in ("fast", "dense") if name in names):
            film = simulated(scratch, name, seed, n_frames, with_images=False, **changes)
            ((key, value),) = changes.items()
            label = f"{name} {key.removesuffix('_strength')} {value:g}"
            print_all(true_droplets(film, SHAPE), label, film / "results")


def print_convection(scratch: Path, _seed: int, _n_frames: int, _names: list[str]) -> None:
    """Droplets on the paths of `proptv_dns_rbc`."""
    if not RBC.exists():
        print(f"There is no {RBC}: left out.")
        return
    given = true_droplets(convection(scratch, RBC, with_images=False), SHAPE)
    print_all(given, "convection, truth", scratch / "c")
    results = scratch / "c" / "default"
    print(f"Fluid velocity that each droplet shows, error over rms: {error_of_velocities(given, results):.3f}")
    print(f"Flow field at the droplets, error over rms: {error_at_droplets(given, results):.3f}")
    print(f"The true velocity of one droplet from those of all others, error over rms: {unshared_share(given):.3f}")
    print(f"The simulated flow between its tracers is known to {unknown_share(RBC):.2f} of its rms.", flush=True)
    film = convection(scratch, RBC, with_images=True)
    from_images(film, "convection, images", scratch, 30)


def print_material(scratch: Path, seed: int, n_frames: int, names: list[str]) -> None:
    """Links with a material that is 30 % off."""
    for name in names:
        given = true_droplets(simulated(scratch, name, seed, n_frames, with_images=False), SHAPE)
        for share in (1.0, 0.7, 1.3):
            assert isinstance(given.experiment.material, FixedMaterial)
            wrong = given.experiment.material.delta_density_kg_m3 * share
            material = given.experiment.material.model_copy(update={"delta_density_kg_m3": wrong})
            experiment = given.experiment.model_copy(update={"material": material})
            off = Given(given.film, given.droplets, experiment, given.shape)
            results = scratch / f"material-{name}-{share:g}"
            print(dropflow_scores(off, DEFAULT, results).row(name, f"dropflow, drho/eta x {share:g}"))
            print(f"    calibration finds {_calibrated(results, off)} times the true drho/eta", flush=True)


def _calibrated(results: Path, given: Given) -> str:
    """What the velocities in a table of trajectories say of the true material, and the standard error."""
    path = results / "trajectories.parquet"
    experiment = given.experiment
    true = load_experiment(given.film / "experiment.yaml").material
    assert isinstance(true, FixedMaterial)
    assert isinstance(experiment.material, FixedMaterial)
    assumed = experiment.material.delta_density_kg_m3 / experiment.material.viscosity_pa_s
    found = self_calibration(
        path,
        summarise_trajectories(open_trajectories(path), experiment.up),
        experiment.up,
        field_um=(given.shape[1] * experiment.pixel_size_um, given.shape[0] * experiment.pixel_size_um),
        density_over_viscosity_s_m2=np.full(len(given.droplets), assumed),
    )
    per_true = true.viscosity_pa_s / true.delta_density_kg_m3
    value, std = found.density_over_viscosity_s_m2 * per_true, abs(found.std_s_m2 * per_true)
    return f"{value:.3f} +- {std:.3f} ({found.n_trajectories} trajectories)"


def print_coalescence(scratch: Path, seed: int, n_frames: int, _names: list[str]) -> None:
    """Coalescences of three scenarios."""
    for name in ("easy", "fast", "dense"):
        film = simulated(scratch, name, seed, n_frames, with_images=False, collision_efficiency=0.5)
        coalescence.print_row(true_droplets(film, SHAPE), name, film / "results")


@contextlib.contextmanager
def _folder(kept: Path | None) -> Iterator[Path]:
    if kept is not None:
        kept.mkdir(parents=True, exist_ok=True)
        yield kept
        return
    with tempfile.TemporaryDirectory() as scratch:
        yield Path(scratch)


def main() -> None:
    """Print the tables asked for, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=f"some of {', '.join(TABLES)}")
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--seed", type=int, default=901)
    parser.add_argument("--scenarios", nargs="+", choices=list(SCENARIOS), default=list(SCENARIOS))
    parser.add_argument("--speed-frames", type=int, default=1000, help="length of the film of the table of speed")
    parser.add_argument("--keep", type=Path, help="keep films and results here")
    arguments = parser.parse_args()
    if unknown := set(arguments.tables) - set(TABLES):
        parser.error(f"there is no table {', '.join(sorted(unknown))}; there are {', '.join(TABLES)}")
    prints = {
        "images": print_images,
        "truth": print_truth,
        "sweep": print_sweep,
        "flows": print_flows,
        "convection": print_convection,
        "material": print_material,
        "coalescence": print_coalescence,
    }
    with _folder(arguments.keep) as scratch:
        for table in arguments.tables or TABLES:
            print(f"\n== {table} (seed {arguments.seed}, {arguments.frames} frames)\n")
            if table == "speed":
                speed.print_table(scratch, arguments.speed_frames)
                continue
            if table != "coalescence":
                print(HEAD, flush=True)
            prints[table](scratch, arguments.seed, arguments.frames, arguments.scenarios)


if __name__ == "__main__":
    main()
