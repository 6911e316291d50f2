"""Downloads: streamed, resumable by `Range` and `If-Range`, checked by a digest, with any name a file may have."""

import base64
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any
from urllib.parse import quote

from fastapi import Request
from fastapi.responses import Response, StreamingResponse

from backend.platform.entity_tags import is_known
from backend.platform.media import ANYTHING
from backend.platform.problems import ServiceError, problem_of, problem_response, responses

_RANGE = re.compile(r"bytes=(\d{0,18})-(\d{0,18})")
_UNSAFE = re.compile(r'[^\x20-\x7e]|["\\%]')


class NoSuchRange(ServiceError):
    """The file ends before the range begins."""

    default_code = "request.range_not_satisfiable"
    status = HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE


@dataclass(frozen=True)
class Download:
    """Something that does not change: its `tag` names these very bytes. `read(start, stop)` streams a part."""

    name: str
    media_type: str
    size_bytes: int
    tag: str
    read: Callable[[int, int], Iterator[bytes]]
    sha256: str | None = None
    """Hexadecimal, where it is known."""


RESPONSES: dict[int | str, dict[str, Any]] = {
    200: {"content": {ANYTHING: {}}, "description": "The file."},
    206: {"content": {ANYTHING: {}}, "description": "The part of it that `Range` asked for."},
    304: {"description": "You have it: it is the one that `If-None-Match` names."},
    **responses(NoSuchRange),
}
"""What an endpoint that ends in `answer` says of it in the OpenAPI document."""


def answer(request: Request, download: Download) -> Response:
    """The file or the one part that is asked for. Several parts at once, or a strange `Range`, answer the whole."""
    headers = _headers(download)
    if is_known(request.headers.get("if-none-match"), download.tag):
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    start, stop, status = 0, download.size_bytes, HTTPStatus.OK
    if (asked := _range(request, download)) is not None:
        start, stop = asked
        if start >= stop:
            problem = problem_of(NoSuchRange(f"The file has {download.size_bytes} bytes."))
            return problem_response(problem, {"Content-Range": f"bytes */{download.size_bytes}"})
        status = HTTPStatus.PARTIAL_CONTENT
        headers["Content-Range"] = f"bytes {start}-{stop - 1}/{download.size_bytes}"
    headers["Content-Length"] = str(stop - start)
    return StreamingResponse(download.read(start, stop), status, headers, download.media_type)


def _headers(download: Download) -> dict[str, str]:
    headers = {
        "Accept-Ranges": "bytes",
        "Cache-Control": "private, no-cache",
        "Content-Disposition": content_disposition(download.name),
        "ETag": download.tag,
        "X-Content-Type-Options": "nosniff",
    }
    if download.sha256 is not None:
        headers["Repr-Digest"] = f"sha-256=:{base64.b64encode(bytes.fromhex(download.sha256)).decode()}:"
    return headers


def content_disposition(name: str) -> str:
    """`attachment` under the last part of `name`: for every program in ASCII, for those that can in UTF-8."""
    last = name.rsplit("/", 1)[-1]
    plain = _UNSAFE.sub("_", last)
    encoded = f"; filename*=UTF-8''{quote(last, safe='')}" if plain != last else ""
    return f'attachment; filename="{plain}"{encoded}'


def _range(request: Request, download: Download) -> tuple[int, int] | None:
    """First byte and the one after the last; None for the whole file. An empty one cannot be had."""
    said = _RANGE.fullmatch(request.headers.get("range", "").replace(" ", ""))
    if said is None or said.groups() == ("", ""):
        return None
    if request.headers.get("if-range", download.tag) != download.tag:
        return None  # the asker has a part of something else
    first, last = said.groups()
    if not first:
        return max(0, download.size_bytes - int(last)), download.size_bytes
    if last and int(last) < int(first):
        return None
    return int(first), min(int(last) + 1 if last else download.size_bytes, download.size_bytes)
