"""Results: the same as the command's, frame by frame, as figures and as files."""

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import polars as pl
import pyarrow.parquet as pq
import pytest
import yaml
import zarr
from sqlalchemy import select

from backend.models import Product, Shard
from backend.platform.kept import Kept
from dropflow import analysis
from dropflow.experiment import parse_experiment
from dropflow.figures.catalogue import CATALOGUE
from dropflow.figures.entry import Group
from dropflow.figures.example import EXAMPLE_FILE, WORKING_PANELS
from dropflow.parameters import parse_parameters
from tests.films import EXPERIMENT, PARAMETERS, film
from tests.house import House, Json
from worker.shards import look_at

ROOT = Path(__file__).parents[2]
QUERIES = {
    "flow_field": "?frame=2",
    "displacement": "?frame=2",
    "forward_tracking": "?frame=2&trajectory=0",
    "backward_tracking": "?frame=2&trajectory=0",
}
FIGURES = [entry.name + QUERIES.get(entry.name, "") for entry in CATALOGUE if entry.group is not Group.FLUID]
FIGURES = [name for name in FIGURES if name not in ("temperature", "driving")]
OF_SIZES = "figures/size_distribution_after"


@pytest.fixture(scope="module")
def run(shared_house: House) -> Json:
    run = shared_house.start(shared_house.ready())
    shared_house.work()
    return shared_house.again(run)


