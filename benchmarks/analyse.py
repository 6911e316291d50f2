"""CPU time and memory of a whole `dropflow analyse` on 5-megapixel frames, in one process, by length of the film.

    python -m benchmarks.analyse [--scenario fast] [--frames 10 20]

Memory that grew with the length of the film would show in the last column.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

COMMAND = [sys.executable, "-c", "from dropflow.cli import main; main()"]


def measure(film: Path, frames: Path, output: Path) -> tuple[float, float]:
    """CPU seconds and peak memory in MB of one analysis, interpreter and imports included."""
    options = ["--experiment", film / "experiment.yaml", "--output", output, "--jobs", "1"]
    process = subprocess.Popen([*COMMAND, "analyse", frames, *options], stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        sys.exit(f"The analysis failed with code {process.returncode}.")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def first_frames(film: Path, n_frames: int, folder: Path) -> Path:
    """A folder with links to the first frames of a film."""
    folder.mkdir()
    for frame in sorted((film / "frames").iterdir())[:n_frames]:
        (folder / frame.name).symlink_to(frame)
    return folder


def main() -> None:
    """Simulate a film, analyse its first frames and all of them, print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenario", default="fast")
    parser.add_argument("--frames", type=int, nargs="+", default=[10, 20])
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        film = Path(scratch) / "film"
        options = ["--scenario", arguments.scenario, "--frames", str(max(arguments.frames)), "--seed", "77"]
        subprocess.run([*COMMAND, "simulate", film, *options], check=True, stdout=subprocess.DEVNULL)
        first = first_frames(film, 2, Path(scratch) / "warm")
        measure(film, first, Path(scratch) / "warm-results")  # numba compiles once per machine, not per film
        print(f"{'frames':>8} {'CPU s':>8} {'CPU s a frame':>14} {'peak memory MB':>15}")
        for n_frames in arguments.frames:
            frames = first_frames(film, n_frames, Path(scratch) / f"frames-{n_frames}")
            cpu_s, memory_mb = measure(film, frames, Path(scratch) / f"results-{n_frames}")
            print(f"{n_frames:>8} {cpu_s:>8.1f} {cpu_s / n_frames:>14.2f} {memory_mb:>15.0f}", flush=True)


if __name__ == "__main__":
    main()
