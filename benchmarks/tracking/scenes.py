"""Films to look at: `python -m benchmarks.tracking.scenes OUT [--scenarios fast ...] [--frames 16] [--seed 901]`.

Each scenario is simulated at a quarter of the area, analysed as `dropflow analyse` does, and drawn: `OUT/NAME.mp4` and
a PNG of every fourth frame (see `benchmarks.tracking.pictures` for what the colours mean). Its scores are printed.
"""

import argparse
from pathlib import Path

import pyarrow.parquet as pq

from benchmarks.tracking.__main__ import analysed
from benchmarks.tracking.films import simulated
from benchmarks.tracking.given import detected_droplets
from benchmarks.tracking.pictures import draw_film
from benchmarks.tracking.scores import HEAD, score
from dropflow.parameters import Parameters
from dropflow.simulation.scenario import FULL_HEIGHT_PX, FULL_WIDTH_PX, SCENARIOS


def draw_scene(out: Path, name: str, seed: int, n_frames: int) -> None:
    """One scenario."""
    size = {"height_px": FULL_HEIGHT_PX // 2, "width_px": FULL_WIDTH_PX // 2}
    film = simulated(out, name, seed, n_frames, with_images=True, **size)
    analysed(film, Parameters(), film / "droplets.parquet", film / "results")
    draw_film(film / "frames", film / "results", out / name, every=4)
    given = detected_droplets(film, film / "droplets.parquet", n_frames, (size["height_px"], size["width_px"]))
    rows = score(given, pq.read_table(film / "results" / "trajectories.parquet"), film / "results")
    print(rows.row(name, "dropflow, from images"), flush=True)


def main() -> None:
    """All scenarios, or those that are named."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--scenarios", nargs="+", choices=list(SCENARIOS), default=list(SCENARIOS))
    parser.add_argument("--frames", type=int, default=16)
    parser.add_argument("--seed", type=int, default=901)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    print(HEAD, flush=True)
    for name in given.scenarios:
        draw_scene(given.out, name, given.seed, given.frames)


if __name__ == "__main__":
    main()
