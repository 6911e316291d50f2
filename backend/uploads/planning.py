"""What of a list of files is to be sent, and in which uploads. Pure: rows go in, decisions come out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from uuid import UUID

from backend.uploads.schemas import Announced

BUNDLE_BYTES = 1 << 26
BUNDLE_FILES = 500
"""Small files share an upload: so much is sent in one request, and at most so much is sent again after a refusal."""

Key = tuple[str, str]


@dataclass(frozen=True)
class Open:
    """An upload that was begun, by whomever."""

    id: UUID
    files: Sequence[Announced]
    is_held: bool
    is_refused: bool = False


@dataclass
class Decision:
    """Indexes are places in the list of wanted files."""

    present: dict[int, str] = field(default_factory=dict)
    """Checksum of each file that is there."""
    go_on: dict[UUID, list[int]] = field(default_factory=dict)
    """Uploads to be continued, with their files."""
    begin: list[list[int]] = field(default_factory=list)
    """Uploads to be begun, with their files."""
    end: list[UUID] = field(default_factory=list)
    """Uploads that nobody can continue now."""
    keep_announced: list[list[Announced]] = field(default_factory=list)
    """Files of these that are not in the list: they stay announced."""


def decide(wanted: Sequence[Announced], there: Mapping[Key, tuple[int, str]], begun: Sequence[Open]) -> Decision:
    """Send what is missing, go on with what was begun, and lose sight of nothing.

    An upload can be continued by whoever has all of its files: it is one row of bytes.
    """
    decision = Decision()
    missing: dict[Key, int] = {}
    for index, file in enumerate(wanted):
        size_bytes, sha256 = there.get(file.key, (None, ""))
        if size_bytes == file.size_bytes and file.sha256 in (None, sha256):
            decision.present[index] = sha256
        else:
            missing[file.key] = index
    for upload in begun:
        _go_on_or_end(upload, wanted, missing, decision)
    decision.begin = bundles(wanted, list(missing.values()))
    return decision


def bundles(wanted: Sequence[Announced], indexes: Sequence[int]) -> list[list[int]]:
    """Divide files, in their order, into uploads."""
    found: list[list[int]] = []
    size_bytes = 0
    for index in indexes:
        n_bytes = wanted[index].size_bytes
        if not found or len(found[-1]) == BUNDLE_FILES or size_bytes + n_bytes > BUNDLE_BYTES:
            found.append([])
            size_bytes = 0
        found[-1].append(index)
        size_bytes += n_bytes
    return found


def _go_on_or_end(upload: Open, wanted: Sequence[Announced], missing: dict[Key, int], decision: Decision) -> None:
    places = [missing.get(file.key) for file in upload.files]
    if not any(place is not None for place in places):
        return  # it is about other files
    can_go_on = not upload.is_refused and all(
        place is not None and _is_same(file, wanted[place]) for place, file in zip(places, upload.files, strict=True)
    )
    if can_go_on:
        decision.go_on[upload.id] = [missing.pop(file.key) for file in upload.files]
    elif not upload.is_held:
        decision.end.append(upload.id)
        others = [file for file, place in zip(upload.files, places, strict=True) if place is None]
        if others and not upload.is_refused:
            decision.keep_announced.append(others)


def _is_same(begun: Announced, wanted: Announced) -> bool:
    return begun.size_bytes == wanted.size_bytes and wanted.sha256 in (None, begun.sha256)
