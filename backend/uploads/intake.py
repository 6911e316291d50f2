"""Telling the bytes of an upload apart by file: each one's beginning is looked at, and each is summed up."""

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Sequence
from itertools import accumulate
from typing import Protocol
from uuid import UUID

from backend.stacks.content import check_kind
from backend.uploads.schemas import Announced
from dropflow.frames.kinds import HEAD_BYTES


class _Digest(Protocol):
    def update(self, content: memoryview, /) -> None: ...
    def hexdigest(self) -> str: ...


class Intake:
    """Takes the bytes of an upload in their order, from any byte on.

    Of a file of which it saw all bytes it knows the checksum; of others (the service was started anew in between)
    whoever finishes the upload reads them again.
    """

    def __init__(self, files: Sequence[Announced], at_byte: int = 0) -> None:
        self._files, self.at_byte = files, at_byte
        self._ends = list(accumulate(file.size_bytes for file in files))
        self.sha256: dict[int, str] = {}
        self._number = next((number for number, end in enumerate(self._ends) if at_byte < end), len(files))
        self._digest: _Digest | None = None
        self._head: bytes | None = None
        if self._left() == self._size():
            self._begin()

    def take(self, content: memoryview) -> None:
        """The next bytes. Raises `WrongKind` if a file begins as none of its role does."""
        while content:
            part, content = content[: self._left()], content[self._left() :]
            if self._digest is not None:
                self._digest.update(part)
            self.at_byte += len(part)
            is_over = self._left() == 0
            if self._head is not None:
                self._look(part, is_over=is_over)
            if is_over:
                self._end()

    def _look(self, part: memoryview, *, is_over: bool) -> None:
        assert self._head is not None  # noqa: S101 - asked by the caller
        self._head += bytes(part[: HEAD_BYTES - len(self._head)])
        if is_over or len(self._head) == HEAD_BYTES:
            file = self._files[self._number]
            check_kind(self._head, file.name, file.role)
            self._head = None

    def _end(self) -> None:
        if self._digest is not None:
            self.sha256[self._number] = self._digest.hexdigest()
        self._number += 1
        if self._number < len(self._files):
            self._begin()

    def _begin(self) -> None:
        self._digest, self._head = hashlib.sha256(), b""

    def _left(self) -> int:
        return self._ends[self._number] - self.at_byte if self._number < len(self._ends) else 0

    def _size(self) -> int:
        return self._files[self._number].size_bytes if self._number < len(self._files) else -1


class Intakes:
    """Intakes of uploads between two requests. They save reading again, and may be forgotten at any moment."""

    def __init__(self, most: int = 500) -> None:
        self._most, self._kept = most, OrderedDict[UUID, Intake]()
        self._lock = threading.Lock()

    def take(self, upload_id: UUID, files: Sequence[Announced], at_byte: int) -> Intake:
        """The intake that stands at this byte; whoever takes it has it alone."""
        with self._lock:
            kept = self._kept.pop(upload_id, None)
        return kept if kept is not None and kept.at_byte == at_byte else Intake(files, at_byte)

    def keep(self, upload_id: UUID, intake: Intake) -> None:
        """For the next request."""
        with self._lock:
            self._kept[upload_id] = intake
            while len(self._kept) > self._most:
                self._kept.popitem(last=False)
