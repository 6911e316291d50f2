"""What every linker is given: the same droplets of the same frames."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from dropflow.detections import DropletReader
from dropflow.droplets import Droplets
from dropflow.experiment import Experiment, load_experiment
from dropflow.scoring.matching import Matching, match_to_truth
from dropflow.scoring.report import read_products
from dropflow.simulation.truth import Visibility

PLACE_STD_PX = 0.15
"""Error that is added to true places, and said to be theirs."""
RADIUS_STD = 0.03
"""Relative error that is added to true radii."""


@dataclass(frozen=True)
class Given:
    """Droplets of a film with known truth."""

    film: Path
    """Folder as `dropflow simulate` writes it."""
    droplets: list[Droplets]
    experiment: Experiment
    shape: tuple[int, int]

    @cached_property
    def truth(self) -> pa.Table:
        """Rows of `dropflow.simulation.truth.TRUTH`."""
        return pq.read_table(self.film / "truth.parquet")

    @cached_property
    def products(self) -> dict[int, int]:
        """What coalesced droplets became."""
        return read_products(self.film / "events.csv")

    @property
    def times_s(self) -> npt.NDArray[np.float64]:
        """Of the frames."""
        assert self.experiment.frame_interval_s is not None
        return np.arange(len(self.droplets)) * self.experiment.frame_interval_s

    @property
    def spacing_px(self) -> float:
        """Mean spacing of the droplets in a frame."""
        per_frame = np.mean([len(some) for some in self.droplets])
        return float(np.sqrt(self.shape[0] * self.shape[1] / max(per_frame, 1.0)))

    def table(self) -> pa.Table:
        """All droplets as one table."""
        pixel = self.experiment.pixel_size_um
        return pa.concat_tables(
            some.to_table(frame=frame, time_s=time_s, pixel_size_um=pixel)
            for frame, (some, time_s) in enumerate(zip(self.droplets, self.times_s.tolist(), strict=True))
        )

    def matched(self, trajectories: pa.Table) -> Matching:
        """Rows of trajectories beside the truth."""
        return match_to_truth(trajectories, self.truth)


def true_droplets(film: Path, shape: tuple[int, int]) -> Given:
    """The visible droplets of the truth, a little off."""
    truth = pq.read_table(film / "truth.parquet")
    frame = truth["frame"].to_numpy()
    is_visible = truth["visibility"].to_numpy(zero_copy_only=False) == str(Visibility.VISIBLE)
    droplets = []
    for index in range(int(frame.max()) + 1):
        rows = truth.filter(pa.array(is_visible & (frame == index)))
        x, y, r = (rows[name].to_numpy() for name in ("x_px", "y_px", "r_px"))
        rng, n = np.random.default_rng([77, index]), len(rows)
        x, y = x + rng.normal(0, PLACE_STD_PX, n), y + rng.normal(0, PLACE_STD_PX, n)
        r = r * np.exp(rng.normal(0, RADIUS_STD, n))
        sure = np.ones(n)
        droplets.append(Droplets(x, y, r, PLACE_STD_PX * sure, RADIUS_STD * r, sure, sure))
    return Given(film, droplets, load_experiment(film / "experiment.yaml"), shape)


def detected_droplets(film: Path, table: Path, n_frames: int, shape: tuple[int, int]) -> Given:
    """The droplets that a detector found."""
    reader = DropletReader(table)
    droplets = [reader(frame) for frame in range(n_frames)]
    reader.close()
    return Given(film, droplets, load_experiment(film / "experiment.yaml"), shape)