@pytest.fixture(scope="module")
def by_command(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `dropflow analyse` makes of the same film."""
    folder = tmp_path_factory.mktemp("command")
    (folder / "frames").mkdir()
    for file in film():
        (folder / file.name).write_bytes(file.content)
    found = analysis.open_film(
        folder / "frames", parse_experiment(EXPERIMENT), parse_parameters(PARAMETERS), beside=folder
    )
    analysis.analyse(found, folder / "results", n_processes=1)
    return folder / "results"


def _download(house: House, run: Json, name: str) -> bytes:
    answer = house.api.get(f"runs/{run['id']}/files/{name}")
    assert answer.status_code == 200, answer.text
    assert int(answer.headers["content-length"]) == len(answer.content)
    assert answer.headers["content-disposition"] == f'attachment; filename="{name}"'
    return answer.content


@pytest.mark.parametrize("name", ["droplets.parquet", "trajectories.parquet", "rejected_trajectories.parquet"])
def test_tables_are_those_of_the_command(shared_house: House, run: Json, by_command: Path, name: str) -> None:
    mine = pq.read_table(io.BytesIO(_download(shared_house, run, name)))
    theirs = pq.read_table(by_command / name)
    assert mine.schema == theirs.schema
    assert mine.equals(theirs)


def test_the_summary_is_that_of_the_command(shared_house: House, run: Json, by_command: Path) -> None:
    mine = json.loads(_download(shared_house, run, "summary.json"))
    theirs = json.loads((by_command / "summary.json").read_text())
    # The stack's checksum counts names as well, and uploads keep their folder's.
    for summary in (mine, theirs, run["summary"]):
        summary["provenance"].pop("input_sha256")
    assert mine == theirs == run["summary"]


def test_the_flow_field_is_that_of_the_command(
    shared_house: House, run: Json, by_command: Path, tmp_path: Path
) -> None:
    with zipfile.ZipFile(io.BytesIO(_download(shared_house, run, "flow.zarr.zip"))) as archive:
        assert archive.testzip() is None
        archive.extractall(tmp_path)
    mine, theirs = (
        zarr.open_group(tmp_path / "flow.zarr", mode="r"),
        zarr.open_group(by_command / "flow.zarr", mode="r"),
    )
    assert set(mine.array_keys()) == set(theirs.array_keys())
    for name in mine.array_keys():
        assert np.array_equal(np.asarray(mine[name]), np.asarray(theirs[name]), equal_nan=True)


def test_the_list_of_files_tells_their_true_sizes(shared_house: House, run: Json) -> None:
    items = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/files"))["items"]
    names = {item["name"] for item in items}
    assert names == {
        "droplets.parquet",
        "trajectories.parquet",
        "rejected_trajectories.parquet",
        "events.parquet",
        "flow.zarr.zip",
        "summary.json",
        "trajectory_summary.parquet",
        "coalescences.parquet",
        "statistics.npz",
        "example.npz",
        "report.html",
    }
    for item in items:
        assert len(_download(shared_house, run, item["name"])) == item["size_bytes"]


def test_droplets_of_a_frame_are_the_rows_of_the_tables(shared_house: House, run: Json, by_command: Path) -> None:
    rows = pq.read_table(by_command / "droplets.parquet", filters=[("frame", "=", 3)])
    shown = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/3/droplets"))
    assert shown["x_px"] == rows["x_px"].to_pylist()
    assert shown["match"] == rows["match"].to_pylist()
    assert shown["trajectory_id"] is None

    rows = pq.read_table(by_command / "trajectories.parquet", filters=[("frame", "=", 3)])
    tracked = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/3/droplets?which=tracked"))
    assert tracked["trajectory_id"] == rows["trajectory_id"].to_pylist()
    assert tracked["r_px"] == rows["r_px"].to_pylist()
    later = pq.read_table(by_command / "trajectories.parquet", filters=[("frame", "=", 4)])
    places = dict(zip(later["trajectory_id"].to_pylist(), later["x_px"].to_pylist(), strict=True))
    assert tracked["next_x_px"] == [places.get(found) for found in tracked["trajectory_id"]]
    assert any(place is not None for place in tracked["next_x_px"])


def test_in_the_last_frame_nothing_goes_on(shared_house: House, run: Json) -> None:
    tracked = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/5/droplets?which=tracked"))
    assert tracked["x_px"]
    assert set(tracked["next_x_px"]) == {None}


def test_the_flow_of_a_frame_is_the_entry_of_the_field(shared_house: House, run: Json, by_command: Path) -> None:
    shown = shared_house.ok(shared_house.api.get(f"runs/{run['id']}/frames/2/flow"))
    group = zarr.open_group(by_command / "flow.zarr", mode="r")
    assert np.array_equal(np.array(shown["u_um_s"]), np.asarray(group["velocity_um_s"])[2, 0])
    assert np.array_equal(np.array(shown["droplet_count"]), np.asarray(group["droplet_count"])[2])
    assert (len(shown["grid_x_px"]), len(shown["grid_y_px"])) == (5, 4)
    assert shared_house.api.get(f"runs/{run['id']}/frames/5/flow").status_code == 404


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


def test_the_report_is_among_the_files(shared_house: House, run: Json) -> None:
    page = _download(shared_house, run, "report.html").decode()
    assert page.startswith("<!doctype html>")
    assert page.count("<figure id=") == len(FIGURES)


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


@pytest.mark.parametrize(
    "path", ["figures/pie", "files/secrets.txt", "files/..%2f..%2fetc", "frames/6/droplets", "frames/99/flow"]
)
def test_what_is_not_there_is_not_found(shared_house: House, run: Json, path: str) -> None:
    answer = shared_house.api.get(f"runs/{run['id']}/{path}")
    assert answer.status_code in {404, 422}
    assert answer.headers["content-type"] == "application/problem+json"


def test_the_document_of_the_results_is_the_experiment_s(shared_house: House, run: Json) -> None:
    summary = json.loads(_download(shared_house, run, "summary.json"))
    said = summary["provenance"]["experiment"]
    assert said == parse_experiment(yaml.safe_load(yaml.safe_dump(EXPERIMENT))).model_dump(mode="json")
    assert summary["provenance"]["parameters"] == run["parameters"]


def test_results_appear_while_the_run_goes(house: House) -> None:
    run = house.start(house.ready())
    for name in FIGURES:
        answer = house.api.get(f"runs/{run['id']}/figures/{name}")
        assert (answer.status_code, answer.json()["code"]) == (404, "results.not_yet")
    assert house.ok(house.api.get(f"runs/{run['id']}/files"))["items"] == []
    look_at(house.context, house.waiting("prepare")[0])
    for shard_id in house.waiting("detect")[1:3]:
        look_at(house.context, shard_id)
    assert house.api.get(f"runs/{run['id']}/figures/size_distribution_before").status_code == 200
    assert house.api.get(f"runs/{run['id']}/figures/moments").status_code == 200
    listed = house.ok(house.api.get(f"runs/{run['id']}/figures"))["items"]
    there = [item["name"] for item in listed if item["is_available"]]
    assert there == ["size_distribution_before", "size_distribution_at", "moments"]
    assert house.api.get(f"runs/{run['id']}/figures/size_distribution_after").status_code == 404
    assert house.api.get(f"runs/{run['id']}/frames/1/droplets").status_code == 200
    assert house.api.get(f"runs/{run['id']}/frames/0/droplets").status_code == 404
    missing = house.api.get(f"runs/{run['id']}/files/trajectories.parquet")
    assert (missing.status_code, missing.json()["code"]) == (404, "results.not_yet")
