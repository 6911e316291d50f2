"""The table of transitions, read as the specification that it is."""

from enum import StrEnum
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.models.states import (
    RUN_RULES,
    SHARD_RULES,
    STACK_RULES,
    STAGE_RULES,
    Rule,
    RunState,
    ShardState,
    StackState,
    StageState,
    is_terminal,
    rule,
)

TABLES: list[tuple[tuple[Rule[Any], ...], type[StrEnum], StrEnum, set[str]]] = [
    (STACK_RULES, StackState, StackState.EMPTY, set()),
    (RUN_RULES, RunState, RunState.QUEUED, {"completed", "failed", "cancelled"}),
    (STAGE_RULES, StageState, StageState.WAITING, {"completed", "failed", "cancelled"}),
    (SHARD_RULES, ShardState, ShardState.QUEUED, {"completed", "failed", "cancelled"}),
]
each_table = pytest.mark.parametrize(
    ("rules", "states", "first", "terminal"), TABLES, ids=["stack", "run", "stage", "shard"]
)


@each_table
def test_what_has_ended_never_changes(
    rules: tuple[Rule[Any], ...], states: type[StrEnum], first: StrEnum, terminal: set[str]
) -> None:
    assert {state for state in states if is_terminal(rules, state)} == terminal


@each_table
def test_every_state_is_reached_and_every_event_is_told_once(
    rules: tuple[Rule[Any], ...], states: type[StrEnum], first: StrEnum, terminal: set[str]
) -> None:
    assert {found.target for found in rules} | {first} == set(states)
    assert len({found.event for found in rules}) == len(rules)
    assert all(found.because for found in rules)


@each_table
def test_from_every_state_an_end_can_be_reached(
    rules: tuple[Rule[Any], ...], states: type[StrEnum], first: StrEnum, terminal: set[str]
) -> None:
    ends = set(terminal) or {StackState.READY}
    for _ in states:
        ends |= {source for found in rules if found.target in ends for source in found.sources}
    assert ends == set(states)


@given(st.lists(st.sampled_from([found.event for found in SHARD_RULES]), max_size=20))
def test_no_order_of_events_leaves_a_terminal_shard_or_works_on_one_that_was_not_claimed(events: list[str]) -> None:
    state, was_claimed = ShardState.QUEUED, False
    for event in events:
        found = rule(SHARD_RULES, event)
        if state not in found.sources:
            continue
        assert not is_terminal(SHARD_RULES, state)
        was_claimed = event == "claim" or (was_claimed and event != "release")
        state = found.target
        assert state is not ShardState.RUNNING or was_claimed
        assert state is not ShardState.COMPLETED or was_claimed
