"""Every byte in the object store belongs to a row, or goes: uploads that nobody continued, and what a crash left."""

import re
import time
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime, timedelta
from itertools import islice
from uuid import UUID

import structlog
from sqlalchemy import delete, func, or_, select, text
from sqlalchemy.orm import Session

from backend.models import File, Product, Shard, Stack, Upload
from backend.models.lifecycle import doom
from backend.models.states import OPEN_SHARD_STATES
from backend.platform.events import announce, experiment_topic
from backend.platform.holding import KEEP_OBJECTS
from worker.context import Context
from worker.retention import retain

SWEEP_EVERY_S = 3600.0
_AT_ONCE = 500
_FILE = re.compile(r"(experiments/[0-9a-f-]{36}/files/[0-9a-f-]{36})(/.+)?")
_PRODUCT = re.compile(r"(experiments/[0-9a-f-]{36}/products/([0-9a-f-]{36})/\d+/).+")
log = structlog.get_logger()


def expire_uploads(context: Context) -> None:
    """Uploads that nobody went on with for long; of finished ones only the memory goes."""
    with context.sessions.begin() as session:
        expired = delete(Upload).where(
            Upload.expires_at < func.now(), or_(Upload.held_until.is_(None), Upload.held_until < func.now())
        )
        rows = session.execute(expired.returning(Upload.experiment_id, Upload.store_key, Upload.finished_at)).all()
        unfinished = [row for row in rows if row.finished_at is None]
        doom(session, sorted({row.store_key for row in unfinished}))
        announce(session, *{experiment_topic(row.experiment_id) for row in unfinished})


class Sweeper:
    """Now and then, looks for objects that no row speaks of. What is young may be about to get its row."""

    def __init__(self, every_s: float = SWEEP_EVERY_S) -> None:
        self._every_s = every_s
        self._next_s = 0.0

    def __call__(self, context: Context) -> None:
        if time.monotonic() >= self._next_s:
            self._next_s = time.monotonic() + self._every_s
            retain(context)
            sweep_orphans(context)


def sweep_orphans(context: Context) -> int:
    """Remove what has no row and is older than the grace time. Returns how many objects that were."""
    before = datetime.now(UTC) - timedelta(seconds=context.settings.orphan_grace_s)
    n_removed = 0
    for keys in _batches(context.store.older_than("experiments/", before)):
        with context.sessions.begin() as session:
            if not session.scalar(text("SELECT pg_try_advisory_xact_lock(:key)"), {"key": KEEP_OBJECTS}):
                return n_removed  # a backup copies them just now
            for key in orphans(session, keys):
                log.warning("orphan removed", key=key)
                context.store.remove(key)
                n_removed += 1
    context.store.remove_leftovers(before)
    return n_removed


def orphans(session: Session, keys: Iterable[str]) -> list[str]:
    """Those of `keys` that are of uploads and products, and that no row speaks of."""
    files = {key: found[1] for key in keys if (found := _FILE.fullmatch(key))}
    products = {key: (found[1], UUID(found[2])) for key in keys if (found := _PRODUCT.fullmatch(key))}
    known_files = _known_files(session, set(files.values()))
    known_products = _known_products(session, {prefix for prefix, _ in products.values()})
    at_work = _open_shards(session, {shard_id for _, shard_id in products.values()})
    return [
        *(key for key, owner in files.items() if owner not in known_files),
        *(key for key, (prefix, shard) in products.items() if prefix not in known_products and shard not in at_work),
    ]


def _known_files(session: Session, owners: set[str]) -> set[str]:
    names = [*owners, *(f"{owner}/" for owner in owners)]
    known = set(session.scalars(select(File.store_key).where(File.store_key.in_(names))))
    known |= set(session.scalars(select(Upload.store_key).where(Upload.store_key.in_(names))))
    return {key.removesuffix("/") for key in known}


def _known_products(session: Session, prefixes: set[str]) -> set[str]:
    known = set(session.scalars(select(Product.prefix).where(Product.prefix.in_(prefixes))))
    indexes = [f"{prefix}index.json" for prefix in prefixes]
    kept = session.scalars(select(Stack.index_key).where(Stack.index_key.in_(indexes)))
    return known | {str(key).removesuffix("index.json") for key in kept}


def _open_shards(session: Session, ids: set[UUID]) -> set[UUID]:
    return set(session.scalars(select(Shard.id).where(Shard.id.in_(ids), Shard.state.in_(OPEN_SHARD_STATES))))


def _batches(keys: Iterator[str]) -> Iterator[list[str]]:
    while batch := list(islice(keys, _AT_ONCE)):
        yield batch
