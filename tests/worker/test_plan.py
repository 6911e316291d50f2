"""The plan of a run."""

from hypothesis import given
from hypothesis import strategies as st

from backend.platform.queue import QUEUE_OF_TASK
from worker.plan import (
    MIN_SHARDS,
    NEXT_TASK,
    SECONDS_PER_SHARD,
    STAGE_OF_TASK,
    Task,
    detect_ranges,
)
from worker.shards import WORK

films = {"n_frames": st.integers(1, 20_000), "seconds": st.floats(1e-4, 100.0)}


@st.composite
def _divided_before(draw: st.DrawFn) -> tuple[int, list[range]]:
    """A film, and ranges of it that earlier runs have made; some of them overlap, some are of another film."""
    n_frames = draw(st.integers(1, 2000))
    edges = st.tuples(st.integers(0, 2100), st.integers(1, 300))
    return n_frames, [range(start, start + length) for start, length in draw(st.lists(edges, max_size=20))]


@given(**films)
def test_every_frame_is_in_one_shard_and_shards_are_in_order(n_frames: int, seconds: float) -> None:
    ranges = detect_ranges(n_frames, seconds)
    assert [frame for frames in ranges for frame in frames] == list(range(n_frames))
    assert all(len(frames) > 0 for frames in ranges)


@given(**films)
def test_a_shard_is_short_and_a_film_is_divided(n_frames: int, seconds: float) -> None:
    ranges = detect_ranges(n_frames, seconds)
    assert all(len(frames) == 1 or len(frames) * seconds <= SECONDS_PER_SHARD for frames in ranges)
    assert len(ranges) >= min(n_frames, MIN_SHARDS) / 2


@given(st.integers(1, 20_000), st.floats(0.01, 5.0))
def test_a_long_film_is_not_cut_into_crumbs(n_frames: int, seconds: float) -> None:
    ranges = detect_ranges(n_frames, seconds)
    is_long = n_frames * seconds > 2 * MIN_SHARDS * SECONDS_PER_SHARD
    assert not is_long or min(map(len, ranges)) * seconds >= SECONDS_PER_SHARD / 2 - seconds


@given(_divided_before(), st.floats(1e-3, 10.0))
def test_what_was_made_before_keeps_its_borders_and_the_rest_is_divided(
    film: tuple[int, list[range]], seconds: float
) -> None:
    n_frames, made = film
    ranges = detect_ranges(n_frames, seconds, made)
    assert [frame for frames in ranges for frame in frames] == list(range(n_frames))
    kept = [frames for frames in made if frames.stop <= n_frames]
    if kept:
        assert min(kept, key=lambda frames: (frames.start, -frames.stop)) in ranges


def test_ranges_that_fill_a_film_are_all_taken_over() -> None:
    made = detect_ranges(1000, 0.5)
    assert detect_ranges(1000, 3.0, made) == made
    assert detect_ranges(1000, 0.01, reversed(made)) == made


def test_a_run_goes_through_its_tasks_to_the_end() -> None:
    task, seen = Task.PREPARE, [Task.PREPARE]
    while (following := NEXT_TASK[task]) is not None:
        task = following
        seen.append(task)
    assert seen == [Task.PREPARE, Task.DETECT, Task.TRACK, Task.ANALYSE]
    assert list(dict.fromkeys(STAGE_OF_TASK[task] for task in seen)) == ["detect", "track", "analyse"]


def test_every_task_has_its_queue_and_somebody_who_does_it() -> None:
    assert set(QUEUE_OF_TASK) == set(WORK) == set(Task)
