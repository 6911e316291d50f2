"""Task preview: a look at what an analysis would do, for somebody who moves a knob and waits."""

import json
import time
from dataclasses import asdict
from typing import Any

import structlog

from backend.platform.previews import LONGEST_WAIT_S, PreviewRequest
from backend.platform.problems import Problem, problem_of
from backend.platform.tracing import span, went_wrong
from dropflow.errors import DropflowError
from dropflow.parameters import parse_parameters
from dropflow.suggest import suggest
from worker.context import Context
from worker.preview_droplets import found_in, picture
from worker.preview_films import films
from worker.preview_links import followed

log = structlog.get_logger()

_UNEXPECTED = Problem(
    title="Internal Server Error",
    status=500,
    code="service.internal",
    detail="Something went wrong here that was not expected. It was written to the worker's log.",
)


def answer(context: Context, request: PreviewRequest) -> None:
    """Put what was found, or the problem, where it is waited for."""
    if time.time() - request.asked_at_s > LONGEST_WAIT_S:
        return
    about = {"experiment": request.experiment_id, "frame": request.frame}
    with span(f"preview {request.kind}", about, follows=request.trace):
        _answer(context, request)


def _answer(context: Context, request: PreviewRequest) -> None:
    began_s = time.monotonic()
    try:
        content: dict[str, Any] = {"found": _found(context, request)}
    except DropflowError as error:
        content = {"problem": problem_of(error).model_dump(mode="json")}
    except Exception as error:
        went_wrong(error)
        # Whoever waits is told at once; the log has the trace.
        log.exception("preview failed", kind=request.kind, experiment=str(request.experiment_id))
        content = {"problem": _UNEXPECTED.model_dump(mode="json")}
    context.store.put(request.answer_key, json.dumps(content, allow_nan=False).encode())
    log.info("preview answered", kind=request.kind, took_s=round(time.monotonic() - began_s, 3))


def _found(context: Context, request: PreviewRequest) -> dict[str, Any]:
    film = films.get(context, request.experiment_id, request.document)
    parameters = parse_parameters(request.parameters)
    match request.kind:
        case "droplets":
            return found_in(film, request, parameters)
        case "prepared":
            return {"jpeg": picture(film.prepared(parameters, request.frame))}
        case "links":
            return followed(film, request.frame, parameters)
        case "suggestions":
            return asdict(suggest(film.frames, film.experiment, flat_field=film.flat_field))
