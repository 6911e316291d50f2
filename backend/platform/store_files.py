"""Uploaded files as the library wants to see them: by the names people gave, wherever they are kept."""

from collections.abc import Mapping, Sequence
from typing import BinaryIO

from backend.platform.object_store import ObjectStore


class StoreFiles:
    """`dropflow.frames.Files` over the object store."""

    def __init__(self, store: ObjectStore, keys: Mapping[str, str]) -> None:
        self._store, self._keys = store, keys

    def names(self) -> Sequence[str]:
        return list(self._keys)

    def open(self, name: str) -> BinaryIO:
        return self._store.open(self._keys[name])
