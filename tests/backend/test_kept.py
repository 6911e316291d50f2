"""What was made once is not made again, by however many it is asked for, and memory stays bounded."""

import threading
import time

import pytest

from backend.platform.kept import Kept
from tests.house import House


def test_many_who_ask_at_once_have_it_made_once() -> None:
    kept, made, got = Kept(), [], []

    def make() -> str:
        time.sleep(0.05)
        made.append(1)
        return "figure"

    threads = [threading.Thread(target=lambda: got.append(kept.get("a", make))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert (made, got) == ([1], ["figure"] * 8)


def test_what_was_not_asked_for_longest_goes_first() -> None:
    kept, made = Kept(most_bytes=30), []

    def ask(key: str) -> None:
        kept.get(key, lambda: made.append(key) or "x" * 10)  # type: ignore[func-returns-value]

    for key in ("a", "b", "c", "a", "d", "a", "b"):
        ask(key)
    assert made == ["a", "b", "c", "d", "b"]


def test_what_could_not_be_made_is_tried_again() -> None:
    kept = Kept()

    def fail() -> str:
        raise ValueError

    with pytest.raises(ValueError, match=r"^$"):
        kept.get("a", fail)
    assert kept.get("a", lambda: "made") == "made"


def test_a_figure_is_kept_for_its_question_and_only_once_the_run_is_completed(house: House) -> None:
    run = house.start(house.ready())
    house.work()
    asked = f"runs/{run['id']}/figures/moments"
    first, again = house.api.get(asked), house.api.get(asked)
    assert first.status_code == 200
    assert (first.content, first.headers["etag"]) == (again.content, again.headers["etag"])
    other = house.api.get(asked, params={"to_s": 1.5})
    assert other.content != first.content
    house.api.delete(f"runs/{run['id']}").raise_for_status()
    assert house.api.get(asked).status_code == 404
