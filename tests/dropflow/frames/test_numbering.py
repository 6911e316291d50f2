"""What the numbers in files' names say, and when they say nothing."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dropflow.frames.files import natural_order
from dropflow.frames.numbering import numbering


def codes(*names: str) -> list[str]:
    """Of the findings."""
    return [found.code for found in numbering(names).findings]


def test_numbers_without_a_gap_say_nothing() -> None:
    assert numbering([f"a{n}_x2.tif" for n in range(7, 13)]) == numbering(["only one.tif"])


@given(st.sets(st.integers(1, 300), min_size=2), st.sampled_from(["f{}.tif", "run 3/f{:05}_c1.png"]))
def test_every_missing_number_is_in_exactly_one_gap(missing: set[int], form: str) -> None:
    numbers = [n for n in range(1000) if n not in missing]
    found = numbering(natural_order(form.format(n) for n in numbers))
    assert sum(gap.n_missing for gap in found.gaps) == len(missing)
    place = 0
    for gap in found.gaps:
        assert numbers[gap.before_frame] - numbers[gap.before_frame - 1] == gap.n_missing + 1
        assert gap.before_frame > place
        place = gap.before_frame


def test_a_camera_that_counts_in_tens_is_said_and_its_gaps_are_found() -> None:
    found = numbering(["f0010.tif", "f0020.tif", "f0030.tif", "f0050.tif"])
    assert [(gap.before_frame, gap.n_missing) for gap in found.gaps] == [(3, 1)]
    assert [finding.code for finding in found.findings] == ["stack.numbers_missing", "stack.numbers_step"]


@pytest.mark.parametrize(
    "names",
    [
        ["a1.tif", "b2.tif", "b3.tif"],
        ["day1_10.tif", "day1_11.tif", "day2_12.tif"],
        ["first.tif", "second.tif"],
        ["f1.tif", "f01.tif"],
        ["f120000.tif", "f120007.tif", "f120011.tif", "f120026.tif"],
    ],
    ids=["other words", "two numbers", "no number", "one number twice", "times of day"],
)
def test_names_whose_numbers_do_not_count_are_left_to_people(names: list[str]) -> None:
    assert codes(*names) == ["stack.numbers_unclear"]
