from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from dropflow.detection import make_detector
from dropflow.detection.contract import Detector
from dropflow.droplets import Droplets
from dropflow.frames import Frame, Frames
from dropflow.parameters import parse_parameters
from dropflow.preprocess import estimate_stack
from dropflow.tracking import track
from tests.dropflow.detection.discs import draw
from tests.dropflow.tracking.generated import Film, film, vortices

KNOBS = parse_parameters({"detection": {"radius_min_um": 5.0, "radius_max_um": 30.0}})


class Drawn(Frames):
    """Frames in memory that count how often each is read."""

    def __init__(self, frames: list[Frame]) -> None:
        self._frames = frames
        self.shape = frames[0].shape
        self.dtype = frames[0].dtype
        self.n_reads = np.zeros(len(frames), int)

    def __len__(self) -> int:
        return len(self._frames)

    def label(self, index: int) -> str:
        return f"drawn {index}"

    def read(self, index: int) -> Frame:
        self.n_reads[index] += 1
        return self._frames[index]

    def close(self) -> None:
        pass


@pytest.fixture(scope="module")
def given() -> Film:
    """Twelve slow frames with about twenty droplets of 8 to 30 px."""
    small = film(flow=vortices(6, 300, drift_px_s=(5, 0)), n_frames=8, n_droplets=22, shape=(300, 360), seed=4)
    bigger = [
        Droplets(d.x_px, d.y_px, 8 + 1.5 * (d.r_px - 3), d.x_std_px, d.r_std_px, d.probability, d.match)
        for d in small.frames
    ]
    return Film(small.experiment, small.shape, small.times_s, bigger, small.truth)


@pytest.fixture(scope="module")
def drawn(given: Film) -> Drawn:
    """Its frames as images."""
    return Drawn([draw(np.column_stack([d.x_px, d.y_px, d.r_px]).tolist(), shape=given.shape) for d in given.frames])


@pytest.fixture(scope="module")
def detector(given: Film, drawn: Drawn) -> Detector:
    return make_detector(given.experiment, KNOBS, estimate_stack(drawn, given.experiment, KNOBS))


@pytest.fixture(scope="module")
def detected(drawn: Drawn, detector: Detector) -> list[Droplets]:
    return [detector.detect(detector.prepare(drawn[frame])).droplets for frame in range(len(drawn))]


def share_followed(given: Film, rows: pa.Table) -> float:
    """Share of the droplets in the frames' inner part that a trajectory has in the right place."""
    table = {name: rows[name].to_numpy() for name in ("frame", "x_px", "y_px")}
    n_there, n_followed = 0, 0
    for frame, truth in enumerate(given.frames):
        here = table["frame"] == frame
        inside = (np.abs(truth.x_px - 180) < 140) & (np.abs(truth.y_px - 150) < 110)
        for x, y in zip(truth.x_px[inside], truth.y_px[inside], strict=True):
            n_there += 1
            n_followed += bool((np.hypot(table["x_px"][here] - x, table["y_px"][here] - y) < 4).any())
    return n_followed / n_there


def followed(given: Film, drawn: Drawn, detector: Detector, detected: list[Droplets], folder: Path) -> pa.Table:
    """Rows of the trajectories of these detections."""
    result = track(
        drawn,
        detected.__getitem__,
        times_s=given.times_s,
        experiment=given.experiment,
        parameters=KNOBS,
        detector=detector,
        folder=folder,
    )
    return pq.read_table(result.trajectories)


def test_the_image_shows_what_detection_missed(
    given: Film, drawn: Drawn, detector: Detector, detected: list[Droplets], tmp_path: Path
) -> None:
    """With a third of the detections gone most of them are followed all the same, and said not to be detected."""
    rng = np.random.default_rng(0)
    thinned = [droplets[rng.uniform(size=len(droplets)) > 1 / 3] for droplets in detected]
    every = followed(given, drawn, detector, detected, tmp_path / "every")
    rows = followed(given, drawn, detector, thinned, tmp_path / "thinned")
    assert share_followed(given, every) > 0.75
    assert share_followed(given, rows) > share_followed(given, every) - 0.15
    assert 0.2 < 1 - rows["is_detected"].to_numpy().mean() < 0.4


def test_each_image_is_read_once_on_the_way_forward_and_once_back(
    given: Film, drawn: Drawn, detector: Detector, detected: list[Droplets], tmp_path: Path
) -> None:
    """However many droplets are looked for in it."""
    drawn.n_reads[:] = 0
    followed(given, drawn, detector, [droplets[::2] for droplets in detected], tmp_path)
    assert drawn.n_reads.max() == 2


def test_no_two_trajectories_meet(
    given: Film, drawn: Drawn, detector: Detector, detected: list[Droplets], tmp_path: Path
) -> None:
    """What the image shows where another trajectory is would be a branch of it."""
    rows = followed(given, drawn, detector, [droplets[::2] for droplets in detected], tmp_path)
    for frame in range(len(drawn)):
        here = rows.filter(pc.field("frame") == frame)
        places = np.column_stack([here["x_px"].to_numpy(), here["y_px"].to_numpy()])
        apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)) + 99 * np.eye(len(places))
        assert apart.min() > 3
