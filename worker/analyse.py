"""Task analyse: the numbers that sum a run up."""

import json

from backend.platform.object_store import product_prefix
from dropflow import pipeline
from worker.context import Context
from worker.downloadable import described
from worker.film import load_prepared, prefixes
from worker.leases import Lease
from worker.outcomes import NewProduct, publish
from worker.plan import Task
from worker.work_folders import work_folder

SUMMARY_FILE = "summary.json"


def work(context: Context, lease: Lease) -> None:
    """Write the same summary as the command does, and complete the run with it."""
    claim = lease.claim
    film = load_prepared(context, claim)
    with context.sessions.begin() as session:
        tracked = prefixes(session, film.run_id, Task.TRACK)[0]
    with work_folder(context.settings.work_dir, claim) as folder:
        results = context.store.as_folder(tracked, folder)
        with lease.kept():
            summary = pipeline.summary(results, film.index, film.experiment, film.parameters, film.measured)
    content = (json.dumps(summary, indent=2, allow_nan=False) + "\n").encode()
    prefix = product_prefix(claim.experiment_id, claim.shard_id, claim.fence)
    context.store.put(prefix + SUMMARY_FILE, content)
    file = described(SUMMARY_FILE, "application/json", [content], lease)
    publish(context, claim, NewProduct(prefix, [file], summary=summary))
