"""Requests to one server: the token, tries again where that is harmless, and problems as errors."""

import random
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from importlib.metadata import version
from typing import Any
from uuid import UUID

import httpx

from dropflow.client.configuration import Server
from dropflow.client.errors import NotReachable, ServerProblem, problem_error
from dropflow.client.versions import ApiVersion, Capability, check, read_version

Json = dict[str, Any]

HARMLESS = frozenset({"GET", "HEAD", "PUT", "DELETE"})
PASSING = frozenset({429, 502, 503, 504})
LONGEST_PAUSE_S = 20.0
N_TRIES = 12
"""Some two minutes: a server that is started again is away for less."""


class Connection:
    """Talks to one server; may be used by several threads."""

    def __init__(self, server: Server, *, timeout_s: float = 60.0, n_tries: int = N_TRIES) -> None:
        headers = {"User-Agent": f"dropflow/{version('dropflow')}", "Accept": "*/*"}
        if server.token:
            headers["Authorization"] = f"Bearer {server.token}"
        self.server, self._n_tries = server, n_tries
        # No redirects: a token goes to the server that it was made for and to no other.
        self._http = httpx.Client(base_url=f"{server.url}api/v1/", headers=headers, timeout=timeout_s)

    def close(self) -> None:
        """Let go of the server."""
        self._http.close()

    @cached_property
    def health(self) -> Json:
        """What the server says of itself. It is the first thing that is asked: a wrong address is told soon."""
        return self._json(self.trying(lambda: self.once("GET", "health"), n_tries=2))

    @cached_property
    def version(self) -> ApiVersion:
        """The version of the API that the server speaks."""
        return read_version(self.health.get("api_version"))

    def can(self, capability: Capability) -> bool:
        """Whether the server is new enough for something."""
        return self.version >= capability.since

    def needs(self, capability: Capability) -> None:
        """Raise `WrongVersion` unless the server is new enough for something."""
        check(self.version, capability)

    def get(self, path: str, **query: Any) -> Json:
        """An answer in JSON."""
        return self._json(self.request("GET", path, params=_given(query)))

    def create(self, path: str, body: Any, *, key: str | None = None) -> tuple[Json, bool]:
        """What was created, and whether that was at an earlier time. With a key it is safe to try again."""
        headers = {"Idempotency-Key": key} if key and self.can(Capability.IDEMPOTENCY) else {}
        answer = self.request("POST", path, json=body, headers=headers)
        return self._json(answer), "idempotency-replayed" in answer.headers

    def pages(self, path: str, **query: Any) -> Iterator[Json]:
        """Every item of a list, page by page as they are looked at."""
        cursor: str | None = None
        while True:
            page = self.get(path, **query, cursor=cursor)
            yield from page["items"]
            cursor = page.get("next_cursor")
            if cursor is None:
                return

    def request(self, method: str, path: str, **about: Any) -> httpx.Response:
        """One request, tried again after a passing fault if a second one does no harm; problems are raised."""
        is_harmless = method in HARMLESS or "Idempotency-Key" in about.get("headers", {})
        return self.trying(lambda: self.once(method, path, **about), is_harmless=is_harmless)

    def trying(
        self, ask: Callable[[], httpx.Response], *, is_harmless: bool = True, n_tries: int | None = None
    ) -> httpx.Response:
        """Ask until it succeeds, fails for good, or has failed too often."""
        n_tries = n_tries or self._n_tries
        for n_failures in range(1, n_tries + 1):
            try:
                return ask()
            except (ServerProblem, NotReachable) as problem:
                is_passing = isinstance(problem, NotReachable) or problem.status in PASSING
                # 429 and 503 say that nothing was done.
                is_safe = is_harmless or getattr(problem, "status", 0) in (429, 503)
                if not (is_passing and is_safe) or n_failures == n_tries:
                    raise
                time.sleep(pause_s(n_failures))
        raise AssertionError("unreachable")

    @contextmanager
    def stream(self, method: str, path: str, **about: Any) -> Iterator[httpx.Response]:
        """An answer whose bytes are taken as they come; it is not tried again."""
        with self._reaching(), self._http.stream(method, path, **about) as answer:
            if answer.is_error:
                answer.read()
                raise _error(answer)
            yield answer

    def once(self, method: str, path: str, **about: Any) -> httpx.Response:
        """One request, tried once."""
        with self._reaching():
            answer = self._http.request(method, path, **about)
        if answer.is_error or answer.is_redirect:
            raise _error(answer)
        return answer

    @contextmanager
    def _reaching(self) -> Iterator[None]:
        try:
            yield
        except httpx.InvalidURL as problem:
            raise NotReachable(f"{self.server.url} is no address: {problem}.") from None
        except httpx.TransportError as problem:
            raise NotReachable(
                f"The server {self.server.url} cannot be reached ({str(problem) or type(problem).__name__}).",
                hint="Is the address right, and the server running?",
            ) from None

    def _json(self, answer: httpx.Response) -> Json:
        try:
            content = answer.json()
        except ValueError:
            content = None
        if not isinstance(content, dict):
            raise NotReachable(f"What answers at {self.server.url} is no Dropflow server.")
        return content


def pause_s(n_failures: int) -> float:
    """How long to wait before the next try: longer each time, and not all clients at once."""
    return min(0.25 * 2.0**n_failures, LONGEST_PAUSE_S) * random.uniform(0.75, 1.25)  # noqa: S311 - no secret


def _error(answer: httpx.Response) -> ServerProblem:
    try:
        content = answer.json()
    except ValueError:
        content = None
    error = problem_error(content, answer.status_code)
    if answer.is_redirect:
        error.hint = f"The server sends us to {answer.headers.get('location')}: give that address."
    return error


def _given(query: Json) -> Json:
    given = {name: value for name, value in query.items() if value is not None}
    return {name: str(value) if isinstance(value, UUID) else value for name, value in given.items()}
