"""Tells webhooks."""

import json
import time
from datetime import datetime
from http import HTTPStatus
from uuid import UUID

from backend.models.base import Json
from backend.platform.outward import NotAllowed, Unreachable, post
from backend.platform.settings import Settings
from backend.platform.signatures import secret_of, signed
from worker.sending import Outcome


def send(
    settings: Settings, notice_id: UUID, address: str, salt: str, *, event: str, about: Json, at: datetime
) -> Outcome:
    """Try once."""
    body = body_of(settings, event, about, at)
    headers = {
        "content-type": "application/json",
        "user-agent": "Dropflow",
        **signed(secret_of(settings, salt), str(notice_id), int(time.time()), body),
    }
    try:
        status = post(address, body, headers, allowed=settings.outward_networks)
    except NotAllowed as problem:
        return Outcome(status=None, problem=f"the address {problem}", is_delivered=False, is_final=False)
    except Unreachable as problem:
        return Outcome(status=None, problem=str(problem), is_delivered=False, is_final=False)
    if HTTPStatus(200) <= status < HTTPStatus.MULTIPLE_CHOICES:
        return Outcome(status=status, problem=None, is_delivered=True, is_final=False)
    refusal = "redirects are not followed" if status < HTTPStatus.BAD_REQUEST else "it did not take the notice"
    # Whoever says that nothing is there any more, and never will be, is believed.
    return Outcome(status=status, problem=refusal, is_delivered=False, is_final=status == HTTPStatus.GONE)


def body_of(settings: Settings, event: str, about: Json, at: datetime) -> bytes:
    """What is sent; the same at every try."""
    data = dict(about)
    if "run" in about:
        data["address"] = f"{settings.address}runs/{about['run']['id']}"
    return json.dumps({"type": event, "timestamp": at.isoformat(), "data": data}, ensure_ascii=False).encode()
