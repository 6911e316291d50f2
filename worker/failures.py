"""A shard that cannot be done takes what it belongs to with it: its run fails, or its stack is rejected."""

import errno
import os

from sqlalchemy.orm import Session

from backend.models import Experiment
from backend.models.lifecycle import end_run, remove_files
from backend.models.states import STACK_RULES, rule
from backend.platform.events import announce, experiment_topic, run_topic
from backend.platform.problems import Problem
from worker.context import Context
from worker.leases import MAX_ATTEMPTS, MAX_ERRORS, Claim
from worker.outcomes import end_shard, lock_experiment, lock_run

_OURS = "run."
"""Codes of faults that are not the frames' own."""


def fail(context: Context, claim: Claim, problem: Problem, *, keeps_files: bool = False) -> None:
    """End a shard for good, with the cause. Raises `LeaseLost` if it is not ours any more."""
    with context.sessions.begin() as session:
        if claim.run_id is None:
            experiment = lock_experiment(session, claim.experiment_id)
            end_shard(session, claim, "fail")
            reject_stack(session, experiment, problem, keeps_files=keeps_files)
        else:
            run = lock_run(session, claim.run_id)
            end_shard(session, claim, "fail")
            end_run(session, run, "fail", problem=problem.model_dump())
            announce(session, run_topic(run.id), experiment_topic(run.experiment_id))


def reject_stack(session: Session, experiment: Experiment, problem: Problem, *, keeps_files: bool = False) -> None:
    """Say why a stack cannot be used and remove its files.

    They stay where they can be indexed again: the fault is ours, or a few frames are broken, which may be left out.
    """
    experiment.stack.state = rule(STACK_RULES, "reject").target
    experiment.stack.problem = problem.model_dump()
    if not keeps_files and not problem.code.startswith(_OURS):
        remove_files(session, experiment.id)
    announce(session, experiment_topic(experiment.id))


def cause_of(error: Exception, claim: Claim) -> Problem:
    """A fault that is not the frames' own, in words for people. What the error itself says is for the log alone."""
    return no_space() if _is_disk_full(error) else _unexpected(error, claim)


def no_space() -> Problem:
    """What was made could not be kept."""
    return Problem(
        title="Insufficient Storage",
        status=507,
        code="run.no_space",
        detail="The service has no space left on its disk for what this makes.",
        hint="Free some space (results or frames that are not needed), then try again: it goes on with what is done.",
    )


def _is_disk_full(error: BaseException | None) -> bool:
    """Libraries wrap the system's error in their own, and some keep only its words."""
    while error is not None:
        if getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT) or os.strerror(errno.ENOSPC) in str(error):
            return True
        error = error.__cause__ or error.__context__
    return False


def _unexpected(error: Exception, claim: Claim) -> Problem:
    where = f" of frames {claim.start_frame} to {claim.stop_frame - 1}" if claim.stop_frame > claim.start_frame else ""
    return Problem(
        title="Internal Server Error",
        status=500,
        code="run.internal",
        detail=f"An unexpected error ({type(error).__name__}) occurred {MAX_ERRORS} times in {claim.task}{where}.",
        hint=f"Please report it with the lines of the service's log that name shard {claim.shard_id}. "
        "To try again goes on with what is done already.",
    )


def worker_lost(first_frame: int, last_frame: int, task: str) -> Problem:
    """Whoever worked on a shard fell silent, again and again."""
    where = f" at frames {first_frame} to {last_frame}" if last_frame > first_frame else ""
    return Problem(
        title="Internal Server Error",
        status=500,
        code="run.worker_lost",
        detail=f"The worker stopped without a word {MAX_ATTEMPTS} times while it was busy with {task}{where}.",
        hint="Most often memory ran out, or the machine was switched off. To try again goes on with what is done.",
    )
