"""Uploads as a client makes them: plan, then send what the plan says."""

import socket
from collections.abc import Sequence
from typing import Any

import httpx

from tests.films import Upload
from tests.house import House, Json

TUS = {"Tus-Resumable": "1.0.0"}
BYTES = {**TUS, "Content-Type": "application/offset+octet-stream"}


def plan(house: House, experiment: Json, files: Sequence[Upload], **about: Any) -> Json:
    """What is to be sent of these files."""
    return house.ok(house.api.post(f"experiments/{experiment['id']}/uploads/plan", json=announced(files, **about)))


def announced(files: Sequence[Upload], **about: Any) -> Json:
    """The request for a plan."""
    return {"files": [{"name": f.name, "size_bytes": len(f.content), "role": f.role, **about} for f in files]}


def content_of(upload: Json, files: Sequence[Upload]) -> bytes:
    """The bytes of a planned upload."""
    return b"".join(files[index].content for index in upload["files"])


def patch(
    house: House, location: str, offset_bytes: int, content: bytes, headers: dict[str, str] | None = None
) -> httpx.Response:
    """Send bytes from an offset on."""
    return house.api.patch(
        location, content=content, headers={**BYTES, "Upload-Offset": str(offset_bytes), **(headers or {})}
    )


def offset(house: House, location: str) -> int:
    """How many bytes the server says it has."""
    answer = house.api.head(location, headers=TUS)
    assert answer.status_code == 200
    return int(answer.headers["Upload-Offset"])


def send_all(house: House, experiment: Json, files: Sequence[Upload]) -> Json:
    """Plan and send everything; returns the plan."""
    planned = plan(house, experiment, files)
    for upload in planned["uploads"]:
        content = content_of(upload, files)[upload["offset_bytes"] :]
        answer = patch(house, upload["location"], upload["offset_bytes"], content)
        assert answer.status_code == 204, answer.text
    return planned


def cut_patch(house: House, location: str, offset_bytes: int, content: bytes, n_sent: int) -> None:
    """Begin to send `content`, and vanish after `n_sent` bytes."""
    url = house.api.base_url
    with socket.create_connection((url.host, url.port or 80)) as connection:
        connection.sendall(
            f"PATCH {url.path}{location} HTTP/1.1\r\nHost: {url.host}\r\nTus-Resumable: 1.0.0\r\n"
            f"Upload-Offset: {offset_bytes}\r\nContent-Type: application/offset+octet-stream\r\n"
            f"Content-Length: {len(content)}\r\n\r\n".encode()
            + content[:n_sent]
        )
