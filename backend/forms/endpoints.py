"""/schemas: what the page draws its forms from, made from the library's own models."""

from typing import Any

from fastapi import APIRouter

from dropflow.experiment import Experiment
from dropflow.parameters import Parameters

router = APIRouter(prefix="/schemas", tags=["schemas"])


@router.get("/experiment")
def schemas_get_experiment() -> dict[str, Any]:
    """Get the JSON Schema of an experiment's document."""
    return Experiment.model_json_schema()


@router.get("/parameters")
def schemas_get_parameters() -> dict[str, Any]:
    """Get the JSON Schema of a run's parameters: default, unit, range and the paper's value of each."""
    return Parameters.model_json_schema()
