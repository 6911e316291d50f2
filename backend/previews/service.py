"""Asking a worker, and waiting for its answer."""

import base64
import json
import time
from typing import Any, Literal
from uuid import UUID, uuid4

from backend.platform.dependencies import Platform
from backend.platform.object_store import experiment_prefix
from backend.platform.previews import PreviewRequest
from backend.platform.problems import Problem
from backend.platform.tracing import carrier
from backend.platform.visibility import Viewer
from backend.previews.errors import PreviewFailed, PreviewLate
from backend.previews.schemas import LinkPreview, LinkWish, Preview, PreviewWish, Suggestions
from backend.runs.service import get as get_run
from backend.stacks.errors import StackNotReady
from backend.stacks.service import with_frame
from dropflow.parameters import parse_parameters

PATIENCE_S = {"droplets": 20.0, "prepared": 20.0, "links": 45.0, "suggestions": 45.0}
LOOKS_PER_MINUTE, PREPARED_PER_MINUTE = 120, 900
"""Of one person, or of the visitors by one link: they must not take the workers from everybody else. To prepare a frame
costs a fraction of finding droplets in it, and who steps through a film has the next ones fetched ahead."""
_FIRST_LOOK_S, _LONGEST_PAUSE_S = 0.02, 0.2


def droplets(platform: Platform, viewer: Viewer, experiment_id: UUID, wish: PreviewWish) -> Preview:
    """What detection finds in a frame."""
    about = wish.model_dump(exclude={"region"}) | {"region": wish.region}
    return Preview.model_validate(_ask(platform, viewer, experiment_id, "droplets", about))


def of_run(platform: Platform, viewer: Viewer, run_id: UUID, frame: int, *, is_picture_wanted: bool) -> Preview:
    """What a run saw in a frame, looked at once more: rejected candidates are not kept."""
    with platform.sessions.begin() as session:
        run = get_run(session, viewer, run_id)
        experiment_id, document = run.experiment_id, run.document
        about = {"frame": frame, "parameters": run.parameters, "is_picture_wanted": is_picture_wanted}
    return Preview.model_validate(_ask(platform, viewer, experiment_id, "droplets", about | {"document": document}))


def prepared(platform: Platform, viewer: Viewer, run_id: UUID, frame: int) -> bytes:
    """A frame as the detection of a run saw it, as a JPEG."""
    with platform.sessions.begin() as session:
        run = get_run(session, viewer, run_id)
        experiment_id, document, parameters = run.experiment_id, run.document, run.parameters
    about = {"frame": frame, "parameters": parameters, "document": document}
    return base64.b64decode(_ask(platform, viewer, experiment_id, "prepared", about)["jpeg"])


def links(platform: Platform, viewer: Viewer, experiment_id: UUID, wish: LinkWish) -> LinkPreview:
    """How the droplets of a frame are followed into the next."""
    return LinkPreview.model_validate(_ask(platform, viewer, experiment_id, "links", wish.model_dump()))


def suggestions(platform: Platform, viewer: Viewer, experiment_id: UUID) -> Suggestions:
    """What the frames themselves speak for."""
    return Suggestions.model_validate(_ask(platform, viewer, experiment_id, "suggestions", {}))


def _ask(
    platform: Platform,
    viewer: Viewer,
    experiment_id: UUID,
    kind: Literal["droplets", "prepared", "links", "suggestions"],
    about: dict[str, Any],
) -> Any:
    """Send a request and wait; no transaction is open meanwhile."""
    who = str(viewer.person_id or viewer.share_id)
    if kind == "prepared":
        platform.rates.count("prepared frames", who, PREPARED_PER_MINUTE)
    else:
        platform.rates.count("looks at frames", who, LOOKS_PER_MINUTE)
    with platform.sessions.begin() as session:
        experiment = with_frame(session, viewer, experiment_id, about.get("frame", 0))
        if experiment.stack.index_key is None:  # nothing that a worker could look at
            raise StackNotReady
    parse_parameters(about.get("parameters", {}))
    key = f"{experiment_prefix(experiment_id)}previews/{uuid4()}.json"
    platform.queue.preview(
        PreviewRequest(
            kind=kind,
            experiment_id=experiment_id,
            answer_key=key,
            asked_at_s=time.time(),
            trace=carrier(),
            **about,
        )
    )
    answer = _await(platform, key, PATIENCE_S[kind])
    if "problem" in answer:
        raise PreviewFailed(Problem.model_validate(answer["problem"]))
    return answer["found"]


def _await(platform: Platform, key: str, patience_s: float) -> dict[str, Any]:
    until_s, pause_s = time.monotonic() + patience_s, _FIRST_LOOK_S
    while time.monotonic() < until_s:
        time.sleep(pause_s)
        pause_s = min(1.2 * pause_s, _LONGEST_PAUSE_S)
        try:
            content = platform.store.read(key)
        except FileNotFoundError:
            continue
        platform.store.remove(key)
        answer: dict[str, Any] = json.loads(content)
        return answer
    raise PreviewLate
