"""A folder of results as `dropflow analyse` leaves it: the one way in for reports and exports."""

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import zarr

from dropflow.errors import ResultsError
from dropflow.experiment import Experiment, parse_experiment
from dropflow.figures.example import EXAMPLE_FILE, Example
from dropflow.parameters import Parameters, parse_parameters
from dropflow.statistics.condense import condense
from dropflow.statistics.condensed import Condensed
from dropflow.statistics.condensed_files import FILES, StoredCondensed
from dropflow.statistics.facts import FilmFacts


@dataclass(frozen=True)
class Results:
    """The files of one analysis."""

    folder: Path
    summary: dict[str, Any]

    @property
    def droplets(self) -> Path:
        """All detections."""
        return self.folder / "droplets.parquet"

    @property
    def trajectories(self) -> Path:
        """Droplets of the trajectories that were kept."""
        return self.folder / "trajectories.parquet"

    @property
    def flow(self) -> Path:
        """The flow field, a Zarr group."""
        return self.folder / "flow.zarr"

    @cached_property
    def example(self) -> Example | None:
        """The frame that the analysis kept for the working panels."""
        path = self.folder / EXAMPLE_FILE
        if not path.is_file():
            return None
        with path.open("rb") as file:
            return Example.load(file)

    @property
    def provenance(self) -> dict[str, Any]:
        """What made the results."""
        return dict(self.summary["provenance"])

    @cached_property
    def experiment(self) -> Experiment:
        """What was filmed."""
        return parse_experiment(self.provenance["experiment"])

    @cached_property
    def parameters(self) -> Parameters:
        """How it was analysed."""
        return parse_parameters(self.provenance["parameters"])

    @property
    def n_frames(self) -> int:
        """Frames of the film."""
        return int(self.summary["n_frames"])

    @property
    def field_um(self) -> tuple[float, float]:
        """Width and height of the frame in the sample."""
        width_um, height_um = self.summary["field_of_view_um"]
        return float(width_um), float(height_um)

    @property
    def area_um2(self) -> float:
        """Area of the frame in the sample."""
        return self.field_um[0] * self.field_um[1]

    @cached_property
    def facts(self) -> FilmFacts:
        """What statistics must know."""
        return FilmFacts(self.experiment, self.parameters, self.field_um, self.n_frames, self.provenance)

    @cached_property
    def condensed(self) -> Condensed:
        """What the analysis left for figures; computed from the tables where that is not there."""
        if all((self.folder / name).is_file() for name in FILES):
            return StoredCondensed(lambda name: (self.folder / name).open("rb"))
        return condense(self.folder, self.facts, times_s=self.times_s)

    @cached_property
    def times_s(self) -> npt.NDArray[np.float64]:
        """Time of each frame, shape (n_frames,)."""
        interval_s = self.experiment.frame_interval_s
        if interval_s is not None:
            return interval_s * np.arange(self.n_frames, dtype=np.float64)
        steps_s = np.asarray(zarr.open_array(self.flow / "time_s", mode="r")[:], np.float64)
        return np.append(steps_s, float(self.summary["duration_s"]) + (steps_s[0] if len(steps_s) else 0.0))


def open_results(folder: Path) -> Results:
    """Open a folder of results; raise `ResultsError` where something of them is missing or damaged."""
    path = folder / "summary.json"
    if not path.is_file():
        raise ResultsError(
            "There are no results.",
            code="results.missing",
            file=str(folder),
            hint="Give the folder that `dropflow analyse --output` wrote.",
        )
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
        parse_experiment(summary["provenance"]["experiment"])
    except (ValueError, KeyError, TypeError):
        raise ResultsError("This is no summary of an analysis.", file=str(path)) from None
    results = Results(folder, summary)
    for needed in (results.droplets, results.trajectories, results.flow):
        if not needed.exists():
            raise ResultsError("A part of the results is missing.", code="results.missing", file=str(needed))
    return results
