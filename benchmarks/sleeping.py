"""Workers that sleep: `python -m benchmarks.sleeping N_WORKERS`, until its input ends.

Each is a thread with connections of its own that does what a worker does: it takes a message from the queue, claims,
says after each frame how far it is, and publishes; only the computing is slept. A process each would be 40 MB each.
"""

import os
import random
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path
from uuid import uuid4

import redis

from backend.platform.logging import set_up_logging
from backend.platform.settings import environment_settings
from worker import outcomes, shards
from worker.context import Context, make_context
from worker.leases import Lease
from worker.outcomes import NewProduct
from worker.plan import Task

SIZES = bytes(2000)
"""As large as a shard's histograms."""
_SHARD_S = float(os.environ.get("BENCHMARK_SHARD_S", "20"))
_NOTES = Path(os.environ.get("BENCHMARK_NOTES", "."))
_asked = threading.local()


def sleep(context: Context, lease: Lease) -> None:
    """Sleep for as long as detection takes, frame by frame; note how long claiming and publishing took."""
    began_at, claimed_s = time.time(), time.perf_counter() - _asked.at_s
    n_frames = lease.claim.stop_frame - lease.claim.start_frame
    frame_s = random.uniform(0.5, 1.5) * _SHARD_S / n_frames
    for n_done in range(1, n_frames + 1):
        time.sleep(frame_s)
        lease("detect", n_done, n_frames)
    began_s = time.perf_counter()
    outcomes.publish(context, lease.claim, NewProduct(prefix=f"benchmark/{uuid4()}/", sizes=SIZES))
    with (_NOTES / str(os.getpid())).open("a") as notes:
        notes.write(f"{time.time()} {claimed_s} {time.perf_counter() - began_s} {began_at}\n")


def work(number: int, stopping: threading.Event) -> None:
    """One worker."""
    made = make_context(environment_settings())
    context = replace(made, holder=f"{made.holder}:{number}")
    time.sleep(random.uniform(0, _SHARD_S / 4))  # workers do not all begin at once
    with redis.Redis.from_url(context.settings.redis_url) as broker:
        while not stopping.is_set():
            if broker.brpop(["shards"], timeout=5):
                _asked.at_s = time.perf_counter()
                shards.look_in(context, "shards")
    context.close()


def main() -> None:
    """Work until the input ends."""
    set_up_logging("WARNING")
    shards.WORK = {Task.DETECT: sleep}  # type: ignore[misc]
    stopping = threading.Event()
    for number in range(int(sys.argv[1])):
        threading.Thread(target=work, args=(number, stopping), daemon=True).start()
    sys.stdin.read()


if __name__ == "__main__":
    main()
