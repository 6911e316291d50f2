"""Accuracy and speed of detection beside its peers.

    python -m benchmarks.detection [PART ...] [--frames 2] [--height 2058] [--width 2448] [--data DATA]

PART is any of accuracy, grid, speed, profile, scaling, processes, noise, gold (default: all). Gold needs DATA, the
folder with `bubbles_zerog_gold`.
"""

import argparse
import os
from pathlib import Path

for _library in ("OMP", "OPENBLAS", "MKL", "NUMBA"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

PARTS = ("accuracy", "grid", "speed", "profile", "scaling", "processes", "noise", "gold")


def main() -> None:
    """Run the parts asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], default=[], metavar="PART")
    parser.add_argument("--frames", type=int, default=2, help="simulated frames of each kind")
    parser.add_argument("--height", type=int, default=2058)
    parser.add_argument("--width", type=int, default=2448)
    parser.add_argument("--data", type=Path)
    given = parser.parse_args()
    run(given.parts or PARTS, given)


def run(parts: tuple[str, ...], given: argparse.Namespace) -> None:
    """Print each part's table."""
    import cv2

    from benchmarks import real_images
    from benchmarks.detection import accuracy, grid, speed

    cv2.setNumThreads(1)
    if "accuracy" in parts:
        accuracy.accuracy(given.frames, height_px=given.height, width_px=given.width)
    if "grid" in parts:
        grid.grid()
    if "speed" in parts:
        speed.speed()
    if "profile" in parts:
        speed.profile()
    if "scaling" in parts:
        speed.scaling()
    if "processes" in parts:
        speed.two_processes()
        speed.memory()
    if "noise" in parts:
        speed.noise()
    if "gold" in parts:
        if given.data is None:
            print("\nbubbles_zerog_gold: not run, for --data was not given")
        else:
            real_images.bubbles(given.data)


if __name__ == "__main__":
    main()
