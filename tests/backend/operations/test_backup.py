"""A backup is made, everything is destroyed, and the restored service shows what was there."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Engine, create_engine, text

from backend.operations.backup import CONFIGURATION, OBJECTS, back_up, moments_of
from backend.operations.errors import OperationError
from backend.operations.restore import restore
from backend.platform.object_store import ObjectStore
from deploy.local.postgres import Postgres
from tests.house import House, house_settings, open_house
from tests.services import database
from worker.reconcile import remove_doomed

Json = dict[str, Any]


@pytest.fixture
def completed(house: House) -> Json:
    run = house.start(house.ready())
    house.work()
    return house.again(run)


@pytest.fixture
def backed_up(house: House, tmp_path: Path) -> Callable[[], Path]:
    def make(**options: Any) -> Path:
        settings = house.context.settings
        store = ObjectStore(settings.object_store_url)
        return back_up(house.context.engine, store, tmp_path / "backup", report=print, **options)

    return make


def results_of(house: House, run: Json) -> dict[str, str]:
    listed = house.ok(house.api.get(f"runs/{run['id']}/files"))["items"]
    names = [file["name"] for file in listed if file["media_type"] != "application/zip"]
    assert names
    return {name: hashlib.sha256(house.api.get(f"runs/{run['id']}/files/{name}").content).hexdigest() for name in names}


def test_what_was_destroyed_is_brought_back(
    completed: Json,
    house: House,
    backed_up: Callable[..., Path],
    tmp_path: Path,
    postgres_server: Postgres,
    redis_url: str,
) -> None:
    secret = tmp_path / "secret.env"
    secret.write_text("PASSWORD=correct horse")
    before = results_of(house, completed)
    moment = backed_up(configuration=[secret])
    assert (moment / CONFIGURATION / "secret.env").read_text() == "PASSWORD=correct horse"
    with database(postgres_server, template="template0") as url:
        settings = house_settings(url, redis_url, tmp_path / "again")
        engine = create_engine(settings.database_url)
        restore(engine, ObjectStore(settings.object_store_url), tmp_path / "backup", report=print)
        engine.dispose()
        with open_house(settings) as restored:
            assert restored.again(completed) == completed
            assert results_of(restored, completed) == before
            following = restored.start(restored.ok(restored.api.get(f"experiments/{completed['experiment_id']}")))
            restored.work()
            assert restored.again(following)["state"] == "completed"


def test_a_second_backup_copies_only_what_is_new(
    completed: Json, house: House, backed_up: Callable[..., Path], capsys: pytest.CaptureFixture[str]
) -> None:
    backed_up()
    capsys.readouterr()
    backed_up()
    assert ", 0 of them new" in capsys.readouterr().out


def test_what_only_old_backups_had_goes_with_them(
    completed: Json, house: House, backed_up: Callable[..., Path], tmp_path: Path
) -> None:
    first = backed_up()
    house.api.delete(f"experiments/{completed['experiment_id']}", params={"forever": True}).raise_for_status()
    remove_doomed(house.context)
    first.rename(first.with_name("20200101T000000.000000Z"))
    backed_up(n_kept=1)
    assert len(moments_of(tmp_path / "backup")) == 1
    assert [path for path in (tmp_path / "backup" / OBJECTS).rglob("*") if path.is_file()] == []


def test_nothing_is_removed_from_the_store_while_a_backup_copies(
    completed: Json, house: House, backed_up: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = ObjectStore.open
    n_opened = 0

    def deleting(store: ObjectStore, key: str) -> Any:
        nonlocal n_opened
        if not n_opened:
            house.api.delete(f"experiments/{completed['experiment_id']}", params={"forever": True}).raise_for_status()
            remove_doomed(house.context)
        n_opened += 1
        return copy(store, key)

    n_objects = len(ObjectStore(house.context.settings.object_store_url).list(""))
    monkeypatch.setattr(ObjectStore, "open", deleting)
    moment = backed_up()
    assert n_opened == n_objects
    monkeypatch.undo()
    assert (moment / "database" / "run.copy").read_text().count("\n") == 2
    assert house.kept_objects() == []


def test_a_damaged_backup_is_refused_before_anything_is_written(
    completed: Json, house: House, backed_up: Callable[..., Path], tmp_path: Path, empty_engine: Engine
) -> None:
    moment = backed_up()
    for file in (moment / "database" / "run.copy", next((tmp_path / "backup" / OBJECTS).rglob("*.parquet"))):
        whole = file.read_bytes()
        file.write_bytes(whole[:-1])
        with pytest.raises(OperationError, match=file.name):
            restore(empty_engine, ObjectStore((tmp_path / "no").as_uri()), tmp_path / "backup", report=print)
        file.write_bytes(whole)
    with empty_engine.connect() as connection:
        assert connection.execute(text("SELECT count(*) FROM pg_tables WHERE schemaname = 'public'")).scalar() == 0


def test_a_database_with_experiments_is_never_overwritten(
    completed: Json, house: House, backed_up: Callable[..., Path], tmp_path: Path
) -> None:
    backed_up()
    store = ObjectStore((tmp_path / "no").as_uri())
    with pytest.raises(OperationError, match="Restore into an empty one"):
        restore(house.context.engine, store, tmp_path / "backup", report=print)


@pytest.fixture
def empty_engine(empty_database_url: str) -> Any:
    from backend.platform.settings import with_driver

    engine = create_engine(with_driver(empty_database_url))
    yield engine
    engine.dispose()
