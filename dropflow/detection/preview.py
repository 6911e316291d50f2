"""One frame as detection sees it: every step of preparing it, what was found, and what was not taken and why."""

from collections import Counter
from dataclasses import dataclass

from dropflow.detection.contract import Detection, Detector, Frame, Step


@dataclass(frozen=True, eq=False)
class Preview:
    """What detection does with one frame."""

    frame: Frame
    """As it was read."""
    steps: tuple[Step, ...]
    """Of preparing it, in order; in the last one droplets are looked for."""
    detection: Detection

    @property
    def n_rejected(self) -> dict[str, int]:
        """Candidates that were not accepted, by reason."""
        return dict(sorted(Counter(self.detection.rejected.reasons).items()))


def preview(frame: Frame, detector: Detector) -> Preview:
    """Detect the droplets of one frame with all that leads to them.

    Parameters
    ----------
    frame
        Shape (rows, columns), as read.
    detector
        From `dropflow.detection.make_detector`.

    Raises
    ------
    FramesError
        The frame has another shape than its stack, or pixels that are not finite.
    """
    steps = tuple(detector.steps(frame))
    return Preview(frame, steps, detector.detect(steps[-1].image))
