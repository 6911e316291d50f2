"""Sending files: by plan and tus 1.0, so that what was sent stays sent; to a server of version 1.0 file by file."""

import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any
from uuid import UUID

import httpx

from dropflow.client.connection import Connection, Json, pause_s
from dropflow.client.errors import ClientError, Damaged, NotReachable, ServerProblem
from dropflow.client.films import FilmFile, pieces_of
from dropflow.client.versions import Capability
from dropflow.progress import Progress

PLANNED_AT_ONCE = 1000
REQUEST_BYTES = 64 << 20
N_AT_ONCE = 3
N_TRIES = 12
STAGE = "upload"
_TUS = {"Tus-Resumable": "1.0.0"}
_AGAIN = frozenset({409, 423, 429, 460, 500, 502, 503, 504})
"""Answers to sent bytes after which one asks how much is there, and goes on."""


def send_files(connection: Connection, experiment_id: UUID, files: Sequence[FilmFile], progress: Progress) -> None:
    """Send what the server has not yet; afterwards it has every file, and each is what it is here."""
    if not connection.can(Capability.RESUMABLE_UPLOADS):
        _send_one_by_one(connection, experiment_id, files, progress)
        return
    counter = _Counter(progress, total=sum(file.size_bytes for file in files))
    for start in range(0, len(files), PLANNED_AT_ONCE):
        _send_planned(connection, experiment_id, files[start : start + PLANNED_AT_ONCE], counter)


class _Counter:
    """Bytes that are on the server, of all; several threads count."""

    def __init__(self, progress: Progress, *, total: int) -> None:
        self._progress, self._total, self._done = progress, total, 0
        self._lock = threading.Lock()

    def add(self, n_bytes: int) -> None:
        with self._lock:
            self._done += n_bytes
            self._progress(STAGE, min(self._done, self._total), self._total)


def _send_planned(connection: Connection, experiment_id: UUID, files: Sequence[FilmFile], counter: _Counter) -> None:
    checksums: dict[int, str] = {}
    counted = False
    for _ in range(N_TRIES):
        plan = _plan(connection, experiment_id, files, checksums)
        differing = _differing(plan, files)
        if not counted:
            counter.add(sum(files[found["file"]].size_bytes for found in plan["present"]))
            counted = True
        if not plan["uploads"] and not differing:
            return
        checksums |= differing
        with ThreadPoolExecutor(N_AT_ONCE) as pool:
            sending = [pool.submit(_Sender(connection, upload, files, counter).send) for upload in plan["uploads"]]
            for sent in sending:
                sent.result()
    raise Damaged("The files on the server are not those that were sent.", hint="Do they change while they are sent?")


def _plan(connection: Connection, experiment_id: UUID, files: Sequence[FilmFile], checksums: dict[int, str]) -> Json:
    """What is to be sent. Planning twice is planning once, so that trying again is harmless."""
    announced = [
        {"name": file.name, "size_bytes": file.size_bytes, "role": file.role, "sha256": checksums.get(index)}
        for index, file in enumerate(files)
    ]
    path = f"experiments/{experiment_id}/uploads/plan"
    found: Json = connection.trying(lambda: connection.once("POST", path, json={"files": announced})).json()
    return found


def _differing(plan: Json, files: Sequence[FilmFile]) -> dict[int, str]:
    """Checksums of files that the server has with other content."""
    ours = {found["file"]: files[found["file"]].sha256() for found in plan["present"]}
    return {found["file"]: ours[found["file"]] for found in plan["present"] if found["sha256"] != ours[found["file"]]}


class _Sender:
    """Sends the bytes of one upload: those of its files, one after the other."""

    def __init__(self, connection: Connection, upload: Json, files: Sequence[FilmFile], counter: _Counter) -> None:
        self._connection, self._counter = connection, counter
        self._location: str = upload["location"]
        self._files = [files[index] for index in upload["files"]]
        self._size_bytes: int = upload["size_bytes"]
        self._offset: int = upload["offset_bytes"]
        counter.add(self._offset)

    def send(self) -> None:
        """Send until the server has all of it, however often the connection is cut."""
        n_failures = 0
        while self._offset < self._size_bytes:
            before = self._offset
            try:
                self._send_some()
            except (ServerProblem, NotReachable) as problem:
                if isinstance(problem, ServerProblem) and problem.status == 404:
                    return  # it is complete, or expired: the next plan says which
                n_failures = 1 if self._offset > before else n_failures + 1
                if n_failures == N_TRIES or (isinstance(problem, ServerProblem) and problem.status not in _AGAIN):
                    raise
                time.sleep(pause_s(n_failures))
                self._look()

    def _send_some(self) -> None:
        stop = min(self._offset + REQUEST_BYTES, self._size_bytes)
        headers = {
            **_TUS,
            "Upload-Offset": str(self._offset),
            "Content-Type": "application/offset+octet-stream",
            "Content-Length": str(stop - self._offset),
        }
        with self._connection.stream("PATCH", self._location, content=self._bytes(stop), headers=headers) as answer:
            self._arrived(answer)

    def _look(self) -> None:
        """Ask how much is there. An upload that is gone is left to the next plan."""
        try:
            self._arrived(self._connection.request("HEAD", self._location, headers=_TUS))
        except ServerProblem as problem:
            if problem.status != 404:
                raise
            self._offset = self._size_bytes

    def _arrived(self, answer: httpx.Response) -> None:
        offset = int(answer.headers["Upload-Offset"])
        self._counter.add(offset - self._offset)
        self._offset = offset

    def _bytes(self, stop: int) -> Iterator[bytes]:
        at = 0
        for file in self._files:
            first, last = max(self._offset, at) - at, min(stop, at + file.size_bytes) - at
            if first < last:
                yield from _exactly(file, first, last)
            at += file.size_bytes


def _exactly(file: FilmFile, start: int, stop: int) -> Iterator[bytes]:
    n_bytes = 0
    for piece in pieces_of(file.path, start, stop):
        n_bytes += len(piece)
        yield piece
    if n_bytes != stop - start:
        raise ClientError("The file became shorter while it was sent.", code="client.file_changed", file=str(file.path))


def _send_one_by_one(
    connection: Connection, experiment_id: UUID, files: Sequence[FilmFile], progress: Progress
) -> None:
    """As the first version takes files: whole, one a request; those that are there are not sent again."""
    path = f"experiments/{experiment_id}/files"
    there = {(found["role"], found["name"]): found["sha256"] for found in connection.pages(path)}
    counter = _Counter(progress, total=sum(file.size_bytes for file in files))
    for file in files:
        if there.get(file.key) != (checksum := file.sha256()):
            about: dict[str, Any] = {"name": file.name, "role": file.role}
            answer = connection.trying(lambda file=file, about=about: _put(connection, path, file, about))  # type: ignore[misc]
            if answer.json()["sha256"] != checksum:
                raise Damaged("What arrived is not what was sent.", file=str(file.path), hint="Send it again.")
        counter.add(file.size_bytes)


def _put(connection: Connection, path: str, file: FilmFile, about: dict[str, Any]) -> httpx.Response:
    headers = {"Content-Length": str(file.size_bytes), "Content-Type": "application/octet-stream"}
    return connection.once("PUT", path, params=about, content=pieces_of(file.path), headers=headers)
