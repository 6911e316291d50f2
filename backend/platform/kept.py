"""What costs much to make and never changes, kept in memory: whatever was asked for last, up to a number of bytes."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable

KEPT_BYTES = 64_000_000


class Kept:
    """Texts by key. Who asks for one that another is making waits for it, instead of making it, too."""

    def __init__(self, most_bytes: int = KEPT_BYTES) -> None:
        self._most_bytes = most_bytes
        self._texts: OrderedDict[Hashable, str] = OrderedDict()
        self._n_bytes = 0
        self._making: dict[Hashable, threading.Lock] = {}
        self._lock = threading.Lock()

    def get(self, key: Hashable, make: Callable[[], str]) -> str:
        """The text of `key`, made if it is not there. What `make` raises is not kept."""
        with self._lock:
            if (text := self._found(key)) is not None:
                return text
            making = self._making.setdefault(key, threading.Lock())
        with making:
            with self._lock:
                if (text := self._found(key)) is not None:
                    return text
            try:
                text = make()
            finally:
                with self._lock:
                    self._making.pop(key, None)
            with self._lock:
                self._keep(key, text)
            return text

    def _found(self, key: Hashable) -> str | None:
        if key not in self._texts:
            return None
        self._texts.move_to_end(key)
        return self._texts[key]

    def _keep(self, key: Hashable, text: str) -> None:
        if key in self._texts or len(text) > self._most_bytes:
            return
        self._texts[key] = text
        self._n_bytes += len(text)
        while self._n_bytes > self._most_bytes:
            self._n_bytes -= len(self._texts.popitem(last=False)[1])
