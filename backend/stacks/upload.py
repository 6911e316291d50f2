"""One file on its way from a person into the object store: whole, or not at all."""

from collections.abc import AsyncIterator
from dataclasses import dataclass
from uuid import UUID, uuid4

from fastapi.concurrency import run_in_threadpool
from obstore.exceptions import BaseError
from sqlalchemy.orm import Session

from backend.experiments.service import get, get_locked
from backend.groups.quotas import demand_room
from backend.models import Experiment, File
from backend.models.lifecycle import remove_files
from backend.models.states import STACK_RULES, rule
from backend.platform.dependencies import Platform
from backend.platform.events import announce, experiment_topic
from backend.platform.object_store import file_key
from backend.platform.store_errors import store_error
from backend.platform.visibility import Viewer
from backend.stacks import names, repository
from backend.stacks.content import Content
from backend.stacks.errors import StackClosed, TooLarge
from backend.stacks.schemas import Role

MAX_TABLE_BYTES = 50_000_000


@dataclass(frozen=True)
class Upload:
    """What is said of a file before its bytes come."""

    viewer: Viewer
    experiment_id: UUID
    name: str
    role: Role
    announced_bytes: int | None


async def receive(platform: Platform, upload: Upload, body: AsyncIterator[bytes]) -> File:
    """Take a file in. No transaction is open while its bytes come; a cut connection leaves nothing."""
    names.checked(upload.name)
    max_bytes, limit = await run_in_threadpool(_room, platform, upload)
    if (upload.announced_bytes or 0) > max_bytes:
        raise TooLarge(limit, max_bytes, upload.name)
    content = Content(body, name=upload.name, role=upload.role, max_bytes=max_bytes, limit=limit)
    file_id = uuid4()
    key = file_key(upload.experiment_id, file_id)
    try:
        await platform.store.put_stream(key, content.__aiter__())
        return await run_in_threadpool(_record, platform, upload, file_id, content)
    except (BaseError, OSError) as problem:
        raise store_error(problem) from None
    except BaseException:
        await run_in_threadpool(platform.store.remove, key)
        raise


def _room(platform: Platform, upload: Upload) -> tuple[int, str]:
    """How many bytes may come, and what they would exceed."""
    with platform.sessions.begin() as session:
        experiment = get(session, upload.viewer, upload.experiment_id)
        _check_open(experiment)
        demand_room(session, platform.settings, experiment.group, upload.announced_bytes or 0)
        left = platform.settings.max_stack_bytes - _other_bytes(session, upload)
    if upload.role not in (Role.FRAMES, Role.FLAT_FIELD):
        return min(MAX_TABLE_BYTES, left), "table"
    return min((platform.settings.max_file_bytes, "file"), (max(left, 0), "stack"))


def _record(platform: Platform, upload: Upload, file_id: UUID, content: Content) -> File:
    """Write the row that makes the object count; a file of the same name gives way."""
    with platform.sessions.begin() as session:
        experiment = get_locked(session, upload.viewer, upload.experiment_id)
        _check_open(experiment)
        if _other_bytes(session, upload) + content.size_bytes > platform.settings.max_stack_bytes:
            raise TooLarge("stack", platform.settings.max_stack_bytes, upload.name)
        demand_room(session, platform.settings, experiment.group, content.size_bytes)
        if earlier := repository.named(session, experiment.id, upload.role, upload.name):
            remove_files(session, experiment.id, File.id == earlier.id)
        file = File(
            id=file_id,
            experiment_id=experiment.id,
            role=upload.role,
            name=upload.name,
            size_bytes=content.size_bytes,
            sha256=content.sha256,
            store_key=file_key(experiment.id, file_id),
        )
        session.add(file)
        experiment.stack.state = rule(STACK_RULES, "upload").target
        experiment.stack.problem = None
        announce(session, experiment_topic(experiment.id))
        return file


def _other_bytes(session: Session, upload: Upload) -> int:
    """Bytes of the experiment's files without the one that this upload replaces."""
    earlier = repository.named(session, upload.experiment_id, upload.role, upload.name)
    return repository.size_bytes(session, upload.experiment_id) - (earlier.size_bytes if earlier else 0)


def _check_open(experiment: Experiment) -> None:
    if experiment.stack.state not in rule(STACK_RULES, "upload").sources:
        raise StackClosed
