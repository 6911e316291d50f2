"""Why a stage was done anew and not taken over from the run before: pure, from what went into both."""

from collections.abc import Iterator
from typing import Any

from backend.models import Run, Stage
from backend.runs.schemas import Cause, Difference, StageName, StageReuse

_SAYS_NOTHING_OF_FRAMES = {"name", "notes", "tags", "recorded_at"}
"""Fields of the experiment that are for people alone; what is made of the whole film carries them with it."""


def stage_reuse(stage: Stage, n_reused: int, run: Run, before: Run | None, made: set[str]) -> StageReuse:
    """What a stage of `run` took over, and what differs from `before`, all of whose stages `made` are there."""
    is_all = n_reused >= stage.total_frames
    differences = [] if is_all or before is None else list(differing(StageName(stage.name), run, before))
    if not is_all and before is not None and not differences and stage.name not in made:
        differences = [Difference(cause=Cause.NOT_THERE)]
    return StageReuse(
        name=StageName(stage.name),
        total_frames=stage.total_frames,
        reused_frames=n_reused,
        differences=differences,
    )


def differing(stage: StageName, run: Run, before: Run) -> Iterator[Difference]:
    """What goes into a stage and is not the same in both runs."""
    if run.stack_checksum and before.stack_checksum and run.stack_checksum != before.stack_checksum:
        yield Difference(cause=Cause.FRAMES, before=before.stack_checksum[:12], now=run.stack_checksum[:12])
    if run.source_digest and before.source_digest and run.source_digest != before.source_digest:
        yield Difference(cause=Cause.CODE, before=before.version, now=run.version)
    is_detect = stage is StageName.DETECT
    parameters = [_only_detection(found.parameters) if is_detect else found.parameters for found in (before, run)]
    yield from _unlike(Cause.PARAMETER, *parameters)
    documents = [_of_frames(found.document) if is_detect else found.document for found in (before, run)]
    yield from _unlike(Cause.EXPERIMENT, *documents)


def _only_detection(parameters: dict[str, Any]) -> dict[str, Any]:
    return {"detection": parameters.get("detection", {})}


def _of_frames(document: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in document.items() if name not in _SAYS_NOTHING_OF_FRAMES}


def _unlike(cause: Cause, before: dict[str, Any], now: dict[str, Any]) -> Iterator[Difference]:
    old, new = dict(_flat(before)), dict(_flat(now))
    for field in sorted(old.keys() | new.keys()):
        if old.get(field) != new.get(field):
            yield Difference(cause=cause, field=field, before=old.get(field), now=new.get(field))


def _flat(document: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in document.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value
