"""Keeps processes running: what dies is started again, later each time, and all end in order."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from deploy.local.errors import LauncherError
from deploy.local.processes import Child

FIRST_DELAY_S, LONGEST_DELAY_S = 1.0, 30.0
HEALTHY_AFTER_S = 60.0
POLL_S = 0.2


class Service(Protocol):
    """Something that can be started, again and again."""

    @property
    def name(self) -> str: ...

    def start(self) -> Child: ...


def delay_s(n_failures: int, longest_s: float = LONGEST_DELAY_S) -> float:
    """How long to wait before the next start after `n_failures` deaths in a row."""
    return min(FIRST_DELAY_S * 2.0 ** min(n_failures - 1, 10), longest_s)


@dataclass
class Supervised:
    """A service, its process, and how often that died lately."""

    service: Service
    tier: int
    child: Child
    started_at: float
    n_failures: int = 0
    start_again_at: float | None = None


@dataclass
class Supervisor:
    """What it starts, it watches, until `stop`. `say` tells the person who started us."""

    say: Callable[[str], None]
    longest_delay_s: float = LONGEST_DELAY_S
    supervised: list[Supervised] = field(default_factory=list)

    def start(self, service: Service, *, tier: int) -> Child:
        """Start a service that uses those of lower tiers."""
        child = service.start()
        self.supervised.append(Supervised(service, tier, child, time.monotonic()))
        return child

    def check(self) -> None:
        """One look at every process."""
        for entry in self.supervised:
            now = time.monotonic()
            if entry.start_again_at is not None:
                if now >= entry.start_again_at:
                    self._start_again(entry)
            elif not entry.child.is_running:
                entry.child.stop()  # what it left of its group
                self._note_death(entry, _how_it_died(entry.child))

    def stop(self, *, timeout_s: float = 15.0) -> None:
        """End all, the last tier first and each tier at once, so that what serves the others ends after them."""
        while self.supervised:
            last = max(entry.tier for entry in self.supervised)
            ending = [entry for entry in self.supervised if entry.tier == last]
            for entry in ending:
                entry.child.ask_to_stop()
            for entry in ending:
                if not entry.child.stop(timeout_s) and timeout_s > 0:
                    self.say(f"{entry.service.name} did not stop within {timeout_s:.0f} s and was killed.")
                self.supervised.remove(entry)

    def kill(self) -> None:
        """End all at once."""
        self.stop(timeout_s=0)

    def _start_again(self, entry: Supervised) -> None:
        entry.start_again_at, entry.started_at = None, time.monotonic()
        try:
            entry.child = entry.service.start()
        except LauncherError as problem:
            self._note_death(entry, f"could not be started: {problem}")

    def _note_death(self, entry: Supervised, how: str) -> None:
        now = time.monotonic()
        entry.n_failures = 1 if now - entry.started_at > HEALTHY_AFTER_S else entry.n_failures + 1
        wait_s = delay_s(entry.n_failures, self.longest_delay_s)
        entry.start_again_at = now + wait_s
        self.say(f"{entry.service.name} {how}; it is started again in {wait_s:.0f} s (log: {entry.child.log}).")


def _how_it_died(child: Child) -> str:
    code = child.process.returncode
    return f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
