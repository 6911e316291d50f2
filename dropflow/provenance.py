"""Where a result comes from: code, parameters, input and units, carried inside every result."""

import hashlib
import json
from importlib.metadata import version
from typing import Any

from dropflow.experiment import Experiment
from dropflow.ingest import StackIndex
from dropflow.parameters import Parameters

UNITS = "lengths in px or um, times in s, velocities in um/s, as each name says; image axes x right, y down"


def code_version() -> str:
    """The version of dropflow that is running."""
    return version("dropflow")


def provenance(experiment: Experiment, parameters: Parameters, index: StackIndex) -> dict[str, Any]:
    """What made a result, as a JSON document."""
    return {
        "dropflow_version": code_version(),
        "parameters": parameters.model_dump(mode="json"),
        "experiment": experiment.model_dump(mode="json"),
        "input_sha256": index.sha256,
        "attachments_sha256": {file.name: file.sha256 for file in index.attachments},
        "n_frames": index.n_frames,
        "missing_frames": list(index.broken_frames),
        "units": UNITS,
    }


def content_key(*parts: Any) -> str:
    """Address of what a stage makes: the same parts give the same key, in any process and on any machine."""
    canonical = json.dumps([code_version(), *parts], sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()
