"""Idempotency-Key: what is asked for twice, by a retry, a double click or after a kill, is created once.

The key is a row of the transaction that creates: both are there or neither. A double that comes meanwhile waits at that
row for the first to end, and is then answered with what the first one made.
"""

import hashlib
import json
from collections.abc import Callable
from contextlib import suppress
from datetime import timedelta
from http import HTTPStatus
from typing import Annotated, TypeVar
from uuid import UUID

from fastapi import Depends, Header, Request, Response
from sqlalchemy import delete, func, select
from sqlalchemy.dialects.postgresql import insert
from sqlalchemy.orm import Session

from backend.models import IdempotencyKey
from backend.platform.dependencies import SessionDependency, ViewerDependency
from backend.platform.problems import Conflict, NotFound, ServiceError
from backend.platform.visibility import Viewer

KEPT = timedelta(days=30)
REPLAYED = "Idempotency-Replayed"
Made = TypeVar("Made")


class KeyOfAnother(ServiceError):
    """The key stands for something else already."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY

    def __init__(self) -> None:
        super().__init__(
            "This Idempotency-Key was used for another request.",
            code="idempotency.other_request",
            hint="Take a new key for each new thing, the same one only to send the very same request again.",
        )


class MadeAndDeleted(Conflict):
    """It is neither there nor to be made again."""

    def __init__(self) -> None:
        super().__init__(
            "What this Idempotency-Key had created was deleted since.",
            code="idempotency.deleted",
            hint="Take a new key to create it once more.",
        )


class Once:
    """Creates something, unless the request's key says that it was created already."""

    def __init__(
        self, session: Session, viewer: Viewer, key: str | None, request_sha256: str, answer: Response
    ) -> None:
        self._session, self._viewer, self._answer = session, viewer, answer
        self._key, self._request_sha256 = key, request_sha256

    def create(self, make: Callable[[], Made], find: Callable[[UUID], Made]) -> Made:
        """What `make` makes (a row with an `id`), or what an earlier request of the same key made, by `find`."""
        if self._key is None:
            return make()
        row = self._claimed()
        if row is None:
            return self._found_again(find)
        made = make()
        row.made_id = made.id  # type: ignore[attr-defined]
        return made

    def _claimed(self) -> IdempotencyKey | None:
        self._forget_old_keys()
        values = {"person_id": self._viewer.person_id, "key": self._key, "request_sha256": self._request_sha256}
        claim = insert(IdempotencyKey).values(values).on_conflict_do_nothing().returning(IdempotencyKey)
        return self._session.scalar(claim)

    def _found_again(self, find: Callable[[UUID], Made]) -> Made:
        query = select(IdempotencyKey).filter_by(person_id=self._viewer.person_id, key=self._key)
        earlier = self._session.scalars(query).one()
        if earlier.request_sha256 != self._request_sha256:
            raise KeyOfAnother
        self._answer.headers[REPLAYED] = "true"
        try:
            if earlier.made_id is None:
                raise MadeAndDeleted
            return find(earlier.made_id)
        except NotFound:
            raise MadeAndDeleted from None

    def _forget_old_keys(self) -> None:
        old = select(IdempotencyKey.person_id, IdempotencyKey.key).where(IdempotencyKey.created_at < func.now() - KEPT)
        some = old.limit(1000).with_for_update(skip_locked=True).cte()
        is_old = (IdempotencyKey.person_id == some.c.person_id) & (IdempotencyKey.key == some.c.key)
        self._session.execute(delete(IdempotencyKey).where(is_old).execution_options(synchronize_session=False))


async def _once(
    request: Request,
    answer: Response,
    session: SessionDependency,
    viewer: ViewerDependency,
    idempotency_key: Annotated[
        str | None,
        Header(
            min_length=1,
            max_length=255,
            pattern=r"^[\x21-\x7e]+$",
            description="A name of your choice for this creation, such as a UUID. Sent again with it, the same request "
            "creates nothing new and is answered with what it created the first time, with `Idempotency-Replayed`.",
        ),
    ] = None,
) -> Once:
    return Once(session, viewer, idempotency_key, await _fingerprint(request), answer)


async def _fingerprint(request: Request) -> str:
    """The same for the same request, however its JSON is spaced and sorted."""
    body = await request.body()
    with suppress(ValueError, RecursionError):  # what is no JSON counts as it came
        body = json.dumps(json.loads(body), sort_keys=True).encode()
    asked = b"\n".join((request.method.encode(), request.url.path.encode(), request.url.query.encode(), body))
    return hashlib.sha256(asked).hexdigest()


OnceDependency = Annotated[Once, Depends(_once, scope="function")]
