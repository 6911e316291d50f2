"""Whatever a damaged file makes a decoder raise, as an error that names the file; and what is no damage, as it is."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, BinaryIO, Protocol, cast

from dropflow.errors import FramesError


class Source(io.RawIOBase):
    """A file on its way into a decoder.

    It remembers when its own reading failed (a disk, a network): decoders turn that into anything, and it must not be
    taken for damage. It has no file number, so that no decoder maps it into memory: a file that shrinks would end the
    process. A read is never larger than what is left, whatever number a damaged file holds.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        try:
            self.size_bytes = file.seek(0, io.SEEK_END)
        except BaseException:
            file.close()
            raise
        self.failure: Exception | None = None
        self._at = 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._at

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        at = offset + {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self.size_bytes}[whence]
        if not 0 <= at < 2**63:
            raise ValueError("a place outside the file")
        self._at = at
        return at

    def read(self, size: int | None = -1) -> bytes:
        left = max(0, self.size_bytes - self._at)
        wanted = left if size is None or size < 0 else min(size, left)
        try:
            self._file.seek(self._at)
            content = self._file.read(wanted)
        except Exception as problem:
            self.failure = problem
            raise
        self._at += len(content)
        return content

    def readinto(self, buffer: Any) -> int:
        view = memoryview(buffer).cast("B")
        content = self.read(len(view))
        view[: len(content)] = content
        return len(content)

    def close(self) -> None:
        if not self.closed:
            self._file.close()
        super().close()

    def as_file(self) -> BinaryIO:
        """The same, as decoders call it."""
        return cast(BinaryIO, self)


class CanFail(Protocol):
    """What bytes come from."""

    failure: Exception | None
    """What went wrong in getting them, if anything did."""

    def close(self) -> None:
        """Give back what it holds."""
        ...


@contextmanager
def reading(what: str, *, file: str, frame: int | None = None, source: CanFail | None = None) -> Iterator[None]:
    """Make every failure in the block a `FramesError` that names `file` and `frame`.

    All decoders raise whatever they like for a damaged file, from `IndexError` to their own kinds with no base but
    `Exception`. What failed below them, in reading the file itself, is raised as it is.
    """
    try:
        with of_frame(frame):
            yield
    except FramesError:
        raise
    except MemoryError:
        raise FramesError(
            f"There is not enough memory to read this {what}.", code="frames.too_large", file=file, frame=frame
        ) from None
    except Exception as problem:
        if source is not None and source.failure is not None:
            raise source.failure from None
        raise damaged(what, problem, file=file, frame=frame) from None


@contextmanager
def of_frame(frame: int | None) -> Iterator[None]:
    """Say in any `FramesError` from the block which frame of the stack it is about."""
    try:
        yield
    except FramesError as problem:
        if frame is None or problem.frame == frame:
            raise
        raise FramesError(
            problem.message, code=problem.code, file=problem.file, frame=frame, hint=problem.hint
        ) from None


def damaged(what: str, problem: Exception | str, *, file: str, frame: int | None = None) -> FramesError:
    """The error for a file that is cut off or holds what makes no sense."""
    said = getattr(problem, "strerror", None) or str(problem)
    reason = " ".join(said.split())[:200] or type(problem).__name__
    return FramesError(
        f"The {what} cannot be read ({reason}).",
        code="frames.truncated",
        file=file,
        frame=frame,
        hint="It may be cut off or damaged: copy it again.",
    )
