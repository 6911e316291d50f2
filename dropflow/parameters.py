"""Every knob of an analysis, once: the form on the page, the API, the command line and the docs are made from here.

Each field says its unit, its meaning (the docstring below it), the paper's value and section, and a sensible range.
"""

from enum import StrEnum
from pathlib import Path
from typing import Any

from pydantic import Field, model_validator

from dropflow import documents
from dropflow.documents import StrictModel
from dropflow.errors import ParametersError


def knob(default: Any, *, unit: str, low: float, high: float, paper: Any = None, section: str = "") -> Any:
    """A numeric field between `low` and `high` that carries its unit, the paper's value and where the paper says it."""
    about = {"unit": unit, "paper_value": paper, "paper_section": section}
    return Field(default=default, ge=low, le=high, json_schema_extra=about)


class Method(StrEnum):
    """Whose chain does the work."""

    PAPER = "paper"


class DetectionParameters(StrictModel):
    """How droplets are found in one frame (sections 3.1.1 to 3.1.3)."""

    method: Method = Method.PAPER
    """`paper` follows sections 3.1.1 to 3.1.3."""
    radius_min_um: float = knob(4.0, unit="um", low=1e-3, high=1e5, paper=4.0, section="3.2.1")
    """Smallest droplet radius looked for."""
    radius_max_um: float = knob(40.0, unit="um", low=1e-3, high=1e5, paper=40.0, section="3.2.1")
    """Largest droplet radius looked for."""

    @model_validator(mode="after")
    def _radii_in_order(self) -> "DetectionParameters":
        if self.radius_min_um >= self.radius_max_um:
            raise ValueError("radius_min_um must be smaller than radius_max_um")
        return self


class TrackingParameters(StrictModel):
    """How droplets are followed from frame to frame (sections 3.2.1 and 3.3)."""

    method: Method = Method.PAPER
    """`paper` follows sections 3.2.1 and 3.3."""


class FlowParameters(StrictModel):
    """How the flow field is computed from droplets (sections 3.2.2 and 3.2.3)."""

    n_columns: int = knob(25, unit="cells", low=2, high=1000, paper=25, section="3.2.2")
    """Cells of the grid along x."""
    n_rows: int = knob(20, unit="cells", low=2, high=1000, paper=20, section="3.2.2")
    """Cells of the grid along y."""


class Parameters(StrictModel):
    """All knobs of one run."""

    detection: DetectionParameters = DetectionParameters()
    """Finding droplets in single frames."""
    tracking: TrackingParameters = TrackingParameters()
    """Following droplets through frames."""
    flow: FlowParameters = FlowParameters()
    """The flow field between frames."""


def parse_parameters(content: Any, *, file: str | None = None) -> Parameters:
    """Validate a document that was read from YAML or JSON; raise `ParametersError` naming each wrong field."""
    return documents.parse(Parameters, content, ParametersError, file=file)


def load_parameters(path: Path) -> Parameters:
    """Read a parameters file (YAML or JSON)."""
    return documents.load(Parameters, path, ParametersError)
