"""Files beside the frames: the document names them, the upload brings them, and both must agree."""

from collections.abc import Iterable, Mapping
from typing import Any

from backend.stacks.schemas import Role
from dropflow.errors import FieldProblem

ROLES = tuple(role for role in Role if role is not Role.FRAMES)


def disagreements(document: Mapping[str, Any], uploaded: Iterable[tuple[str, str]]) -> list[FieldProblem]:
    """What is wrong between the files an experiment names and those that came, given as (role, name)."""
    came = list(uploaded)
    problems = []
    for role in ROLES:
        wanted = document.get(role)
        names = [name for found, name in came if found == role]
        if wanted is None and names:
            problems.append(FieldProblem(role, f"the file {names[0]} was uploaded but is not named here"))
        elif wanted is not None and names != [wanted]:
            others = f" ({', '.join(names)} was)" if names else ""
            problems.append(FieldProblem(role, f"the file {wanted} was not uploaded{others}"))
    return problems
