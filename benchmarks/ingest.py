"""Speed of ingest beside that of reading the same frames: ingest reads every frame once, and should cost no more.

    python -m benchmarks.ingest [--frames 2000] [--side 1000]

The stack is a folder of TIFFs, as an upload leaves it: in one object of the store for some hundred files, checksums
known. Reading is opening the stack and decoding each frame, nothing else; ingest is what the worker does. Both in turn,
in one process, from the same files; the last line is the ratio of their medians.
"""

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import tifffile

from backend.platform.object_store import ObjectStore
from backend.platform.places import Place
from backend.platform.store_files import StoreFiles
from dropflow.experiment import parse_experiment
from dropflow.frames import Choice, open_frames
from dropflow.ingest import StackFile, check_frames, index_stack
from tests.films import EXPERIMENT

FILES_AN_OBJECT = 64


def stored(store: ObjectStore, n_frames: int, side: int) -> StoreFiles:
    """Frames in a store as uploads leave them."""
    noise = np.random.default_rng(0).integers(0, 255, (side, side), np.uint8)
    places: dict[str, Place] = {}
    with tempfile.TemporaryDirectory() as scratch:
        for start in range(0, n_frames, FILES_AN_OBJECT):
            key, content = f"experiments/x/files/{start}", bytearray()
            for index in range(start, min(start + FILES_AN_OBJECT, n_frames)):
                path = Path(scratch) / "frame.tif"
                tifffile.imwrite(path, np.roll(noise, index, axis=1))
                places[f"frame{index}.tif"] = Place(key, len(content), path.stat().st_size)
                content += path.read_bytes()
            store.put(key, bytes(content))
    return StoreFiles(store, places)


def read(files: StoreFiles) -> None:
    """Every frame, and nothing else."""
    with open_frames(files) as frames:
        for index in range(len(frames)):
            frames.read(index)


def ingest(files: StoreFiles) -> None:
    """What the worker does with an upload."""
    experiment = parse_experiment(EXPERIMENT)
    known = {name: StackFile(name=name, size_bytes=1, sha256="0" * 64) for name in files.names()}
    index = index_stack(files, experiment, known=known)
    with open_frames(files, Choice.of(experiment)) as frames:
        index.checked(check_frames(frames))


def main() -> None:
    """Measure both in turn, print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=2000)
    parser.add_argument("--side", type=int, default=1000)
    parser.add_argument("--repeat", type=int, default=3)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="dropflow-benchmark-") as scratch:
        files = stored(ObjectStore(Path(scratch).as_uri()), asked.frames, asked.side)
        ways: dict[str, Callable[[StoreFiles], None]] = {"reading": read, "ingest": ingest}
        took_s: dict[str, list[float]] = {name: [] for name in ways}
        read(files)
        for _ in range(asked.repeat):
            for name, way in ways.items():
                began_s = time.perf_counter()
                way(files)
                took_s[name].append(time.perf_counter() - began_s)
    print(f"{asked.frames} frames of {asked.side} x {asked.side} pixels, 8 bit")
    for name, times_s in took_s.items():
        median_s = statistics.median(times_s)
        print(f"{name:>8} {median_s:7.2f} s  {asked.frames / median_s:7.0f} frames/s")
    print(f"ingest over reading: {statistics.median(took_s['ingest']) / statistics.median(took_s['reading']):.2f}")


if __name__ == "__main__":
    main()
