"""Several analyses in one figure."""

from pathlib import Path

import numpy as np
import pytest

from dropflow.figures.compared import COMPARED, COMPARED_BY_NAME, Compared, ComparedEntry, table_of_all
from dropflow.figures.layout import COLOURS_OF_RUNS
from dropflow.results import open_results
from dropflow.statistics.findings import Findings
from dropflow.statistics.side_by_side import differing
from tests.dropflow.report.conftest import results_folder, short_results

__all__ = ["results_folder", "short_results"]


@pytest.fixture(scope="module")
def whole(results_folder: Path) -> Compared:
    results = open_results(results_folder)
    return Compared("whole", COLOURS_OF_RUNS[0], Findings(results.facts, results.condensed))


@pytest.fixture(scope="module")
def short(short_results: Path) -> Compared:
    """One frame: no trajectories, so no depth and no flow."""
    results = open_results(short_results)
    return Compared("short", COLOURS_OF_RUNS[1], Findings(results.facts, results.condensed))


@pytest.mark.parametrize("entry", COMPARED, ids=lambda entry: entry.name)
def test_each_analysis_has_its_colour(entry: ComparedEntry, whole: Compared) -> None:
    """The same twice: lines of both lie on each other."""
    again = Compared("again", COLOURS_OF_RUNS[1], whole.found)
    if entry.left_out(whole):
        assert "temperature log" in entry.left_out(whole)
        return
    figure = entry.draw([whole, again], entry.title)
    lines = {one.label: [trace for trace in figure.data if trace.name == one.label] for one in (whole, again)}
    assert {trace.line.color for trace in lines["again"]} == {again.colour}
    for mine, theirs in zip(lines["whole"], lines["again"], strict=True):
        np.testing.assert_array_equal(mine.y, theirs.y)
    table = table_of_all(entry, [whole, again])
    assert set(table["run"]) == {"whole", "again"}


def test_densities_are_per_volume_only_if_all_depths_are_known(whole: Compared, short: Compared) -> None:
    for name, known, unknown in (
        ("size_distribution_at", "µm<sup>−4</sup>", "µm<sup>−3</sup>"),
        ("moments", "volume fraction", "area fraction"),
    ):
        draw = COMPARED_BY_NAME[name].draw
        assert known in str(draw([whole], "").layout)
        assert unknown in str(draw([whole, short], "").layout)


@pytest.mark.parametrize("entry", COMPARED, ids=lambda entry: entry.name)
def test_nothing_to_compare_is_said(entry: ComparedEntry, short: Compared) -> None:
    words = [note.text for note in entry.draw([], entry.title).layout.annotations]
    assert any(text.startswith("no ") for text in words)
    if entry.name not in ("size_distribution_at", "moments"):  # one frame has droplets
        assert any(text.startswith("no ") for text in (n.text for n in entry.draw([short], "").layout.annotations))
    assert table_of_all(entry, []).is_empty()


def test_only_what_differs_is_listed() -> None:
    documents = [{"a": {"b": 1, "c": [1, 2]}, "d": 3}, {"a": {"b": 1, "c": [1, 3]}}]
    assert differing(documents) == {"a.c": [[1, 2], [1, 3]], "d": [3, None]}
