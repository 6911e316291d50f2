"""Time left, and how sure that is."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.runs.progress import seconds_left
from backend.runs.repository import Done


def _timed(samples_s: list[float], frames_each: int, n_busy: int = 1) -> Done:
    n, k = frames_each * len(samples_s), len(samples_s)
    paces = [sample / frames_each for sample in samples_s]
    mean = sum(paces) / k
    std = (sum((pace - mean) ** 2 for pace in paces) / k) ** 0.5
    return Done(n, 0, n_busy, k, float(n), mean, std)


def test_what_goes_evenly_is_sure() -> None:
    assert seconds_left(100, _timed([2.0] * 8, 4)) == (pytest.approx(50.0), pytest.approx(0.0, abs=1e-6))


def test_two_processes_take_half_as_long() -> None:
    one, two = (seconds_left(100, _timed([1.0, 2.0, 3.0, 2.0], 4, n_busy)) for n_busy in (1, 2))
    assert two == (pytest.approx(one[0] / 2), pytest.approx(one[1] / 2))


@given(st.integers(1, 10_000))
def test_nothing_left_takes_no_time(n_busy: int) -> None:
    assert seconds_left(0, _timed([1.0, 2.0], 3, n_busy)) == (0.0, 0.0)


def test_what_is_said_of_the_uncertainty_is_true() -> None:
    """Of many films the time it takes is within one said deviation as often as it should be."""
    dice = random.Random(1)
    n_within = 0
    for _ in range(2000):
        samples = [dice.gauss(2.0, 0.4) for _ in range(24)]
        left_s, std_s = seconds_left(60, _timed(samples[:12], 5))
        n_within += abs(sum(samples[12:]) - left_s) <= std_s
    assert n_within / 2000 == pytest.approx(0.68, abs=0.06)


def test_before_anything_was_timed_nothing_is_said() -> None:
    with pytest.raises(ValueError, match="timed"):
        seconds_left(10, Done(3, 0))
