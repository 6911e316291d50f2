"""ETags: an answer that did not change is not sent again, and a change that was made to an old copy is refused.

Every JSON answer to a GET carries the checksum of its bytes. What can be edited has a tag of two parts,
`"DOCUMENT-ALL"`: `If-None-Match` compares both, `If-Match` the first alone, for the progress of a run makes no editor's
copy old.
"""

import hashlib
import json
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import Header
from pydantic import BaseModel
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from backend.platform.problems import ServiceError

_CHARACTERS = 20

IfMatch = Annotated[
    str | None,
    Header(
        max_length=1000,
        description="`ETag` of the copy that you changed: refused with 412 if somebody else changed it meanwhile.",
    ),
]


class ChangedMeanwhile(ServiceError):
    """Somebody else changed it after it was read."""

    status = HTTPStatus.PRECONDITION_FAILED

    def __init__(self) -> None:
        super().__init__(
            "It was changed by somebody else after you read it.",
            code="conflict.changed_meanwhile",
            hint="Read it again, and make your change to that.",
        )


def tag_of_bytes(*pieces: bytes) -> str:
    """A strong tag of what was or will be sent."""
    digest = hashlib.sha256()
    for piece in pieces:
        digest.update(piece)
    return f'"{digest.hexdigest()[:_CHARACTERS]}"'


def tag_of(document: Any, shown: BaseModel) -> str:
    """The tag of an answer that shows an editable document among other things."""
    return f'"{_document_part(document)}-{tag_of_bytes(shown.model_dump_json().encode())[1:-1]}"'


def check_unchanged(if_match: str | None, document: Any) -> None:
    """Raise `ChangedMeanwhile` unless `document` is still what the sender of `If-Match` had read."""
    if if_match is None or if_match.strip() == "*":
        return
    known = {tag.partition("-")[0] for tag in _tags(if_match)}
    if _document_part(document) not in known:
        raise ChangedMeanwhile


def is_known(if_none_match: str | None, tag: str) -> bool:
    """Whether whoever sent `If-None-Match` has this very answer."""
    if if_none_match is None:
        return False
    return if_none_match.strip() == "*" or tag.strip('"') in _tags(if_none_match)


def _tags(header: str) -> list[str]:
    return [tag.strip().removeprefix("W/").strip('"') for tag in header.split(",")]


def _document_part(document: Any) -> str:
    return tag_of_bytes(json.dumps(document, sort_keys=True).encode())[1:-1]


class TaggedAnswers:
    """Give every JSON answer to a GET its tag, and answer 304 to whoever has it already."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and scope["method"] == "GET":
            send = _Tagging(send, Headers(scope=scope).get("if-none-match")).send
        await self._app(scope, receive, send)


class _Tagging:
    """Holds back one answer until its tag is known."""

    def __init__(self, send: Send, if_none_match: str | None) -> None:
        self._send, self._if_none_match = send, if_none_match
        self._held: Message | None = None
        self._body = b""

    async def send(self, message: Message) -> None:
        if message["type"] == "http.response.start" and self._is_ours(message):
            self._held = message
        elif self._held is None:
            await self._send(message)
        else:
            self._body += message.get("body", b"")
            if not message.get("more_body", False):
                await self._send_tagged(self._held)

    @staticmethod
    def _is_ours(start: Message) -> bool:
        """JSON of known length, so that nothing that is streamed is ever gathered here."""
        headers = Headers(raw=start["headers"])
        is_json = headers.get("content-type", "").startswith("application/json")
        return start["status"] == HTTPStatus.OK and is_json and "accept-ranges" not in headers

    async def _send_tagged(self, start: Message) -> None:
        headers = MutableHeaders(raw=list(start["headers"]))
        headers.setdefault("ETag", tag_of_bytes(self._body))
        headers.setdefault("Cache-Control", "private, no-cache")
        if is_known(self._if_none_match, headers["etag"]):
            del headers["content-length"], headers["content-type"]
            start, self._body = {**start, "status": HTTPStatus.NOT_MODIFIED}, b""
        await self._send({**start, "headers": headers.raw})
        await self._send({"type": "http.response.body", "body": self._body})
