"""The Celery application: `celery -A worker.app worker -Q interactive,shards,sequential,ingest`."""

import atexit
import gc
import os
from typing import Any

import cv2
import structlog
from celery import signals

from backend.platform.logging import set_up_logging
from backend.platform.previews import PREVIEW_TASK, PreviewRequest
from backend.platform.queue import TASK_NAME, make_celery
from backend.platform.settings import environment_settings
from backend.platform.tracing import start_tracing, stop_tracing
from worker import preview
from worker.context import holders_of_this_worker, process_context
from worker.outcomes import give_back_all
from worker.shards import look_in
from worker.watch import give_back_of_the_dead, start_watching
from worker.work_folders import sweep

settings = environment_settings()
app = make_celery(settings.redis_url)
log = structlog.get_logger()


@app.task(name=TASK_NAME)  # type: ignore[untyped-decorator]
def look_for_work(queue: str) -> None:
    """Do one shard of those that wait in a queue."""
    look_in(process_context(), queue)


@app.task(name=PREVIEW_TASK)  # type: ignore[untyped-decorator]
def look_ahead(request: str) -> None:
    """Answer somebody who waits for a preview."""
    preview.answer(process_context(), PreviewRequest.model_validate_json(request))


@signals.setup_logging.connect  # type: ignore[untyped-decorator]
def _set_up_logging(**_: Any) -> None:
    set_up_logging(settings.log_level)


@signals.worker_ready.connect  # type: ignore[untyped-decorator]
def _watch(**_: Any) -> None:
    # Once the processes are there: threads do not go with a fork, but the locks that they hold would.
    start_watching(process_context())


@signals.worker_process_init.connect  # type: ignore[untyped-decorator]
def _trace(**_: Any) -> None:
    # In each process: the thread that sends does not go with a fork.
    start_tracing(settings.otel_exporter_otlp_endpoint, "dropflow-worker")


@signals.worker_process_shutdown.connect  # type: ignore[untyped-decorator]
def _end_trace(**_: Any) -> None:
    stop_tracing()


@signals.worker_process_init.connect  # type: ignore[untyped-decorator]
def _one_thread_each(**_: Any) -> None:
    # OpenCV's threads do not survive a fork, and workers share the cores by being many.
    cv2.setNumThreads(0)


@signals.worker_init.connect  # type: ignore[untyped-decorator]
def _begin(**_: Any) -> None:
    os.nice(settings.worker_nice)  # processes are forked later, and are as nice
    # What is imported is shared with the processes to come as long as nobody writes to it, and the collector would.
    gc.collect()
    gc.freeze()
    sweep(process_context())
    give_back_of_the_dead(process_context())
    # Celery announces only some of the ways in which it stops; every one of them passes the interpreter's end.
    atexit.register(_end, os.getpid())


def _end(main_process: int) -> None:
    """A worker that is stopped gives its shards back at once, instead of letting their leases run out."""
    if os.getpid() == main_process:
        n_given_back = give_back_all(process_context(), holders_of_this_worker())
        log.info("worker stopped", shards_given_back=n_given_back)
