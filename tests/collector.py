"""A small collector of OpenTelemetry's traces (OTLP over HTTP, as protobuf), for tests."""

import gzip
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from opentelemetry.proto.collector.trace.v1.trace_service_pb2 import ExportTraceServiceRequest


@dataclass(frozen=True)
class Seen:
    """A span that arrived."""

    service: str
    name: str
    trace_id: str
    parent_id: str
    attributes: dict[str, str]
    is_error: bool


@dataclass
class Collector:
    """What came to `url`."""

    url: str
    spans: list[Seen] = field(default_factory=list)

    def await_span(self, condition: Callable[[Seen], bool], timeout_s: float = 20) -> Seen:
        """The first span of this kind."""
        deadline = time.monotonic() + timeout_s
        while True:
            for span in list(self.spans):
                if condition(span):
                    return span
            assert time.monotonic() < deadline, f"only {[(span.service, span.name) for span in self.spans]}"
            time.sleep(0.02)

    def take(self, body: bytes) -> None:
        """Note the spans of a message."""
        for resource in ExportTraceServiceRequest.FromString(body).resource_spans:
            about = {entry.key: entry.value.string_value for entry in resource.resource.attributes}
            for scope in resource.scope_spans:
                for span in scope.spans:
                    self.spans.append(
                        Seen(
                            service=about["service.name"],
                            name=span.name,
                            trace_id=span.trace_id.hex(),
                            parent_id=span.parent_span_id.hex(),
                            attributes={entry.key: entry.value.string_value for entry in span.attributes},
                            is_error=span.status.code == span.status.STATUS_CODE_ERROR,
                        )
                    )


@contextmanager
def running_collector() -> Iterator[Collector]:
    """Listen on a free port until the context ends."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            is_right = self.path == "/v1/traces" and self.headers["Content-Type"] == "application/x-protobuf"
            if is_right:
                collector.take(gzip.decompress(body) if self.headers["Content-Encoding"] == "gzip" else body)
            self.send_response(200 if is_right else 400)
            self.send_header("Content-Length", "0")
            self.end_headers()

        def log_message(self, *_args: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        collector = Collector(f"http://127.0.0.1:{server.server_port}")
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield collector
        finally:
            server.shutdown()
            thread.join()
