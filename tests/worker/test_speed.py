"""The speed of this deployment is measured as it goes, and remembered."""

import pytest

from backend.models import Speed
from dropflow.parameters import parse_parameters
from tests.films import PARAMETERS
from tests.house import House
from worker.pace import Pace
from worker.plan import SECONDS_PER_MEGAPIXEL
from worker.speed import known_seconds_per_megapixel, remember

PAPER = parse_parameters(PARAMETERS)


@pytest.fixture(autouse=True)
def _nothing_known(house: House) -> None:
    with house.context.sessions.begin() as session:
        session.query(Speed).delete()


def _known(house: House) -> float:
    with house.context.sessions.begin() as session:
        return known_seconds_per_megapixel(session, PAPER)


def _pace(seconds_per_frame: float) -> Pace:
    pace = Pace(0.0)
    pace.mark(2, 2 * seconds_per_frame, is_last=True)
    return pace


def test_what_was_measured_counts_and_later_shards_correct_it_slowly(house: House) -> None:
    assert _known(house) == SECONDS_PER_MEGAPIXEL
    remember(house.context, PAPER, _pace(6.0), n_pixels=2_000_000)
    assert _known(house) == pytest.approx(3.0)
    remember(house.context, PAPER, _pace(16.0), n_pixels=2_000_000)
    assert _known(house) == pytest.approx(0.8 * 3.0 + 0.2 * 8.0)


def test_nothing_timed_says_nothing(house: House) -> None:
    remember(house.context, PAPER, Pace(0.0), n_pixels=1000)
    assert _known(house) == SECONDS_PER_MEGAPIXEL


def test_a_run_measures_and_a_film_is_divided_by_what_was_measured(house: House) -> None:
    experiment = house.ready()
    house.start(experiment)
    house.work()
    assert _known(house) != SECONDS_PER_MEGAPIXEL
