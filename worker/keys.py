"""Addresses of what is made, by what goes in: equal keys mean equal results, so that nothing is done twice.

The code counts as it stands: a change in any line of the library gives new keys.
"""

import hashlib
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import dropflow
from dropflow.experiment import Experiment
from dropflow.ingest import StackIndex
from dropflow.parameters import Parameters
from dropflow.provenance import content_key

_SAYS_NOTHING_OF_FRAMES = {"name", "notes", "tags", "recorded_at"}


@cache
def source_digest() -> str:
    """Checksum of the library's code and of the material files and the trained model beside it."""
    folder = Path(dropflow.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(path for ending in ("py", "yaml", "npz") for path in folder.rglob(f"*.{ending}")):
        digest.update(path.relative_to(folder).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def detection_key(index: StackIndex, experiment: Experiment, parameters: Parameters) -> str:
    """Of the droplets of all frames: what is only for tracking, or only for people, makes no difference."""
    return content_key(
        source_digest(),
        "detect",
        index.sha256,
        list(index.times_s),
        experiment.model_dump(mode="json", exclude=_SAYS_NOTHING_OF_FRAMES),
        parameters.detection.model_dump(mode="json"),
    )


def range_key(detection: str, frames: range) -> str:
    """Of the droplets of a range of frames."""
    return content_key(detection, frames.start, frames.stop)


def film_key(task: str, inputs: Sequence[str], experiment: Experiment, parameters: Parameters) -> str:
    """Of what is made of a whole film: everything is in it, for the tables say where they come from."""
    return content_key(
        source_digest(),
        task,
        list(inputs),
        experiment.model_dump(mode="json"),
        parameters.model_dump(mode="json"),
    )
