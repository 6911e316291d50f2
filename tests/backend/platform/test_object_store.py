"""One contract for every kind of object store: a folder, a real S3 server, and one that fails every tenth request."""

import os
from collections.abc import AsyncIterator, Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from uuid import uuid4

import pytest

from backend.platform.object_store import ObjectStore, upload_key
from backend.platform.places import INDEX_NAME, Place, write_index
from tests import s3

CONTENT = os.urandom(3_000_000)


@pytest.fixture(scope="module")
def s3_port() -> Iterator[int]:
    with s3.running_s3() as port:
        yield port


@pytest.fixture(params=["folder", "s3", "failing s3"])
def store(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ObjectStore]:
    if request.param == "folder":
        yield ObjectStore((tmp_path / "objects").as_uri())
        return
    port = request.getfixturevalue("s3_port")
    if request.param == "s3":
        s3.use(monkeypatch, port)
        yield ObjectStore(f"s3://{s3.BUCKET}/{uuid4()}")
        return
    with s3.failing_way(port) as failing:
        s3.use(monkeypatch, failing)
        yield ObjectStore(f"s3://{s3.BUCKET}/{uuid4()}")


def test_what_was_put_is_read_listed_and_removed(store: ObjectStore) -> None:
    keys = [f"experiments/x/{number}/object" for number in range(25)]
    for number, key in enumerate(keys):
        store.put(key, CONTENT[: number * 1000])
    assert store.list("experiments/x/") == sorted((key, number * 1000) for number, key in enumerate(keys))
    for number, key in enumerate(keys):
        assert store.read(key) == CONTENT[: number * 1000]
    store.remove(keys[0])
    store.remove(keys[0])
    store.remove("experiments/x/1/")
    assert [key for key, _ in store.list("experiments/x/")] == sorted(keys[2:])
    store.remove("experiments/x/")
    assert store.list("experiments/") == []


async def _chunks() -> AsyncIterator[bytes]:
    for start in range(0, len(CONTENT), 100_000):
        yield CONTENT[start : start + 100_000]


def test_a_stream_arrives_whole(store: ObjectStore) -> None:
    import asyncio

    asyncio.run(store.put_stream("experiments/streamed", _chunks()))
    assert b"".join(store.stream("experiments/streamed")) == CONTENT


def test_any_range_can_be_read_without_the_rest(store: ObjectStore) -> None:
    store.put("experiments/x/object", CONTENT)
    with store.open("experiments/x/object") as file:
        for start, n in ((0, 10), (1_048_570, 20), (2_999_990, 100), (5, 2_000_000), (3_000_000, 5)):
            assert file.seek(start) == start
            assert file.read(n) == CONTENT[start : start + n]
        assert file.seek(-7, os.SEEK_END) == len(CONTENT) - 7
        assert file.read() == CONTENT[-7:]


def test_a_stretch_of_an_object_is_a_file_of_its_own(store: ObjectStore) -> None:
    store.put("experiments/x/object", CONTENT)
    with store.open_place(Place("experiments/x/object", 1000, 1_500_000)) as file:
        assert file.read(3) == CONTENT[1000:1003]
        assert file.read() == CONTENT[1003:1_501_000]
        assert file.read(1) == b""
        assert file.seek(0, os.SEEK_END) == 1_500_000


def test_an_object_grows_and_only_what_was_saved_counts(store: ObjectStore) -> None:
    key = upload_key(uuid4(), uuid4(), can_grow=store.can_grow)
    pieces, at = [], 0
    for fence, stop in enumerate((10, 700_000, 700_001, 2_500_000, len(CONTENT))):
        growing = store.grow(key, at_byte=at, fence=fence)
        growing.write(CONTENT[at:stop])
        pieces += growing.sync()
        growing.write(b"these bytes are never saved")
        growing.close()
        at = stop
    last = store.grow(key, at_byte=at, fence=9)
    pieces += last.sync()
    last.close()
    if not store.can_grow:
        store.put(key + INDEX_NAME, write_index(pieces))
    for start, size in ((0, len(CONTENT)), (699_990, 20), (5, 2_400_000)):
        with store.open_place(Place(key, start, size)) as file:
            assert file.read() == CONTENT[start : start + size]


def test_only_what_is_old_counts_as_old(store: ObjectStore) -> None:
    store.put("experiments/x/object", b"1")
    now = datetime.now(UTC)
    assert list(store.older_than("experiments/", now - timedelta(hours=1))) == []
    assert list(store.older_than("experiments/", now + timedelta(hours=1))) == ["experiments/x/object"]
