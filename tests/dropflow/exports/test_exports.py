"""Each export read back by the program it is made for, or by what that program uses."""

import json
from pathlib import Path
from xml.etree import ElementTree as ET

import h5py
import numpy as np
import pandas as pd
import polars as pl
import pyarrow.parquet as pq
import pytest
import trackpy
import xarray
import zarr

from dropflow.errors import ResultsError
from dropflow.exports.kinds import SUFFIX, Kind
from dropflow.exports.write import export
from dropflow.results import Results, open_results
from dropflow.tables import TRAJECTORIES


@pytest.fixture(scope="module")
def results(results_folder: Path) -> Results:
    return open_results(results_folder)


@pytest.fixture
def exported(request: pytest.FixtureRequest, results: Results, tmp_path: Path) -> Path:
    kind = Kind(request.param)
    output = tmp_path / f"out{SUFFIX[kind]}"
    export(results, kind, output)
    return output


def provenance_in(line: str) -> dict[str, object]:
    return json.loads(line.removeprefix("# dropflow: "))


@pytest.mark.parametrize("exported", ["csv"], indirect=True)
def test_csv_holds_every_row_and_its_provenance(exported: Path, results: Results) -> None:
    with exported.open() as file:
        assert provenance_in(file.readline())["input_sha256"] == "0" * 64
    table = pl.read_csv(exported, comment_prefix="#")
    original = pl.read_parquet(results.trajectories)
    assert table.columns == TRAJECTORIES.names
    np.testing.assert_allclose(table["r_um"].to_numpy(), original["r_um"].to_numpy())


@pytest.mark.parametrize("exported", ["parquet"], indirect=True)
def test_parquet_is_the_table_with_its_provenance(exported: Path, results: Results) -> None:
    table = pq.read_table(exported)
    assert table.equals(pq.read_table(results.trajectories))
    assert json.loads(table.schema.metadata[b"dropflow"]) == results.provenance


# trackpy 0.7 uses what pandas 3.1 deprecates.
@pytest.mark.filterwarnings("ignore:The inplace keyword")
@pytest.mark.parametrize("exported", ["trackpy"], indirect=True)
def test_trackpy_takes_its_table(exported: Path, results: Results, still_rows: int) -> None:
    table = pd.read_csv(exported, comment="#")
    assert {"frame", "particle", "x", "y", "size", "mass"} <= set(table.columns)
    assert len(table) == still_rows
    drift = trackpy.compute_drift(table)
    assert np.isfinite(drift.to_numpy()).all()


@pytest.mark.parametrize("exported", ["napari"], indirect=True)
def test_naparis_tracks_are_sorted_by_track_and_time(exported: Path) -> None:
    table = pl.read_csv(exported, comment_prefix="#")
    assert table.columns[:4] == ["track_id", "t", "y", "x"]
    assert table.equals(table.sort("track_id", "t"))


@pytest.mark.parametrize("exported", ["trackmate"], indirect=True)
def test_trackmate_xml_has_every_spot_once_and_edges_along_each_track(
    exported: Path, results: Results, still_rows: int
) -> None:
    root = ET.parse(exported).getroot()  # noqa: S314 - made by this test
    assert root.tag == "TrackMate"
    spots = {int(spot.get("ID")): spot for spot in root.iter("Spot")}
    assert len(spots) == still_rows == int(root.find(".//AllSpots").get("nspots"))
    assert json.loads(root.find("Log").text)["n_frames"] == results.n_frames
    original = pl.read_parquet(results.trajectories)
    tracks = root.findall(".//Track")
    assert len(tracks) == original["trajectory_id"].n_unique()
    for track in tracks[:20]:
        for edge in track:
            source, target = (spots[int(edge.get(f"SPOT_{end}_ID"))] for end in ("SOURCE", "TARGET"))
            assert int(target.get("FRAME")) == int(source.get("FRAME")) + 1
            x = original["x_um"][int(source.get("ID"))]
            assert float(source.get("POSITION_X")) == pytest.approx(x, abs=1e-5)
            assert original["trajectory_id"][int(target.get("ID"))] == int(track.get("TRACK_ID"))
    frames = [int(group.get("frame")) for group in root.iter("SpotsInFrame")]
    assert frames == sorted(set(frames))


@pytest.mark.parametrize("exported", ["hdf5"], indirect=True)
def test_hdf5_holds_tables_and_flow(exported: Path, results: Results) -> None:
    with h5py.File(exported) as file:
        original = pl.read_parquet(results.trajectories)
        for name in TRAJECTORIES.names:
            np.testing.assert_array_equal(file["trajectories"][name][:], original[name].to_numpy())
        flow = zarr.open_array(results.flow / "velocity_um_s", mode="r")
        np.testing.assert_array_equal(file["flow/velocity_um_s"][:], np.asarray(flow[:]))
        assert json.loads(file.attrs["dropflow"]) == results.provenance


@pytest.mark.parametrize("exported", ["netcdf"], indirect=True)
def test_netcdf_opens_in_xarray_with_coordinates_and_units(exported: Path, results: Results) -> None:
    with xarray.open_dataset(exported, engine="h5netcdf", decode_times=False) as flow:
        assert flow["velocity_um_s"].dims == ("time_s", "component", "row_y_px", "column_x_px")
        assert flow["velocity_um_s"].attrs["units"] == "um/s"
        assert flow.sizes["time_s"] == results.n_frames - 1
        assert json.loads(flow.attrs["dropflow"]) == results.provenance


@pytest.mark.parametrize("exported", ["zarr"], indirect=True)
def test_zarr_is_the_flow_field(exported: Path, results: Results) -> None:
    one, other = (zarr.open_array(path / "velocity_um_s", mode="r") for path in (exported, results.flow))
    np.testing.assert_array_equal(np.asarray(one[:]), np.asarray(other[:]))


@pytest.mark.parametrize("kind", list(Kind))
def test_results_without_trajectories_export_to_empty_files(kind: Kind, short_results: Path, tmp_path: Path) -> None:
    output = tmp_path / f"out{SUFFIX[kind]}"
    export(open_results(short_results), kind, output)
    assert output.exists()


def test_nothing_is_overwritten_and_nothing_half_written_stays(results: Results, tmp_path: Path) -> None:
    output = tmp_path / "out.csv"
    output.write_text("mine")
    with pytest.raises(ResultsError, match="already"):
        export(results, Kind.CSV, output)
    assert output.read_text() == "mine"
    (tmp_path / "file").write_text("")
    with pytest.raises(ResultsError):
        export(results, Kind.CSV, tmp_path / "file" / "out.csv")
    assert [path.name for path in tmp_path.glob("*.part")] == []
