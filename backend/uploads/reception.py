"""The bytes of one request on their way into an upload. Whatever ends the request, what came before that counts."""

import asyncio
import hashlib
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass

import anyio
from fastapi.concurrency import run_in_threadpool
from obstore.exceptions import BaseError
from starlette.types import Message

from backend.platform.dependencies import Platform
from backend.platform.growing import StillHeld
from backend.platform.problems import ServiceError, problem_of
from backend.platform.store_errors import store_error
from backend.stacks.errors import WrongKind
from backend.uploads import holding
from backend.uploads.errors import ChecksumMismatch, InUse, TooManyBytes
from backend.uploads.headers import Checksum
from backend.uploads.holding import Held
from backend.uploads.intake import Intake

_BLOCK_BYTES = 1 << 22
_TICK_S = 1.0
_RENEW_S = 3.0

Receive = Callable[[], Awaitable[Message]]


class Reception:
    """Writes, sums up and saves; every method blocks, and one is called at a time."""

    def __init__(self, platform: Platform, held: Held, intake: Intake, checksum: Checksum | None) -> None:
        self._platform, self._held, self._intake, self._checksum = platform, held, intake, checksum
        self._sum = hashlib.new(checksum.algorithm, usedforsecurity=False) if checksum else None
        self._written = self._safe = held.offset_bytes
        self._saved_s = self._told_s = time.monotonic()
        self._growing = platform.store.grow(held.store_key, at_byte=held.offset_bytes, fence=held.fence)

    @property
    def offset_bytes(self) -> int:
        """So many bytes of the upload are safe."""
        return self._safe

    def take(self, chunks: list[bytes]) -> None:
        """The next bytes; or none for a while, which is the time to see whether the upload is still ours."""
        for chunk in chunks:
            if self._written + len(chunk) > self._held.size_bytes:
                raise TooManyBytes(self._held.size_bytes)
            self._intake.take(memoryview(chunk))
            if self._sum is not None:
                self._sum.update(chunk)
            self._growing.write(chunk)
            self._written += len(chunk)
        if self._sum is None and self._is_worth_saving():
            self._save()
        elif not chunks or time.monotonic() - self._told_s > _RENEW_S:
            self._tell(is_alive=bool(chunks))

    def end(self, *, is_whole: bool) -> None:
        """The request is over. Bytes with a checksum count all together or not at all."""
        try:
            if self._checksum is not None and self._sum is not None:
                is_right = self._sum.digest() == self._checksum.digest
                if not is_whole or not is_right:
                    self._give_up()
                    if is_whole:
                        raise ChecksumMismatch
                    return
            self._save(is_last=self._written < self._held.size_bytes)
        finally:
            self._growing.close()

    def _give_up(self) -> None:
        holding.let_go(self._platform, self._held, self._safe, ())

    def _is_worth_saving(self) -> bool:
        n_unsafe = self._written - self._safe
        is_due = time.monotonic() - self._saved_s > self._growing.sync_s
        return n_unsafe >= self._growing.sync_bytes or (n_unsafe > 0 and is_due)

    def _save(self, *, is_last: bool = False) -> None:
        pieces = self._growing.sync()
        if is_last:
            holding.let_go(self._platform, self._held, self._written, pieces)
        else:
            holding.save(self._platform, self._held, self._written, pieces, is_alive=True)
        self._safe = self._written
        self._saved_s = self._told_s = time.monotonic()

    def _tell(self, *, is_alive: bool) -> None:
        holding.save(self._platform, self._held, self._safe, (), is_alive=is_alive)
        self._told_s = time.monotonic()


@dataclass(frozen=True)
class _Block:
    chunks: list[bytes]
    is_cut: bool = False


async def receive(platform: Platform, held: Held, intake: Intake, checksum: Checksum | None, get: Receive) -> int:
    """Take in the body of a request; returns how many bytes of the upload are safe then."""
    try:
        reception = await run_in_threadpool(Reception, platform, held, intake, checksum)
    except StillHeld:
        raise InUse from None
    except (OSError, BaseError) as problem:
        raise store_error(problem) from None
    is_whole = False
    try:
        try:
            is_whole = await _pour(get, reception)
        finally:
            with anyio.CancelScope(shield=True):
                await run_in_threadpool(_end, reception, is_whole=is_whole)
    except WrongKind as problem:
        await run_in_threadpool(holding.refuse, platform, held, problem_of(problem))
        raise
    except (OSError, BaseError) as problem:
        raise store_error(problem) from None
    return reception.offset_bytes


def _end(reception: Reception, *, is_whole: bool) -> None:
    if is_whole:
        try:
            reception.end(is_whole=True)
        except (OSError, BaseError) as problem:
            raise store_error(problem) from None
        return
    # Another error is on its way already, or nobody listens any more.
    with suppress(OSError, BaseError, ServiceError):
        reception.end(is_whole=False)


async def _pour(get: Receive, reception: Reception) -> bool:
    """Write one block while the next one comes. Returns whether the body came to its end."""
    work: asyncio.Future[None] | None = None
    try:
        async for block in _blocks(get):
            if work is not None:
                await work
            if block.is_cut:
                work = None
                await run_in_threadpool(reception.take, block.chunks)
                return False
            work = asyncio.ensure_future(run_in_threadpool(reception.take, block.chunks))
        if work is not None:
            await work
        return True
    finally:
        if work is not None and not work.done():
            with anyio.CancelScope(shield=True):
                await asyncio.wait([work])


async def _blocks(get: Receive) -> AsyncIterator[_Block]:
    """The body in blocks of some megabytes; an empty one for each second in which nothing came."""
    chunks: list[bytes] = []
    n_bytes = 0
    while True:
        try:
            async with asyncio.timeout(_TICK_S):
                message = await get()
        except TimeoutError:
            yield _Block(chunks)
            chunks, n_bytes = [], 0
            continue
        if message["type"] == "http.disconnect":
            yield _Block(chunks, is_cut=True)
            return
        if body := message.get("body", b""):
            chunks.append(body)
            n_bytes += len(body)
        if not message.get("more_body", False):
            yield _Block(chunks)
            return
        if n_bytes >= _BLOCK_BYTES:
            yield _Block(chunks)
            chunks, n_bytes = [], 0
