"""A worker that sleeps: `celery --app benchmarks.sleeping worker`, the real one but for the computing.

It claims, says after each frame how far it is, publishes, and notes how long the claim and the publishing took.
"""

import os
import random
import time
from pathlib import Path
from uuid import uuid4

import worker.app
from worker import outcomes, shards
from worker.context import Context
from worker.leases import Lease
from worker.outcomes import NewProduct
from worker.plan import Task

SIZES = bytes(2000)
"""As large as a shard's histograms."""
_SHARD_S = float(os.environ.get("BENCHMARK_SHARD_S", "20"))
_NOTES = Path(os.environ.get("BENCHMARK_NOTES", "."))
_asked = {"at_s": 0.0}
app = worker.app.app
_look_in = worker.app.look_in


def look_in(context: Context, queue: str) -> None:
    """Note when work was asked for."""
    _asked["at_s"] = time.perf_counter()
    _look_in(context, queue)


def sleep(context: Context, lease: Lease) -> None:
    """Sleep for as long as detection takes, frame by frame."""
    claimed_s = time.perf_counter() - _asked["at_s"]
    n_frames = lease.claim.stop_frame - lease.claim.start_frame
    frame_s = random.uniform(0.5, 1.5) * _SHARD_S / n_frames
    for n_done in range(1, n_frames + 1):
        time.sleep(frame_s)
        lease("detect", n_done, n_frames)
    began_s = time.perf_counter()
    outcomes.publish(context, lease.claim, NewProduct(prefix=f"benchmark/{uuid4()}/", sizes=SIZES))
    with (_NOTES / f"{os.getpid()}").open("a") as notes:
        notes.write(f"{time.time()} {claimed_s} {time.perf_counter() - began_s}\n")


worker.app.look_in = look_in
shards.WORK = {Task.DETECT: sleep}  # type: ignore[misc]
