"""CPU time a frame beside the peers, how it grows, two processes, memory, and pure noise."""

import cProfile
import multiprocessing
import pickle
import pstats
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from benchmarks.detection.methods import METHODS, ours, plain
from benchmarks.detection.stills import Still, still
from dropflow.detection import make_detector
from dropflow.preprocess import estimate_stack

N_TIMES = 3


def speed() -> None:
    """Print CPU ms a frame of 5 Mpixel with some 500 droplets, as ratios to trackpy.locate."""
    frame = still("fast", 7)
    took = {name: min(method(frame)[1] for _ in range(N_TIMES)) for name, method in METHODS.items()}
    took["plain scikit-image"] = plain(frame)[1]
    n_visible = int(np.sum(frame.truth["visibility"].to_numpy(zero_copy_only=False) == "visible"))
    print(f"\nOne frame of {frame.frame.shape[0]} x {frame.frame.shape[1]} px, {n_visible} droplets, one thread")
    for name, ms in took.items():
        print(
            f"{name:20}{ms:>8.0f} ms{ms / took['trackpy']:>8.2f} x trackpy.locate"
            f"{took['plain scikit-image'] / ms:>8.1f} x faster than plain"
        )


def scaling() -> None:
    """Print how CPU time grows with area and with number."""
    print("\nscaling of `default`: area at equal density, then number in 1029 x 1224 px")
    for height_px, width_px in ((515, 612), (1029, 1224), (2058, 2448)):
        _scale_line(still("fast", 8, height_px=height_px, width_px=width_px))
    for factor in (0.25, 1, 4):
        _scale_line(still("fast", 8, height_px=1029, width_px=1224, n_droplets=500 * factor))


def _scale_line(one: Still) -> None:
    droplets, _ = ours(one, "default")
    ms = min(ours(one, "default")[1] for _ in range(N_TIMES))
    print(f"{one.frame.size / 1e6:>7.2f} Mpixel{len(droplets):>6} droplets{ms:>7.0f} ms", flush=True)


def profile(n_frames: int = 4) -> None:
    """Print where the CPU time of one full frame goes, function by function."""
    one = still("fast", 7)
    film, knobs = one.experiment(), one.parameters("default")
    detector = make_detector(film, knobs, estimate_stack([one.frame], film, knobs, one.flat_field))
    detector.detect(detector.prepare(one.frame))
    profiler = cProfile.Profile(time.process_time)
    profiler.enable()
    for _ in range(n_frames):
        detector.detect(detector.prepare(one.frame))
    profiler.disable()
    print("\nwhere the time of `default` goes, ms a frame (without what is done once a stack)")
    found = pstats.Stats(profiler).stats.items()  # type: ignore[attr-defined]
    for (file, _, name), (_, _, own_s, _, _) in sorted(found, key=lambda entry: -entry[1][2])[:12]:
        print(f"{Path(file).stem + '.' + name:50}{1e3 * own_s / n_frames:>7.1f}")


def memory() -> None:
    """Print the peak memory of a process that detects in full frames."""
    code = (
        "from benchmarks.detection.methods import ours\n"
        "import pickle, sys\n"
        "one = pickle.load(sys.stdin.buffer)\n"
        "[ours(one, 'default') for _ in range(3)]\n"
        # Not ru_maxrss, which a child inherits from whoever started it.
        "print(int(open('/proc/self/status').read().split('VmHWM:')[1].split()[0]) / 1024)\n"
    )
    given = pickle.dumps(still("fast", 7))
    found = subprocess.run([sys.executable, "-c", code], input=given, capture_output=True, check=True)
    print(f"\npeak memory of a process: {float(found.stdout):.0f} MB")


def _detect_many(one: Still, n_frames: int) -> None:
    for _ in range(n_frames):
        ours(one, "default")


def two_processes(n_frames: int = 12) -> None:
    """Print how much more two processes do than one in the same time."""
    one = still("fast", 7, height_px=1029, width_px=1224)
    _detect_many(one, 1)
    start = time.perf_counter()
    _detect_many(one, n_frames)
    alone = time.perf_counter() - start
    context = multiprocessing.get_context("fork")
    processes = [context.Process(target=_detect_many, args=(one, n_frames)) for _ in range(2)]
    start = time.perf_counter()
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    together = time.perf_counter() - start
    print(f"two processes do {2 * alone / together:.2f} x the frames of one in the same time")


def noise() -> None:
    """Print how many droplets are found where there is nothing but noise."""
    print("\npure noise, 2058 x 2448 px: false droplets")
    for sigma in (2, 8, 20):
        for seed in range(2):
            levels = np.random.default_rng([1, sigma, seed]).normal(100, sigma, (2058, 2448))
            one = still("easy", 9, height_px=300, width_px=300)
            frame = np.clip(np.rint(levels), 0, 255).astype(np.uint8)
            film, knobs = one.experiment(), one.parameters("default")
            detector = make_detector(film, knobs, estimate_stack([frame], film, knobs))
            image = detector.prepare(frame)
            n_found = len(detector.detect(image).droplets)
            print(f"  sigma {sigma:>3} levels, seed {seed}: {n_found}", flush=True)
