"""The bytes of an upload as they come in: counted, checksummed and looked at, never held."""

import hashlib
from collections.abc import AsyncIterator

from backend.stacks.errors import EmptyFile, TooLarge, WrongKind
from backend.stacks.schemas import Role
from dropflow.frames.kinds import HEAD_BYTES, KINDS, STILLS, WHAT_TO_GIVE, kind_of

_KINDS_OF_ROLE = {Role.FRAMES: KINDS, Role.FLAT_FIELD: STILLS | {"tiff"}}


class Content:
    """One upload on its way. Iterate it once; then `size_bytes` and `sha256` are known."""

    def __init__(self, source: AsyncIterator[bytes], *, name: str, role: Role, max_bytes: int, limit: str) -> None:
        self._source, self._name, self._role = source, name, role
        self._max_bytes, self._limit = max_bytes, limit
        self._digest = hashlib.sha256()
        self.size_bytes = 0

    @property
    def sha256(self) -> str:
        """Of what came so far."""
        return self._digest.hexdigest()

    async def __aiter__(self) -> AsyncIterator[bytes]:
        head: bytes | None = b""
        async for chunk in self._source:
            self._count(chunk)
            if head is not None:
                head += chunk
                if len(head) < HEAD_BYTES:
                    continue
                check_kind(head, self._name, self._role)
                yield head
                head = None
            elif chunk:
                yield chunk
        if head is not None:
            if not head:
                raise EmptyFile(self._name)
            check_kind(head, self._name, self._role)
            yield head

    def _count(self, chunk: bytes) -> None:
        self.size_bytes += len(chunk)
        if self.size_bytes > self._max_bytes:
            raise TooLarge(self._limit, self._max_bytes, self._name)
        self._digest.update(chunk)


def check_kind(head: bytes, name: str, role: Role) -> None:
    """Refuse a file whose first bytes are not those of what `role` needs. The name says nothing."""
    if role in _KINDS_OF_ROLE:
        if kind_of(head) not in _KINDS_OF_ROLE[role]:
            raise WrongKind(
                name,
                code="frames.not_an_image",
                message="This file is not an image or film.",
                hint=WHAT_TO_GIVE,
            )
    elif b"\0" in head or kind_of(head) is not None:
        raise WrongKind(
            name, code="upload.not_csv", message="This file is not a CSV table.", hint="Give comma-separated text."
        )
