"""Frames from a folder of the server or a prefix of S3: only from the list, by copy or by reference, nothing lost."""

import hashlib
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from uuid import UUID, uuid4

import httpx
import obstore
import pytest
from obstore.store import from_url
from sqlalchemy import select

from backend.models import File
from backend.platform.settings import Settings
from tests import s3
from tests.films import N_FRAMES, film, frame, tiff
from tests.house import House, Json, open_house
from worker import imports
from worker.context import Context
from worker.leases import Claim
from worker.shards import look_at


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A folder on the list, with a film in it and a secret beside it."""
    folder = tmp_path / "microscope"
    (folder / "day 1").mkdir(parents=True)
    for file in film():
        (folder / "day 1" / Path(file.name).name).write_bytes(file.content)
    (folder / "day 1" / "notes.txt").write_text("not a frame")
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "frame0.tif").write_bytes(tiff(frame(0)))
    return folder


@pytest.fixture
def importing(settings: Settings, root: Path) -> Iterator[House]:
    given = settings.model_dump() | {"import_roots": {"microscope": root.as_uri(), "others": {
        "url": root.as_uri(), "groups": ["Somebody else"]}}}  # fmt: skip
    with open_house(Settings.model_validate(given)) as house:
        yield house


def _ask(house: House, experiment: Json, **asked: Any) -> httpx.Response:
    return house.api.post(f"experiments/{experiment['id']}/imports", json={"root": "microscope", **asked})


def _imported(house: House, mode: str, path: str = "day 1") -> Json:
    experiment = house.experiment()
    begun = house.ok(_ask(house, experiment, path=path, mode=mode), 202)
    assert begun["stack"]["state"] == "indexing"
    assert begun["stack"]["importing"]["n_files"] == N_FRAMES
    house.work()
    return house.again(experiment)


@pytest.mark.parametrize("mode", ["copy", "reference"])
def test_a_folder_is_imported_indexed_and_analysed(importing: House, root: Path, mode: str) -> None:
    experiment = _imported(importing, mode)
    assert (experiment["stack"]["state"], experiment["stack"]["n_frames"]) == ("ready", N_FRAMES)
    assert experiment["stack"]["importing"] is None
    files = importing.ok(importing.api.get(f"experiments/{experiment['id']}/files"))["items"]
    assert {file["name"]: file["sha256"] for file in files} == {
        path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in (root / "day 1").glob("*.tif")
    }
    some = importing.api.get(f"experiments/{experiment['id']}/files/{files[0]['id']}")
    assert some.content == (root / "day 1" / files[0]["name"]).read_bytes()
    run = importing.start(experiment)
    importing.work()
    assert importing.again(run)["state"] == "completed"
    kept = [key for key in importing.kept_objects() if "/files/" in key]
    assert len(kept) == (1 if mode == "copy" else 0)
    assert len(list((root / "day 1").iterdir())) == N_FRAMES + 1


def test_one_file_of_many_frames_is_imported(importing: House, root: Path) -> None:
    (root / "film.tif").write_bytes(tiff(*(frame(index) for index in range(3))))
    experiment = importing.experiment()
    importing.ok(_ask(importing, experiment, path="film.tif", mode="reference"), 202)
    importing.work()
    assert importing.again(experiment)["stack"]["n_frames"] == 3


def test_a_folder_can_be_looked_into(importing: House) -> None:
    place = f"experiments/{importing.experiment()['id']}/imports"
    assert importing.ok(importing.api.get(place))["roots"] == ["microscope"]
    found = importing.ok(importing.api.get(place, params={"root": "microscope"}))
    assert (found["folders"], found["n_files"]) == (["day 1"], 0)
    found = importing.ok(importing.api.get(place, params={"root": "microscope", "path": "day 1"}))
    assert found["n_files"] == N_FRAMES + 1
    assert importing.api.get(place, params={"root": "others"}).json()["code"] == "not_found.import_root"


@pytest.mark.parametrize(
    "path",
    ["../secret", "day 1/../../secret", "/etc", "link", "link/frame0.tif", "day 1/link.tif", "pipe", "..", "a//b", "\0",
     "http://169.254.169.254/latest", "file:///etc/passwd", "nothing", "\\\\server\\share"],
)  # fmt: skip
def test_nothing_but_what_lies_below_the_root_can_be_reached(importing: House, root: Path, path: str) -> None:
    (root / "link").symlink_to(root.parent / "secret")
    (root / "day 1" / "link.tif").symlink_to(root.parent / "secret" / "frame0.tif")
    os.mkfifo(root / "pipe")
    for mode in ("copy", "reference"):
        answer = _ask(importing, importing.experiment(), path=path, mode=mode)
        assert answer.status_code == 422, answer.text
        assert str(root) not in answer.text
    place = f"experiments/{importing.experiment()['id']}/imports"
    assert importing.api.get(place, params={"root": "microscope", "path": path}).status_code == 422


@pytest.mark.parametrize("name", ["others", "file:///etc", "http://169.254.169.254", "s3://bucket", ""])
def test_no_root_but_those_of_the_list_can_be_named(importing: House, name: str) -> None:
    answer = _ask(importing, importing.experiment(), root=name)
    assert (answer.status_code, answer.json()["code"]) == (404, "not_found.import_root")


def test_a_link_that_appears_after_the_check_is_not_followed(importing: House, root: Path) -> None:
    experiment = importing.experiment()
    importing.ok(_ask(importing, experiment, path="day 1"), 202)
    (root / "day 1").rename(root / "moved")
    (root / "day 1").symlink_to(root.parent / "secret")
    importing.work()
    stack = importing.again(experiment)["stack"]
    assert (stack["state"], stack["problem"]["code"]) == ("rejected", "frames.not_found")


def test_a_referenced_file_that_is_changed_or_gone_is_a_clear_error(importing: House, root: Path) -> None:
    experiment = _imported(importing, "reference")
    victim = root / "day 1" / "frame3.tif"
    content, about = victim.read_bytes(), victim.stat()
    expectations = {"frames.changed": lambda: victim.write_bytes(tiff(frame(50))), "frames.vanished": victim.unlink}
    for code, harm in expectations.items():
        harm()
        run = importing.start(experiment)
        importing.work()
        failed = importing.again(run)
        assert (failed["state"], failed["problem"]["code"]) == ("failed", code)
        assert failed["problem"]["file"] == "day 1/frame3.tif"
        picture = importing.api.get(f"experiments/{experiment['id']}/frames/3.jpg")
        assert (picture.status_code, picture.json()["code"]) == (422, code)
    victim.write_bytes(content)  # at another time, but the same as it was
    assert victim.stat().st_mtime_ns != about.st_mtime_ns
    run = importing.ok(importing.api.post(f"runs/{run['id']}/retry"), 202)
    importing.work()
    assert importing.again(run)["state"] == "completed"


def test_what_is_removed_here_stays_where_it_was_imported_from(importing: House, root: Path) -> None:
    experiment = _imported(importing, "reference")
    importing.ok(importing.api.delete(f"experiments/{experiment['id']}/stack"))
    assert importing.kept_objects() == []
    assert len(list((root / "day 1").glob("*.tif"))) == N_FRAMES


def test_an_import_whose_worker_dies_goes_on_where_it_was(
    importing: House, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(imports, "BUNDLE_FILES", 2)
    experiment = importing.experiment()
    importing.ok(_ask(importing, experiment, path="day 1"), 202)
    record, n_recorded = imports._record, 0

    def dies_in_the_second(context: Context, claim: Claim, rows: Sequence[File]) -> None:
        nonlocal n_recorded
        n_recorded += 1
        if n_recorded == 2:
            raise OSError("killed")
        record(context, claim, rows)

    (shard_id,) = importing.waiting()
    with monkeypatch.context() as broken:
        broken.setattr(imports, "_record", dies_in_the_second)
        look_at(importing.context, shard_id)
    before = _rows(importing, experiment)
    assert len(before) == 2
    importing.work()
    assert importing.again(experiment)["stack"]["state"] == "ready"
    after = _rows(importing, experiment)
    assert before.items() <= after.items()
    assert len(after) == N_FRAMES


def _rows(house: House, experiment: Json) -> dict[str, UUID]:
    with house.context.sessions() as session:
        found = session.scalars(select(File).where(File.experiment_id == UUID(experiment["id"])))
        return {file.name: file.id for file in found}


def test_an_import_is_given_up_when_the_stack_is_removed(importing: House) -> None:
    experiment = importing.experiment()
    importing.ok(_ask(importing, experiment, path="day 1"), 202)
    importing.ok(importing.api.delete(f"experiments/{experiment['id']}/stack"))
    importing.work()
    assert importing.again(experiment)["stack"]["state"] == "empty"
    assert importing.kept_objects() == []


def test_frames_are_not_imported_beside_others(importing: House) -> None:
    experiment = importing.experiment()
    importing.upload(experiment, film()[0])
    assert _ask(importing, experiment, path="day 1").json()["code"] == "conflict.frames_there"


def test_files_that_the_description_names_come_with_the_frames(importing: House, root: Path) -> None:
    times = "".join(f"{index},{index * 2}\n" for index in range(N_FRAMES))
    (root / "day 1" / "times.csv").write_text("frame,time_s\n" + times)
    experiment = importing.experiment(timestamps="times.csv", frame_interval_s=None)
    importing.ok(_ask(importing, experiment, path="day 1", mode="reference"), 202)
    importing.work()
    stack = importing.again(experiment)["stack"]
    assert (stack["state"], stack["duration_s"]) == ("ready", 2.0 * (N_FRAMES - 1)), stack["problem"]
    other = importing.experiment(flat_field="flat.tif")
    refused = _ask(importing, other, path="day 1")
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "flat_field")


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["copy", "reference"])
def test_a_prefix_of_s3_is_imported_also_from_a_store_that_fails_every_tenth_time(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, mode: str
) -> None:
    with s3.running_s3() as port, s3.failing_way(port) as way:
        s3.use(monkeypatch, way)
        url = f"s3://{s3.BUCKET}/{uuid4()}"
        store = from_url(url)
        for file in film():
            obstore.put(store, f"day 1/{Path(file.name).name}", file.content)
        obstore.put(from_url(f"s3://{s3.BUCKET}"), "secret/frame0.tif", tiff(frame(0)))
        given = settings.model_dump() | {"import_roots": {"microscope": url}}
        with open_house(Settings.model_validate(given)) as house:
            place = f"experiments/{house.experiment()['id']}/imports"
            assert house.ok(house.api.get(place, params={"root": "microscope"}))["folders"] == ["day 1"]
            experiment = _imported(house, mode)
            assert experiment["stack"]["state"] == "ready", experiment["stack"]["problem"]
            for path in ("../secret", "secret", "day 1/../../secret"):
                assert _ask(house, house.experiment(), path=path).status_code == 422
            obstore.put(store, "day 1/frame2.tif", tiff(frame(77)))
            run = house.start(experiment)
            house.work()
            if mode == "copy":
                assert house.again(run)["state"] == "completed"
            else:
                assert house.again(run)["problem"]["code"] == "frames.changed"
