"""What a person confirms of a stack; where any of it changes, it is to be confirmed again."""

from typing import Any

from backend.models import Experiment


def facts_of(experiment: Experiment) -> dict[str, Any]:
    """Which frames, how many, over which time, and how large a pixel is."""
    stack = experiment.stack
    return {
        "checksum": stack.checksum,
        "n_frames": stack.n_frames,
        "duration_s": stack.duration_s,
        "pixel_size_um": float(experiment.document["pixel_size_um"]),
    }
