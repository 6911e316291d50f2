"""Traces of requests and of the work on shards, sent to where OTEL_EXPORTER_OTLP_ENDPOINT says.

Without it nothing is loaded, noted or sent: spans are then OpenTelemetry's own empty ones. How much is sampled, and
with which headers it is sent, other variables of OpenTelemetry say (OTEL_TRACES_SAMPLER, OTEL_EXPORTER_OTLP_HEADERS).
"""

from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any

from fastapi import FastAPI
from opentelemetry import propagate, trace
from structlog.typing import EventDict

from backend.platform.asked_for import asked_for
from dropflow.provenance import code_version

if TYPE_CHECKING:
    from opentelemetry.sdk.trace import TracerProvider

_UNTRACED = "/healthz,/readyz,/api/v1/health$"
_provider: "TracerProvider | None" = None


def start_tracing(endpoint: str | None, service: str, app: FastAPI | None = None) -> None:
    """Send what this process does to `endpoint` from now on, with the requests that `app` answers; None: nothing."""
    global _provider  # noqa: PLW0603 - one a process, as of logs
    if endpoint is None:
        return
    from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
    from opentelemetry.sdk.resources import Resource
    from opentelemetry.sdk.trace import TracerProvider
    from opentelemetry.sdk.trace.export import BatchSpanProcessor

    resource = Resource.create({"service.name": service, "service.version": code_version()})
    _provider = TracerProvider(resource=resource)
    _provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter(endpoint=f"{endpoint.rstrip('/')}/v1/traces")))
    if app is not None:
        _trace_requests(app, _provider)


def stop_tracing() -> None:
    """Send what is left, and no more."""
    global _provider  # noqa: PLW0603 - see above
    if _provider is not None:
        _provider.shutdown()
        _provider = None


def span(
    name: str, attributes: Mapping[str, Any], *, follows: Mapping[str, str] | None = None
) -> AbstractContextManager[trace.Span]:
    """Time what happens in this context; attributes that are None are left out. `follows`: what `carrier` gave."""
    tracer = trace.NoOpTracer() if _provider is None else _provider.get_tracer("dropflow")
    known = {f"dropflow.{key}": str(value) for key, value in attributes.items() if value is not None}
    context = propagate.extract(follows) if follows else None
    return tracer.start_as_current_span(name, attributes=known, context=context)


def went_wrong(error: Exception) -> None:
    """Mark the span that is under way; the error is dealt with elsewhere."""
    current = trace.get_current_span()
    current.record_exception(error)
    current.set_status(trace.StatusCode.ERROR, type(error).__name__)


def carrier() -> dict[str, str]:
    """What a message must carry so that what it causes belongs to the same trace."""
    carried: dict[str, str] = {}
    propagate.inject(carried)
    return carried


def with_trace(_logger: object, _method: str, event: EventDict) -> EventDict:
    """A step of logging: name the trace that a line belongs to."""
    found = trace.get_current_span().get_span_context()
    if found.is_valid:
        event["trace"], event["span"] = f"{found.trace_id:032x}", f"{found.span_id:016x}"
    return event


def _trace_requests(app: FastAPI, provider: "TracerProvider") -> None:
    from opentelemetry.instrumentation.fastapi import FastAPIInstrumentor

    # A span for each piece of a body would be thousands for one upload.
    FastAPIInstrumentor.instrument_app(
        app,
        tracer_provider=provider,
        excluded_urls=_UNTRACED,
        exclude_spans=["receive", "send"],
        server_request_hook=_name_request,
    )


def _name_request(current: trace.Span, scope: dict[str, Any]) -> None:
    """Say which run or experiment is asked for, and nothing of the query: it may let somebody in."""
    for kind, number in asked_for(scope["path"]).items():
        current.set_attribute(f"dropflow.{kind}", number)
    for attribute in ("http.url", "http.target", "url.full"):
        current.set_attribute(attribute, scope["path"])
    current.set_attribute("url.query", "")
