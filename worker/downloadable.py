"""What people can fetch of a product: name, size, kind and checksum, so that a download can be resumed and checked."""

import hashlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from worker.leases import Lease

_READ_BYTES = 1 << 20


def described(name: str, media_type: str, pieces: Iterable[bytes], lease: Lease) -> dict[str, Any]:
    """The entry of a file in the list of its product; `pieces` are its bytes."""
    digest, size_bytes = hashlib.sha256(), 0
    for piece in pieces:
        digest.update(piece)
        size_bytes += len(piece)
        lease.alive("checksum", size_bytes, size_bytes)
    return {"name": name, "size_bytes": size_bytes, "media_type": media_type, "sha256": digest.hexdigest()}


def pieces_of(path: Path) -> Iterator[bytes]:
    """The bytes of a file, never all at once."""
    with path.open("rb") as file:
        while piece := file.read(_READ_BYTES):
            yield piece
