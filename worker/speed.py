"""How fast this deployment detects, measured as it goes and remembered, so that shards take 10 to 60 s each."""

import structlog
from sqlalchemy import func
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from backend.models import Speed
from backend.platform.reasons import reason_of
from dropflow.parameters import Parameters
from worker.context import Context
from worker.pace import Pace
from worker.plan import SECONDS_PER_MEGAPIXEL

_WEIGHT_OF_NEW = 0.2
"""Of what one more shard took: films differ, and machines are busy now and then."""
log = structlog.get_logger()


def known_seconds_per_megapixel(session: Session, parameters: Parameters) -> float:
    """What detection by this method takes on one core, as far as it is known."""
    found = session.get(Speed, _kind(parameters))
    return SECONDS_PER_MEGAPIXEL if found is None else found.seconds_per_megapixel


def remember(context: Context, parameters: Parameters, pace: Pace, *, n_pixels: int) -> None:
    """Note how long a shard took. It is published already: should this fail, nothing is lost but the note."""
    if not pace.mean_s:
        return
    measured = pace.mean_s / (n_pixels / 1e6)
    new = insert(Speed).values(kind=_kind(parameters), seconds_per_megapixel=measured)
    mixed = (1 - _WEIGHT_OF_NEW) * Speed.seconds_per_megapixel + _WEIGHT_OF_NEW * new.excluded.seconds_per_megapixel
    changes = {"seconds_per_megapixel": mixed, "measured_at": func.now()}
    try:
        with context.sessions.begin() as session:
            session.execute(new.on_conflict_do_update(index_elements=[Speed.kind], set_=changes))
    except SQLAlchemyError as problem:
        log.warning("speed not remembered", reason=reason_of(problem))


def _kind(parameters: Parameters) -> str:
    return f"detect {parameters.detection.method}"
