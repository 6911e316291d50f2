"""How fast work goes."""

import pytest

from worker.pace import Pace


def test_the_first_frame_is_not_timed_for_what_is_compiled_with_it() -> None:
    pace = Pace(0.0)
    for n_done, now_s in ((1, 30.0), (3, 32.0), (5, 34.0), (6, 35.0)):
        pace.mark(n_done, now_s)
    assert (pace.n_samples, pace.n_frames) == (3, 5)
    assert pace.mean_s == pytest.approx(1.0)
    assert pace.std_s == pytest.approx(0.0, abs=1e-9)


def test_an_only_frame_is() -> None:
    pace = Pace(10.0)
    pace.mark(1, 12.0, is_last=True)
    assert (pace.n_samples, pace.mean_s, pace.std_s) == (1, 2.0, 0.0)


def test_where_it_goes_on_is_no_work() -> None:
    pace = Pace(0.0)
    pace.mark(500, 1.0)
    pace.mark(502, 3.0)
    assert (pace.n_frames, pace.mean_s) == (2, 1.0)


def test_stretches_that_differ_say_by_how_much() -> None:
    pace = Pace(0.0)
    for n_done, now_s in ((1, 0.0), (2, 1.0), (3, 4.0)):
        pace.mark(n_done, now_s)
    assert (pace.mean_s, pace.std_s) == (2.0, 1.0)


def test_before_anything_is_done_there_is_no_pace() -> None:
    assert (Pace(0.0).mean_s, Pace(0.0).std_s) == (None, None)
