"""Webhooks that are made, runs that end, and notices that are sent of it."""

from concurrent.futures import ThreadPoolExecutor
from uuid import UUID

import httpx
from sqlalchemy import func, update

from backend.models import Notice, Run
from backend.models.lifecycle import end_run
from backend.models.states import RunState
from tests.house import Json
from tests.lab import Lab
from tests.receiver import Receiver
from worker.context import Context
from worker.notices import tell_round


def made(browser: httpx.Client, group: UUID, receiver: Receiver, **about: object) -> Json:
    answer = browser.post(f"groups/{group}/webhooks", json={"address": receiver.address, **about})
    assert answer.status_code == 201, answer.text
    body: Json = answer.json()
    return body


def ended(lab: Lab, group: UUID, how: str, person: UUID | None = None) -> UUID:
    """A run that ends just now."""
    _, run_id = lab.finished(group)
    with lab.house.context.sessions.begin() as session:
        run = session.get_one(Run, run_id)
        run.state, run.person_id = RunState.RUNNING, person
        session.flush()
        problem = {"detail": "Frame 3 cannot be read.", "hint": "Replace it.", "code": "frames.corrupt"}
        end_run(session, run, how, problem=problem if how == "fail" else None)
    return run_id


def told(context: Context) -> int:
    """Send what is due; how many that were."""
    with ThreadPoolExecutor(4) as pool:
        return tell_round(context, pool)


def make_due(lab: Lab) -> None:
    """Let the pause after a failure pass."""
    with lab.house.context.sessions.begin() as session:
        session.execute(update(Notice).values(due_at=func.now(), held_until=None))


def log_of(browser: httpx.Client, group: UUID, webhook: Json) -> list[Json]:
    answer = browser.get(f"groups/{group}/webhooks/{webhook['id']}/notices")
    assert answer.status_code == 200, answer.text
    items: list[Json] = answer.json()["items"]
    return items
