"""Every error that a user can cause or meet, as one tree.

    DropflowError
    |-- ExperimentError     experiment.*   a field of experiment.yaml
    |-- ParametersError     parameters.*   a field of the parameters
    |-- FramesError         frames.*       a stack, a file or a frame (also a ValueError)
    |-- ResultsError        results.*      a folder or table of results
    `-- Cancelled           run.cancelled  raised by a progress callback to stop long work

An error carries a stable code, what happened, where (file, frame, field) and what to do. It is raised deep and
rendered once: one line and exit code 2 on the command line, problem+json over HTTP, beside the field on the page.
"""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class FieldProblem:
    """What is wrong with one field of a document. `field` is a dotted path, e.g. ``material.viscosity_pa_s``."""

    field: str
    message: str


class DropflowError(Exception):
    """Base of all expected errors. `code` is stable, `hint` says what to do."""

    default_code = "dropflow.error"

    def __init__(
        self,
        message: str,
        *,
        code: str | None = None,
        file: str | None = None,
        frame: int | None = None,
        fields: Sequence[FieldProblem] = (),
        hint: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.code = code or self.default_code
        self.file = file
        self.frame = frame
        self.fields = tuple(fields)
        self.hint = hint

    def __str__(self) -> str:
        """One line: what, where, what to do."""
        where = [part for part in (self.file, None if self.frame is None else f"frame {self.frame}") if part]
        text = f"{', '.join(where)}: {self.message}" if where else self.message
        if self.fields:
            text += " " + "; ".join(f"{problem.field}: {problem.message}" for problem in self.fields)
        return f"{text} {self.hint}" if self.hint else text

    def __reduce__(self) -> tuple[object, ...]:
        """Keep every part when the error crosses a process border (keyword arguments are lost otherwise)."""
        return _rebuild, (type(self), self.message, self.code, self.file, self.frame, self.fields, self.hint)


def _rebuild(
    kind: type[DropflowError],
    message: str,
    code: str,
    file: str | None,
    frame: int | None,
    fields: tuple[FieldProblem, ...],
    hint: str | None,
) -> DropflowError:
    return kind(message, code=code, file=file, frame=frame, fields=fields, hint=hint)


class ExperimentError(DropflowError, ValueError):
    """The experiment's description is wrong."""

    default_code = "experiment.invalid"


class ParametersError(DropflowError, ValueError):
    """A parameter is wrong, or does not fit the frames."""

    default_code = "parameters.invalid"


class FramesError(DropflowError, ValueError):
    """A stack, a file of it or one of its frames cannot be used."""

    default_code = "frames.unreadable"


class ResultsError(DropflowError, ValueError):
    """A folder or a table of results is missing, incomplete or of another kind."""

    default_code = "results.invalid"


class Cancelled(DropflowError):  # noqa: N818 - a request, not an error
    """Somebody asked for long work to stop."""

    default_code = "run.cancelled"
