"""The plan of a run."""

from hypothesis import given
from hypothesis import strategies as st

from backend.platform.queue import QUEUE_OF_TASK
from worker.plan import (
    MIN_SHARDS,
    NEXT_TASK,
    SECONDS_PER_MEGAPIXEL,
    SECONDS_PER_SHARD,
    STAGE_OF_TASK,
    Task,
    detect_ranges,
)
from worker.shards import WORK

films = {"n_frames": st.integers(1, 20_000), "shape": st.tuples(st.integers(1, 5000), st.integers(1, 5000))}


@given(**films)
def test_every_frame_is_in_one_shard_and_shards_are_in_order(n_frames: int, shape: tuple[int, int]) -> None:
    ranges = detect_ranges(n_frames, shape)
    assert [frame for frames in ranges for frame in frames] == list(range(n_frames))
    assert all(len(frames) > 0 for frames in ranges)


@given(**films)
def test_a_shard_is_short_and_a_film_is_divided(n_frames: int, shape: tuple[int, int]) -> None:
    ranges = detect_ranges(n_frames, shape)
    seconds_per_frame = shape[0] * shape[1] / 1e6 * SECONDS_PER_MEGAPIXEL
    assert all(len(frames) == 1 or len(frames) * seconds_per_frame <= SECONDS_PER_SHARD for frames in ranges)
    assert len(ranges) >= min(n_frames, MIN_SHARDS) / 2


@given(**films)
def test_the_same_film_is_always_divided_alike(n_frames: int, shape: tuple[int, int]) -> None:
    assert detect_ranges(n_frames, shape) == detect_ranges(n_frames, shape)


def test_a_run_goes_through_its_tasks_to_the_end() -> None:
    task, seen = Task.PREPARE, [Task.PREPARE]
    while (following := NEXT_TASK[task]) is not None:
        task = following
        seen.append(task)
    assert seen == [Task.PREPARE, Task.DETECT, Task.TRACK, Task.ANALYSE]
    assert list(dict.fromkeys(STAGE_OF_TASK[task] for task in seen)) == ["detect", "track", "analyse"]


def test_every_task_has_its_queue_and_somebody_who_does_it() -> None:
    assert set(QUEUE_OF_TASK) == set(WORK) == set(Task)
