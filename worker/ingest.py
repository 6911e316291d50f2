"""Task ingest: read every frame of an uploaded stack once, so that it is known to be good, or say what is not."""

from contextlib import ExitStack
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from backend.models import Experiment, File
from backend.models.states import STACK_RULES, rule
from backend.platform.events import announce, experiment_topic
from backend.platform.object_store import product_prefix
from backend.platform.store_files import StoreFiles
from dropflow.experiment import parse_experiment
from dropflow.frames import Choice, open_frames
from dropflow.ingest import StackFile, StackIndex, check_frames, index_stack
from worker.context import Context
from worker.film import FRAMES_ROLE, uploaded_files
from worker.leases import Lease
from worker.outcomes import end_shard, lock_experiment


def work(context: Context, lease: Lease) -> None:
    """Index the stack, write the index, and call the stack ready."""
    claim = lease.claim
    index = _index(context, lease)
    key = product_prefix(claim.experiment_id, claim.shard_id, claim.fence) + "index.json"
    context.store.put(key, index.model_dump_json().encode())
    with context.sessions.begin() as session:
        experiment = lock_experiment(session, claim.experiment_id)
        end_shard(session, claim, "publish", done_frames=index.n_frames)
        _accept(experiment, index, key)
        announce(session, experiment_topic(experiment.id))


def _index(context: Context, lease: Lease) -> StackIndex:
    experiment_id = lease.claim.experiment_id
    with context.sessions.begin() as session:
        document = session.get_one(Experiment, experiment_id).document
        files = uploaded_files(session, experiment_id)
        known = _known(session, experiment_id)
    experiment = parse_experiment(document)
    source = StoreFiles(context.store, files[FRAMES_ROLE])
    with ExitStack() as opened:
        attachments = {
            role: opened.enter_context(context.store.open_place(place))
            for role, named in files.items()
            if role != FRAMES_ROLE
            for place in named.values()
        }
        index = index_stack(source, experiment, attachments=attachments, known=known, progress=lease.alive)
        frames = opened.enter_context(open_frames(source, Choice.of(experiment)))
        return index.checked(check_frames(frames, progress=lease, max_share_broken=experiment.max_failed_frame_share))


def _known(session: Session, experiment_id: UUID) -> dict[str, StackFile]:
    """Size and checksum of each file of frames, as they were when it came."""
    query = select(File.name, File.size_bytes, File.sha256)
    rows = session.execute(query.where(File.experiment_id == experiment_id, File.role == FRAMES_ROLE))
    return {name: StackFile(name=name, size_bytes=size_bytes, sha256=sha256) for name, size_bytes, sha256 in rows}


def _accept(experiment: Experiment, index: StackIndex, index_key: str) -> None:
    stack = experiment.stack
    stack.state = rule(STACK_RULES, "accept").target
    stack.n_frames, stack.rows, stack.columns, stack.dtype = index.n_frames, index.n_rows, index.n_columns, index.dtype
    stack.duration_s = index.times_s[-1] - index.times_s[0]
    stack.warnings = [str(warning) for warning in index.warnings]
    stack.broken_frames = list(index.broken_frames)
    stack.checksum, stack.index_key = index.sha256, index_key
