"""The end of an upload: every byte is here, so its files are recorded, all or none."""

import hashlib
import time
from collections.abc import Callable
from itertools import accumulate
from uuid import uuid4

from sqlalchemy import func, tuple_

from backend.models import File
from backend.models.lifecycle import remove_files
from backend.models.states import STACK_RULES, rule
from backend.platform.dependencies import Platform
from backend.platform.events import announce, experiment_topic
from backend.platform.places import INDEX_NAME, READ_BYTES, Place, write_index
from backend.platform.problems import problem_of
from backend.stacks.content import check_kind
from backend.stacks.errors import WrongKind
from backend.uploads import repository, service
from backend.uploads.errors import ChecksumMismatch
from backend.uploads.holding import HOLD_S, Held, begin_anew, let_go, refuse, save
from backend.uploads.intake import Intake
from dropflow.frames.kinds import HEAD_BYTES

_REMEMBERED_S = 86_400.0


def finish(platform: Platform, held: Held, intake: Intake) -> None:
    """Record the files of an upload of which every byte is safe. What goes wrong here is not lost: ask again."""
    try:
        _write_index(platform, held)
        checksums = _checksums(platform, held, intake)
        _check_announced(held, checksums)
        _record(platform, held, checksums)
    except WrongKind as problem:
        refuse(platform, held, problem_of(problem))
        raise
    except ChecksumMismatch:
        begin_anew(platform, held)
        raise
    except BaseException:
        let_go(platform, held, held.size_bytes, ())
        raise


def _write_index(platform: Platform, held: Held) -> None:
    """Where the bytes are in pieces, say beside them which these are, and remove those of senders who lost it."""
    if not held.store_key.endswith("/"):
        return
    with platform.sessions.begin() as session:
        pieces = repository.pieces(session, held.upload_id)
    platform.store.put(held.store_key + INDEX_NAME, write_index(pieces))
    known = {held.store_key + piece.name for piece in pieces} | {held.store_key + INDEX_NAME}
    for key, _ in platform.store.list(held.store_key):
        if key not in known:
            platform.store.remove(key)


def _checksums(platform: Platform, held: Held, intake: Intake) -> list[str]:
    """Of every file; those that the intake did not see whole are read again."""
    starts = [0, *accumulate(file.size_bytes for file in held.files)]
    alive = _keeping(platform, held)
    found = []
    for number, file in enumerate(held.files):
        known = intake.sha256.get(number)
        if known is None:
            known, head = _read(platform, Place(held.store_key, starts[number], file.size_bytes), alive)
            check_kind(head, file.name, file.role)
        found.append(known)
    return found


def _read(platform: Platform, place: Place, alive: Callable[[], None]) -> tuple[str, bytes]:
    digest, head = hashlib.sha256(), b""
    with platform.store.open_place(place) as file:
        while content := file.read(READ_BYTES):
            digest.update(content)
            head = head or content[:HEAD_BYTES]
            alive()
    return digest.hexdigest(), head


def _keeping(platform: Platform, held: Held) -> Callable[[], None]:
    """Keep the upload while something long goes on."""
    renewed = time.monotonic()

    def alive() -> None:
        nonlocal renewed
        if time.monotonic() - renewed > HOLD_S / 4:
            save(platform, held, held.size_bytes, (), is_alive=True)
            renewed = time.monotonic()

    return alive


def _check_announced(held: Held, checksums: list[str]) -> None:
    for file, sha256 in zip(held.files, checksums, strict=True):
        if file.sha256 is not None and file.sha256 != sha256:
            raise ChecksumMismatch(file.name)


def _record(platform: Platform, held: Held, checksums: list[str]) -> None:
    """Write the rows that make the bytes count; files of the same names give way."""
    with platform.sessions.begin() as session:
        experiment = service.open_experiment(session, held.viewer, held.experiment_id, lock=True)
        upload = service.find(session, held.viewer, held.experiment_id, held.upload_id, lock=True)
        if upload.fence != held.fence or upload.finished_at is not None:
            return  # somebody else finishes it, or has
        remove_files(session, experiment.id, tuple_(File.role, File.name).in_([file.key for file in held.files]))
        start_byte = 0
        for file, sha256 in zip(held.files, checksums, strict=True):
            session.add(
                File(
                    id=uuid4(),
                    experiment_id=experiment.id,
                    role=file.role,
                    name=file.name,
                    size_bytes=file.size_bytes,
                    sha256=sha256,
                    store_key=held.store_key,
                    start_byte=start_byte,
                )
            )
            start_byte += file.size_bytes
        upload.finished_at, upload.held_until = func.now(), None
        upload.expires_at = repository.in_seconds(_REMEMBERED_S)
        repository.forget_pieces(session, upload.id)
        experiment.stack.state = rule(STACK_RULES, "upload").target
        experiment.stack.problem = None
        announce(session, experiment_topic(experiment.id))
