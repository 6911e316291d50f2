"""/schemas: what the page draws its forms from, made from the library's own models."""

from typing import Any

from fastapi import APIRouter

from dropflow.experiment import Experiment
from dropflow.parameters import Parameters
from dropflow.physics.material_files import known_names

router = APIRouter(prefix="/schemas", tags=["schemas"])


@router.get("/experiment")
def schemas_get_experiment() -> dict[str, Any]:
    """Get the JSON Schema of an experiment's document, with the names of the known materials as examples."""
    schema = Experiment.model_json_schema()
    for choice in schema["properties"]["material"]["oneOf"]:
        if choice.get("type") == "string":
            choice["examples"] = list(known_names())
    return schema


@router.get("/parameters")
def schemas_get_parameters() -> dict[str, Any]:
    """Get the JSON Schema of a run's parameters: default, unit, range and the paper's value of each."""
    return Parameters.model_json_schema()
