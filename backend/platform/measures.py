"""What this process measures of the requests it answers: how long, how many bytes, how many live streams."""

import time

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_SECONDS = (0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100)


class Measures:
    """The measures of one process."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self.seconds = Histogram(
            "dropflow_request_seconds", "Until an answer began.", ["method", "route", "status"],
            registry=self.registry, buckets=_SECONDS,
        )  # fmt: skip
        self.received = Counter("dropflow_received_bytes", "Bodies of requests.", ["route"], registry=self.registry)
        self.sent = Counter("dropflow_sent_bytes", "Bodies of answers.", ["route"], registry=self.registry)
        self.streams = Gauge("dropflow_live_streams", "Pages that are told of changes.", registry=self.registry)


class Measured:
    """Measures every request by its route, never by its address: addresses are without number."""

    def __init__(self, app: ASGIApp, *, measures: Measures) -> None:
        self._app, self._measures = app, measures

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        began, status, is_live = time.perf_counter(), 500, False
        n_received = n_sent = 0

        async def counting_receive() -> Message:
            nonlocal n_received
            message = await receive()
            n_received += len(message.get("body", b""))
            return message

        async def counting_send(message: Message) -> None:
            nonlocal n_sent, status, is_live
            if message["type"] == "http.response.start":
                status = message["status"]
                kind = Headers(raw=message["headers"]).get("content-type", "")
                is_live = kind.startswith("text/event-stream")
                self._measures.streams.inc(is_live)
                self._measures.seconds.labels(scope["method"], _route(scope), status).observe(
                    time.perf_counter() - began
                )
            n_sent += len(message.get("body", b""))
            await send(message)

        try:
            await self._app(scope, counting_receive, counting_send)
        finally:
            self._measures.streams.dec(is_live)
            self._measures.received.labels(_route(scope)).inc(n_received)
            self._measures.sent.labels(_route(scope)).inc(n_sent)


def _route(scope: Scope) -> str:
    return getattr(scope.get("route"), "path", "none")
