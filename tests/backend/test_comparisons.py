"""Runs beside each other: the numbers and curves of each, in what they differ, and only what one may see."""

import io
import json
from uuid import uuid4

import polars as pl
import pytest

from backend.comparisons.schemas import ComparisonFigureName
from backend.models import Right
from dropflow.figures.compared import COMPARED
from tests.films import PARAMETERS
from tests.house import House, Json
from tests.lab import Lab

OTHER = PARAMETERS | {"flow": {"n_columns": 6, "n_rows": 4}}
FIGURES = [name.value for name in ComparisonFigureName]


@pytest.fixture(scope="module")
def runs(shared_house: House) -> list[Json]:
    """Two runs of one film that differ in one parameter."""
    experiment = shared_house.ready()
    started = [shared_house.start(experiment, parameters) for parameters in (PARAMETERS, OTHER)]
    shared_house.work()
    return [shared_house.again(run) for run in started]


def _asked(runs: list[Json]) -> list[tuple[str, str]]:
    return [("run", run["id"]) for run in runs]


def test_every_figure_of_the_library_has_its_name_here() -> None:
    assert [entry.name for entry in COMPARED] == FIGURES


def test_numbers_are_those_of_each_run_and_only_what_differs_is_listed(shared_house: House, runs: list[Json]) -> None:
    found = shared_house.ok(shared_house.api.get("compare", params=_asked(runs)))
    assert [run["id"] for run in found["runs"]] == [run["id"] for run in runs]
    assert [run["label"] for run in found["runs"]] == [f"run {run['number']}" for run in runs]
    numbers = {number["name"]: number["values"] for number in found["numbers"]}
    assert numbers["n_trajectories"] == [run["summary"]["n_trajectories"] for run in runs]
    assert numbers["tracked.mean_radius_um"] == [run["summary"]["tracked"]["mean_radius_um"] for run in runs]
    assert [field["name"] for field in found["parameters"]] == ["flow.n_columns"]
    assert found["parameters"][0]["values"] == [5, 6]
    assert found["experiment"] == []
    assert all(figure["is_available"] for figure in found["figures"])


@pytest.mark.parametrize("name", FIGURES)
def test_each_run_has_its_line_in_its_colour_or_is_left_out_with_the_reason(
    shared_house: House, runs: list[Json], name: str
) -> None:
    about = shared_house.ok(shared_house.api.get("compare", params=_asked(runs)))["runs"]
    figure = shared_house.ok(shared_house.api.get(f"compare/figures/{name}", params=_asked(runs)))
    left_out = figure["layout"]["meta"]["left_out"]
    if name == "periods_against_driving":
        assert [one["run"] for one in left_out] == [run["id"] for run in runs]
        assert all("temperature log" in one["reason"] for one in left_out)
        return
    assert left_out == []
    drawn = {(trace["name"], trace["line"]["color"]) for trace in figure["data"]}
    assert drawn == {(run["label"], run["colour"]) for run in about}


def test_the_table_has_the_rows_of_each_run(shared_house: House, runs: list[Json]) -> None:
    content = shared_house.api.get("compare/figures/moments/table.csv", params=_asked(runs)).text
    first, _, rest = content.partition("\n")
    assert set(json.loads(first.removeprefix("# dropflow: "))["runs"]) == {"run 1", "run 2"}
    table = pl.read_csv(io.StringIO(rest))
    for run in runs:
        alone = shared_house.api.get(f"runs/{run['id']}/figures/moments/table.csv").text
        mine = table.filter(pl.col("run") == f"run {run['number']}").drop("run")
        assert mine.equals(pl.read_csv(io.StringIO(alone), comment_prefix="#"))


def test_a_range_holds_for_all(shared_house: House, runs: list[Json]) -> None:
    asked = [*_asked(runs), ("from_s", "1e6")]
    nothing = shared_house.ok(shared_house.api.get("compare/figures/moments", params=asked))
    assert nothing["data"] == []
    assert [note["text"] for note in nothing["layout"]["annotations"]][-1] == "no droplets"


def test_runs_that_have_not_come_to_it_are_left_out(shared_house: House, runs: list[Json]) -> None:
    young = shared_house.start(shared_house.ready())
    asked = _asked([*runs, young])
    figure = shared_house.ok(shared_house.api.get("compare/figures/velocity_against_radius", params=asked))
    assert [one["run"] for one in figure["layout"]["meta"]["left_out"]] == [young["id"]]
    found = shared_house.ok(shared_house.api.get("compare", params=asked))
    assert all(number["values"][2] is None for number in found["numbers"])
    alone = shared_house.ok(shared_house.api.get("compare", params=_asked([young])))
    assert not any(entry["is_available"] for entry in alone["figures"])
    assert len({run["colour"] for run in found["runs"]}) == 3


@pytest.mark.parametrize("asked", [[], ["no-id"], [str(uuid4())] * 2, [str(uuid4()) for _ in range(9)]])
def test_none_too_many_and_twice_the_same_are_refused(shared_house: House, asked: list[str]) -> None:
    for address in ("compare", "compare/figures/moments", "compare/figures/moments/table.csv"):
        answer = shared_house.api.get(address, params=[("run", run) for run in asked])
        assert (answer.status_code, answer.json()["code"]) == (422, "request.invalid")
        assert answer.json()["errors"][0]["field"].startswith("run")


@pytest.mark.parametrize(
    ("name", "asked"), [("moments", ("frame", "1")), ("moments", ("signal", "n_small")), ("moments", ("from_s", "nan"))]
)
def test_what_a_figure_does_not_take_is_refused(
    shared_house: House, runs: list[Json], name: str, asked: tuple[str, str]
) -> None:
    answer = shared_house.api.get(f"compare/figures/{name}", params=[*_asked(runs), asked])
    assert (answer.status_code, answer.json()["errors"][0]["field"]) == (422, asked[0])


def test_a_run_that_one_may_not_see_is_as_if_it_were_not_there(lab: Lab) -> None:
    mine, theirs = lab.group("Mine"), lab.group("Theirs")
    ada = lab.browser(lab.person("ada", {mine: Right.VIEW}))
    seen, unseen = lab.finished(mine)[1], lab.finished(theirs)[1]
    assert ada.get("compare", params={"run": str(seen)}).status_code == 200
    for address in ("compare", "compare/figures/moments", "compare/figures/moments/table.csv"):
        answers = [ada.get(address, params={"run": [str(seen), str(other)]}) for other in (unseen, uuid4())]
        assert [answer.status_code for answer in answers] == [404, 404]
        assert answers[0].json() == answers[1].json()
