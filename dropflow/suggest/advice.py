"""From measurements to parameters, each with its reason."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.detection.default.detector import DefaultDetector
from dropflow.detection.unfamiliar import TOLERATED_SHARE
from dropflow.errors import FramesError
from dropflow.experiment import Experiment
from dropflow.parameters import Parameters, parse_parameters
from dropflow.preprocess import estimate_stack
from dropflow.preprocess.background import Stack
from dropflow.preprocess.measure import sampled
from dropflow.radius_range import SMALLEST_RADIUS_PX
from dropflow.suggest.displacement import displacement
from dropflow.suggest.measurements import Measurement, Seen, look_around, measurements_of

_N_FRAMES = 3
_LARGEST_SHARE = 0.25
"""The wide search is for radii up to this part of the shorter side."""
_MARGIN = 1.25
"""The range proposed goes this factor beyond the radii seen."""
_FEW = 20
_FAST_SPACINGS = 1.0


@dataclass(frozen=True)
class Suggestion:
    """One field of the parameters (or of the experiment) with a value and why."""

    field: str
    """Dotted path, e.g. ``detection.radius_min_um``."""
    value: float | str
    unit: str
    reason: str


@dataclass(frozen=True)
class Advice:
    """What was measured, what is proposed, and what to be careful about."""

    frames: tuple[int, ...]
    """Frames that were looked at."""
    measurements: tuple[Measurement, ...]
    suggestions: tuple[Suggestion, ...]
    warnings: tuple[str, ...]

    def parameters(self) -> Parameters:
        """The proposed parameters; what nothing is proposed for has its default."""
        document: dict[str, Any] = {}
        for suggestion in self.suggestions:
            *groups, name = suggestion.field.split(".")
            place = document
            for group in groups:
                place = place.setdefault(group, {})
            place[name] = suggestion.value
        return parse_parameters(document)


def suggest(frames: Stack, experiment: Experiment, *, flat_field: npt.NDArray[Any] | None = None) -> Advice:
    """Measure three pairs of frames and propose parameters.

    Parameters
    ----------
    frames
        The stack: anything with a length whose items are grey frames of shape (rows, columns).
    experiment
        Its `pixel_size_um` and `droplets` count.
    flat_field
        Image of the empty field of view, shape (rows, columns).

    Raises
    ------
    FramesError
        The stack is empty, or its frames are too small for droplets of 2 px.
    ExperimentError
        The flat field does not fit the frames.
    """
    detector = _wide_detector(frames, experiment, flat_field)
    which = sampled(max(len(frames) - 1, 1), _N_FRAMES)
    seen = look_around(frames, which, detector)
    moved, moves = _displacements(frames, which, seen, detector)
    measured = (*measurements_of(seen, detector.estimate), *moved)
    radii_px = np.concatenate([droplets.r_px for droplets in seen.droplets])
    return Advice(
        tuple(which),
        measured,
        tuple(_radius_range(radii_px, detector, experiment)),
        tuple(_warnings(len(radii_px), moves, seen.unfamiliar_share, seen)),
    )


def _wide_detector(frames: Stack, experiment: Experiment, flat_field: npt.NDArray[Any] | None) -> DefaultDetector:
    """A detector of all radii that the frames can show."""
    if len(frames) == 0:
        raise FramesError("There are no frames in this stack.", code="frames.empty")
    side = min(frames[0].shape)
    largest_px = _LARGEST_SHARE * side
    if largest_px <= 2 * SMALLEST_RADIUS_PX:
        message = f"Frames of {frames[0].shape[0]} x {frames[0].shape[1]} px are too small to measure droplets in."
        raise FramesError(message, code="frames.too_small", hint="Give frames of at least 17 px along each side.")
    pixel = experiment.pixel_size_um
    wide = {"radius_min_um": SMALLEST_RADIUS_PX * pixel, "radius_max_um": largest_px * pixel}
    estimate = estimate_stack(frames, experiment, parse_parameters({"detection": wide}), flat_field)
    return DefaultDetector(estimate, experiment.droplets, SMALLEST_RADIUS_PX, largest_px)


def _displacements(
    frames: Stack, which: list[int], seen: Seen, detector: DefaultDetector
) -> tuple[list[Measurement], list[tuple[float, float]]]:
    """How far droplets move, as measurements and as (typical, spacing) of each pair of frames that could be told."""
    if len(frames) < 2:
        return [], []
    found = []
    detector = _narrowed(detector, np.concatenate([droplets.r_px for droplets in seen.droplets]))
    for index, before in zip(which, seen.droplets, strict=True):
        after = detector.detect(detector.prepare(frames[index + 1])).droplets
        found.append(displacement(before, after, detector.estimate.shape))
    typical = [one.typical_px for one in found if one.typical_px is not None]
    largest = [one.largest_px for one in found if one.largest_px is not None]
    spacing_px = float(np.median([one.spacing_px for one in found]))
    told = [
        Measurement("displacement", float(np.median(typical)) if typical else None, "px/frame", "typical, by the flow"),
        Measurement("displacement_largest", max(largest, default=None), "px/frame", "in the fastest part of the frame"),
        Measurement("spacing", spacing_px, "px", "mean distance of droplets, sqrt(area / number)"),
    ]
    return told, [(one.typical_px, one.spacing_px) for one in found if one.typical_px is not None]


def _narrowed(detector: DefaultDetector, radii_px: npt.NDArray[np.float64]) -> DefaultDetector:
    """A detector of the radii that are there: a search for the smallest of all takes most of the time."""
    if len(radii_px) == 0:
        return detector
    low, high = np.percentile(radii_px, [1, 99])
    return replace(
        detector,
        r_min_px=max(detector.r_min_px, float(low) / _MARGIN),
        r_max_px=min(detector.r_max_px, float(high) * _MARGIN),
    )


def _radius_range(
    radii_px: npt.NDArray[np.float64], detector: DefaultDetector, experiment: Experiment
) -> list[Suggestion]:
    pixel = experiment.pixel_size_um
    if len(radii_px) < 2:
        return []
    low, high = (float(value) for value in np.percentile(radii_px, [1, 99.5]))
    least = max(low / _MARGIN, SMALLEST_RADIUS_PX)
    most = min(max(high * _MARGIN, 1.5 * least), min(detector.estimate.shape) / 2)
    why_least = f"1 % of {len(radii_px)} droplets are smaller than {low:.3g} px ({low * pixel:.3g} um)"
    if least == SMALLEST_RADIUS_PX:
        why_least += f"; {SMALLEST_RADIUS_PX:g} px is the least that can be measured"
    why_most = f"0.5 % are larger than {high:.3g} px ({high * pixel:.3g} um)"
    return [
        Suggestion("detection.radius_min_um", _rounded(least * pixel, up=True), "um", why_least),
        Suggestion("detection.radius_max_um", _rounded(most * pixel, up=False), "um", why_most),
    ]


def _rounded(value: float, *, up: bool) -> float:
    """Two significant digits, never beyond the side that is allowed."""
    digits = 10.0 ** (np.floor(np.log10(value)) - 1)
    whole = np.ceil(value / digits - 1e-9) if up else np.floor(value / digits + 1e-9)
    return float(f"{whole * digits:.2g}")


def _warnings(n_droplets: int, moves: list[tuple[float, float]], unfamiliar: float, seen: Seen) -> list[str]:
    told = []
    if n_droplets < _FEW:
        told.append(
            f"Only {n_droplets} droplets stand out. If there are more, look at `droplets` (bright or dark) in the "
            "experiment, and at an overlay."
        )
    if any(moved > _FAST_SPACINGS * spacing for moved, spacing in moves):
        told.append("Droplets move farther than their mean distance between frames: film faster if you can.")
    if unfamiliar > TOLERATED_SHARE:
        told.append(
            "The droplets do not look like those that detection was trained on: look at overlays of some frames."
        )
    if seen.contrast is not None and seen.contrast < 2 * seen.noise:
        told.append("Droplets hardly stand out of the noise: more light or less gain would find more of them.")
    return told
