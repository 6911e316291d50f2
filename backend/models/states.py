"""The states of stacks, runs, stages and shards, and every way from one to another, as a list to read.

Rows change state only along a rule below; SQL takes the states that a rule starts from out of `sources`.
A terminal state has no way out: to retry a failed run is to make a new run.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Generic, TypeVar

State = TypeVar("State", bound=StrEnum)


class StackState(StrEnum):
    """How far the frames of an experiment are."""

    EMPTY = "empty"
    UPLOADING = "uploading"
    INDEXING = "indexing"
    READY = "ready"
    REJECTED = "rejected"
    EXPIRED = "expired"


class RunState(StrEnum):
    """How far an analysis is."""

    QUEUED = "queued"
    RUNNING = "running"
    COMPLETED = "completed"
    FAILED = "failed"
    CANCELLED = "cancelled"


class StageState(StrEnum):
    """How far one stage of a run is."""

    WAITING = "waiting"
    RUNNING = "running"
    COMPLETED = "completed"
    FAILED = "failed"
    CANCELLED = "cancelled"


class ShardState(StrEnum):
    """How far one piece of work is."""

    QUEUED = "queued"
    RUNNING = "running"
    COMPLETED = "completed"
    FAILED = "failed"
    CANCELLED = "cancelled"


@dataclass(frozen=True)
class Rule(Generic[State]):
    """`event` takes a row from any of `sources` to `target`."""

    event: str
    sources: tuple[State, ...]
    target: State
    because: str


STACK_RULES = (
    Rule("upload", (StackState.EMPTY, StackState.UPLOADING, StackState.REJECTED), StackState.UPLOADING, "a file came"),
    Rule(
        "seal",
        (StackState.UPLOADING, StackState.REJECTED),
        StackState.INDEXING,
        "all files are there; a worker reads every frame",
    ),
    Rule(
        "import",
        (StackState.EMPTY, StackState.UPLOADING, StackState.REJECTED),
        StackState.INDEXING,
        "a worker brings the files from where they are, then reads every frame",
    ),
    Rule("accept", (StackState.INDEXING,), StackState.READY, "every frame can be read"),
    Rule("reject", (StackState.INDEXING,), StackState.REJECTED, "a frame cannot be used; its files are removed"),
    Rule("expire", (StackState.READY,), StackState.EXPIRED, "its files went to the trash; results of its runs stay"),
    Rule("restore", (StackState.EXPIRED,), StackState.READY, "they came back from there"),
    Rule("clear", tuple(StackState), StackState.EMPTY, "its files were removed"),
)

RUN_RULES = (
    Rule("start", (RunState.QUEUED, RunState.RUNNING), RunState.RUNNING, "a worker claimed a shard"),
    Rule("complete", (RunState.RUNNING,), RunState.COMPLETED, "the last shard of the last stage was published"),
    Rule("fail", (RunState.QUEUED, RunState.RUNNING), RunState.FAILED, "a shard failed for good"),
    Rule("cancel", (RunState.QUEUED, RunState.RUNNING), RunState.CANCELLED, "asked for, and nothing works on it now"),
)

STAGE_RULES = (
    Rule("start", (StageState.WAITING, StageState.RUNNING), StageState.RUNNING, "a worker claimed a shard of it"),
    Rule("complete", (StageState.WAITING, StageState.RUNNING), StageState.COMPLETED, "its last shard was published"),
    Rule("fail", (StageState.WAITING, StageState.RUNNING), StageState.FAILED, "a shard of it failed for good"),
    Rule("cancel", (StageState.WAITING, StageState.RUNNING), StageState.CANCELLED, "the run ended before it did"),
)

SHARD_RULES = (
    Rule("claim", (ShardState.QUEUED,), ShardState.RUNNING, "a worker took it, with a lease and a new fence"),
    Rule("release", (ShardState.RUNNING,), ShardState.QUEUED, "its worker died, stopped, or met a passing fault"),
    Rule("publish", (ShardState.RUNNING,), ShardState.COMPLETED, "its product was recorded under its fence"),
    Rule("fail", (ShardState.QUEUED, ShardState.RUNNING), ShardState.FAILED, "its input is wrong, or too many tries"),
    Rule("cancel", (ShardState.QUEUED, ShardState.RUNNING), ShardState.CANCELLED, "its run ended before it did"),
)


def rule(rules: tuple[Rule[State], ...], event: str) -> Rule[State]:
    """The rule for `event`; there is one, or it is a bug."""
    return next(candidate for candidate in rules if candidate.event == event)


def is_terminal(rules: tuple[Rule[State], ...], state: State) -> bool:
    """Whether nothing leads out of `state`."""
    return not any(state in candidate.sources for candidate in rules)


ACTIVE_RUN_STATES = tuple(state for state in RunState if not is_terminal(RUN_RULES, state))
OPEN_SHARD_STATES = tuple(state for state in ShardState if not is_terminal(SHARD_RULES, state))
