"""What tracking is given: times, detections and images of a film, frame by frame."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from dropflow.detection.contract import Detector
from dropflow.droplets import Droplets
from dropflow.errors import ExperimentError, FieldProblem, ResultsError
from dropflow.frames import Frames
from dropflow.physics.over_time import MaterialOverTime
from dropflow.tracking.follow import Look
from dropflow.tracking.prediction import Motion
from dropflow.tracking.prepared import PreparedFrames

FRAMES_PER_PART = 32
"""After so many frames the state is saved."""


@dataclass(frozen=True)
class Film:
    """A film whose droplets were detected."""

    times_s: npt.NDArray[np.float64]
    """Of each frame, shape (n_frames,)."""
    detections: Callable[[int], Droplets]
    frames: Frames | None
    """None where only detections are tracked and no image is looked at."""
    detector: Detector | None
    material: MaterialOverTime | None = None
    """Of each frame, where it changes along the film."""

    def __post_init__(self) -> None:
        times_s = np.asarray(self.times_s)
        if times_s.ndim != 1 or not len(times_s):
            raise ResultsError("There is no frame to track droplets in.", code="results.no_frames")
        wrong = np.flatnonzero(~np.isfinite(times_s) | np.append(False, ~(np.diff(times_s) > 0)))
        if len(wrong):
            frame = int(wrong[0])
            raise ExperimentError(
                "Time must go forward.",
                code="experiment.times_not_increasing",
                frame=frame,
                fields=[FieldProblem("timestamps", f"frame {frame} is not later than the one before")],
                hint="Put frames and times in order, and leave out frames that were saved twice.",
            )

    @property
    def n_frames(self) -> int:
        """How many frames there are."""
        return len(self.times_s)

    @property
    def n_parts(self) -> int:
        """How many parts of `FRAMES_PER_PART` frames."""
        return -(-self.n_frames // FRAMES_PER_PART)

    def frames_of(self, part: int) -> range:
        """The frames of one part."""
        return range(part * FRAMES_PER_PART, min((part + 1) * FRAMES_PER_PART, self.n_frames))

    def motion(self, mean: Motion, frame: int) -> Motion:
        """How droplets move between `frame` and the next, where `mean` is how they do over the film."""
        return mean if self.material is None else replace(mean, material=self.material.at(frame))

    def dt_s(self, frame: int) -> float:
        """Time from `frame` to the next, s."""
        return float(self.times_s[frame + 1] - self.times_s[frame])

    def detected(self, frame: int) -> Droplets:
        """The detections of one frame. Raises `ResultsError` where a place or radius is no number."""
        droplets = self.detections(frame)
        numbers = [droplets.x_px, droplets.y_px, droplets.r_px]
        if not all(np.isfinite(column).all() for column in numbers) or (droplets.r_px <= 0).any():
            raise ResultsError(
                "A detected droplet has no finite place or no positive radius.",
                code="results.droplets_not_finite",
                frame=frame,
                hint="Detect the droplets again.",
            )
        return Droplets(*(np.asarray(getattr(droplets, column.name), np.float64) for column in fields(Droplets)))

    @cached_property
    def _prepared(self) -> PreparedFrames | None:
        if self.frames is None or self.detector is None:
            return None
        return PreparedFrames(self.frames, self.detector)

    def look_at(self, frame: int, *, then: int) -> Look | None:
        """How to search the image of one frame, `then` being the one that is wanted next: it is prepared meanwhile."""
        prepared, detector = self._prepared, self.detector
        if prepared is None or detector is None:
            return None
        prepared.expect(frame, then)

        def look(predicted: Droplets) -> tuple[Droplets, npt.NDArray[np.bool_]]:
            return detector.find_near(prepared.get(frame), predicted, self.detected(frame))

        return look

    def close(self) -> None:
        """Read no image any more."""
        if self._prepared is not None:
            self._prepared.close()
