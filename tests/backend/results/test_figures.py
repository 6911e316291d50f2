"""Figures: each shows something or says why not, takes what it says that it takes, and gives its numbers away."""

import io
import json
from pathlib import Path

import polars as pl
import pytest
from sqlalchemy import select

from backend.models import Product, Shard
from backend.platform.kept import Kept
from dropflow.figures.catalogue import CATALOGUE
from dropflow.figures.example import EXAMPLE_FILE, WORKING_PANELS
from tests.backend.results.figures import FIGURES
from tests.house import House, Json

ROOT = Path(__file__).parents[3]
OF_SIZES = "figures/size_distribution_after"


@pytest.mark.parametrize("name", FIGURES)
def test_every_figure_has_something_to_show(shared_house: House, run: Json, name: str) -> None:
    """Or says why there is nothing: the film of these tests is short."""
    figure = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/figures/{name}"))
    words = " ".join(found["text"] for found in figure["layout"]["annotations"])
    assert figure["data"] or any(word in words for word in ("no ", "fewer", "too few", "unknown")), words
    assert figure["layout"]["title"]["text"]


def test_the_list_of_figures_says_what_there_is_and_what_each_takes(shared_house: House, run: Json) -> None:
    items = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/figures"))["items"]
    assert [item["name"] for item in items] == [entry.name for entry in CATALOGUE]
    there = {item["name"] for item in items if item["is_available"]}
    assert there == {name.partition("?")[0] for name in FIGURES}
    for item in items:
        assert item["is_available"] == (item["reason"] is None)
        assert (ROOT / "docs" / item["docs"]).is_file(), item["docs"]
    after = next(item for item in items if item["name"] == "size_distribution_after")
    radius = next(found for found in after["parameters"] if found["name"] == "radius_min_um")
    smallest_um = run["parameters"]["detection"]["radius_min_um"]
    assert (radius["unit"], radius["low"], radius["is_required"]) == ("µm", smallest_um, False)


def test_every_table_has_its_provenance_and_units_in_its_names(shared_house: House, run: Json) -> None:
    items = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/figures"))["items"]
    for item in items:
        answer = shared_house.api.get(f"runs/{run['id']}/figures/{item['name']}/table.csv")
        if not (item["has_table"] and item["is_available"]):
            assert answer.status_code in {404, 422}
            continue
        first, rest = answer.text.split("\n", 1)
        assert json.loads(first.removeprefix("# dropflow: "))["input_sha256"]
        assert pl.read_csv(io.StringIO(rest)).width > 1, item["name"]


def test_a_range_of_times_and_radii_leaves_the_rest_out(shared_house: House, run: Json) -> None:
    address = f"runs/{run['id']}/{OF_SIZES}"
    times = pl.read_csv(io.StringIO(shared_house.api.get(f"{address}/table.csv").text.split("\n", 1)[1]))["time_s"]
    second_s, fourth_s = times.unique().sort().to_list()[1:4:2]
    limits = f"from_s={second_s}&to_s={fourth_s}&radius_min_um=6&radius_max_um=20"
    answer = shared_house.api.get(f"{address}/table.csv?{limits}")
    rows = pl.read_csv(io.StringIO(answer.text.split("\n", 1)[1]))
    assert rows["time_s"].n_unique() == 3
    assert (rows["time_s"].min(), rows["time_s"].max()) == (second_s, fourth_s)
    assert 5 < rows["radius_from_um"].min() < rows["radius_to_um"].max() < 22
    nothing = shared_house.ok(shared_house.api.get(f"{address}?from_s=9000"))
    assert "no droplets" in json.dumps(nothing["layout"]["annotations"])


@pytest.mark.parametrize(
    ("query", "field"),
    [
        ("figures/moments?frame=1", "frame"),
        ("figures/moments?from_s=nan", "from_s"),
        ("figures/moments?from_s=3&to_s=2", "from_s"),
        ("figures/moments?radius_min_um=1000", "radius_min_um"),
        ("figures/moments?bins=9", "bins"),
        ("figures/forward_tracking?frame=1", "trajectory"),
        ("figures/oscillations?signal=noise", "signal"),
    ],
)
def test_what_a_figure_does_not_take_is_named(shared_house: House, run: Json, query: str, field: str) -> None:
    answer = shared_house.api.get(f"runs/{run['id']}/{query}")
    assert answer.status_code == 422, answer.text
    assert field in answer.json()["errors"][0]["field"]


def test_a_figure_that_the_film_cannot_give_says_why(shared_house: House, run: Json) -> None:
    answer = shared_house.api.get(f"runs/{run['id']}/figures/viscosity")
    assert (answer.status_code, answer.json()["code"]) == (404, "results.not_of_this_film")


def test_a_figure_of_one_frame_needs_the_frame(shared_house: House, run: Json) -> None:
    answer = shared_house.api.get(f"runs/{run['id']}/figures/flow_field")
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["field"] == "frame"


@pytest.mark.parametrize("name", WORKING_PANELS)
def test_steps_of_detection_are_drawn_of_any_frame(shared_house: House, run: Json, name: str) -> None:
    address = f"runs/{run['id']}/figures/{name}"
    kept = shared_house.ok(shared_house.api.get(address))["layout"]
    drawn = [shared_house.ok(shared_house.api.get(f"{address}?frame={frame}"))["layout"] for frame in (3, 5)]
    said = [" ".join(note["text"] for note in layout["annotations"]) for layout in (kept, *drawn)]
    assert said[0] == said[1], "the frame in the middle is the one that is kept"
    assert "Frame 5, " in said[2]
    assert shared_house.api.get(f"{address}?frame=6").json()["code"] == "results.not_yet"


def test_a_run_of_a_version_that_kept_no_example_says_so(
    shared_house: House, run: Json, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shared_house.app.state.kept, "get", Kept().get)
    address = f"runs/{run['id']}/figures/{WORKING_PANELS[0]}"
    made = select(Product).join(Shard, Shard.product_id == Product.id)
    with shared_house.context.sessions() as session:
        analysed = session.scalars(made.where(Shard.run_id == run["id"], Shard.task == "analyse")).one()
        whole = analysed.files
        analysed.files = [file for file in whole if file["name"] != EXAMPLE_FILE]
        session.commit()
        try:
            answer = shared_house.api.get(address)
            of_a_frame = shared_house.api.get(f"{address}?frame=3")
            listed = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/figures"))["items"]
        finally:
            analysed.files = whole
            session.commit()
    assert (answer.status_code, answer.json()["code"]) == (404, "results.not_kept")
    assert "Choose a frame" in answer.json()["hint"]
    assert of_a_frame.status_code == 200
    panel = next(entry for entry in listed if entry["name"] == WORKING_PANELS[0])
    assert panel["is_available"]
    assert [one["name"] for one in panel["parameters"] if one["is_required"]] == ["frame"]
