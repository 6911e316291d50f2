"""Task analyse: what figures are drawn from, the report, and the numbers that sum a run up."""

import shutil
from pathlib import Path

from backend.platform.object_store import product_prefix
from dropflow import pipeline
from worker.context import Context
from worker.downloadable import described, pieces_of
from worker.film import PreparedFilm, load_prepared, prefixes
from worker.leases import Lease
from worker.outcomes import NewProduct, publish
from worker.plan import Task
from worker.work_folders import work_folder

MEDIA_TYPES = {
    ".parquet": "application/vnd.apache.parquet",
    ".npz": "application/octet-stream",
    ".json": "application/json",
    ".html": "text/html",
    ".csv": "text/csv",
}
LOG_ROLE = "temperature_log"


def work(context: Context, lease: Lease) -> None:
    """Leave the same files as the command does, and the report; complete the run with the summary."""
    claim = lease.claim
    film = load_prepared(context, claim)
    with context.sessions.begin() as session:
        tracked = prefixes(session, film.run_id, Task.TRACK)[0]
    prefix = product_prefix(claim.experiment_id, claim.shard_id, claim.fence)
    with work_folder(context.settings.work_dir, claim) as folder:
        tables = context.store.as_folder(tracked, folder / "tables")
        made = folder / "made"
        made.mkdir(exist_ok=True)
        with film.frames() as frames:
            summary = pipeline.analyse_film(
                frames, film.index, film.experiment, film.parameters, film.measured, tables=tables, folder=made
            )
            pipeline.write_film_report(
                film.index, film.experiment, film.parameters, summary, tables=tables, folder=made
            )
        _copy_log(context, film, made)
        paths = sorted(made.iterdir())
        for n_done, path in enumerate(paths):
            context.store.put(prefix + path.name, path)
            lease.alive("store", n_done, len(paths))
        files = [described(path.name, MEDIA_TYPES[path.suffix], pieces_of(path), lease) for path in paths]
        publish(context, claim, NewProduct(prefix, files, summary=summary))


def _copy_log(context: Context, film: PreparedFilm, made: Path) -> None:
    for place in film.files.get(LOG_ROLE, {}).values():
        with context.store.open_place(place) as log, (made / pipeline.TEMPERATURE_FILE).open("wb") as copy:
            shutil.copyfileobj(log, copy)
