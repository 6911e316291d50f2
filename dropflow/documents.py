"""YAML or JSON documents read into strict models, with errors that name the field."""

from pathlib import Path
from typing import Any, TypeVar, get_args

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError, ValidationInfo, field_validator
from pydantic_core import ErrorDetails

from dropflow.errors import DropflowError, FieldProblem

Model = TypeVar("Model", bound=BaseModel)


class StrictModel(BaseModel):
    """A frozen document in which an unknown field, a non-finite number or `yes` for a number is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True)

    @field_validator("*", mode="before")
    @classmethod
    def _true_is_no_number(cls, value: Any, info: ValidationInfo) -> Any:
        """Refuse what Pydantic would read as 1; a text such as "1e-3", which YAML makes of 1e-3, stays a number."""
        if isinstance(value, bool) and not _takes_bool(cls.model_fields[str(info.field_name)].annotation):
            raise ValueError("Neither true nor false (in YAML also yes, no, on, off) is meant here")
        return value


def _takes_bool(annotation: Any) -> bool:
    return annotation in (bool, Any) or any(_takes_bool(part) for part in get_args(annotation))


def parse(model: type[Model], content: Any, error: type[DropflowError], *, file: str | None = None) -> Model:
    """Validate `content` (what YAML or JSON gave) as `model`; raise `error` naming each wrong field."""
    if not isinstance(content, dict):
        raise error("The document must be a mapping of fields.", file=file)
    try:
        return model.model_validate(content)
    except ValidationError as problem:
        raise error("Please correct:", file=file, fields=field_problems(problem)) from None


def load(model: type[Model], path: Path, error: type[DropflowError]) -> Model:
    """Read the YAML (or JSON) file at `path` as `model`."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as problem:
        raise error(f"The file cannot be read ({problem.strerror}).", file=str(path)) from None
    except (yaml.YAMLError, UnicodeDecodeError) as problem:
        reason = " ".join(str(problem).split())
        raise error(f"This is not valid YAML: {reason}", file=str(path)) from None
    return parse(model, content, error, file=str(path))


class FieldError(ValueError):
    """Raised by a validator that looks at several fields, to say which of them the user should change."""

    def __init__(self, field: str, message: str) -> None:
        super().__init__(message)
        self.field = field


def field_problems(problem: ValidationError) -> list[FieldProblem]:
    """Pydantic's findings as dotted fields.

    The branch names of unions, which begin with a capital, are no fields of the document and are left out.
    """
    return [_field_problem(found) for found in problem.errors(include_url=False)]


def _field_problem(found: ErrorDetails) -> FieldProblem:
    path = [str(part) for part in found["loc"] if not (isinstance(part, str) and part[:1].isupper())]
    cause = found.get("ctx", {}).get("error")
    if isinstance(cause, FieldError):
        path.append(cause.field)
    return FieldProblem(field=".".join(path), message=found["msg"].removeprefix("Value error, "))
