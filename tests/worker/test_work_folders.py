"""Folders of work in progress: handed on, spoiled by nobody, swept."""

from contextlib import suppress
from pathlib import Path
from uuid import UUID, uuid4

import pytest

from dropflow.errors import Cancelled
from tests.house import House
from worker.leases import Claim, LeaseLost
from worker.work_folders import sweep, work_folder


def _claim(fence: int, shard_id: UUID | None = None) -> Claim:
    return Claim(shard_id or uuid4(), uuid4(), uuid4(), "track", 0, 6, "key", fence, fence)


def test_a_later_holder_goes_on_where_the_earlier_was(tmp_path: Path) -> None:
    shard_id = uuid4()
    first = _break_off(tmp_path, _claim(1, shard_id))
    with work_folder(tmp_path, _claim(3, shard_id)) as second:
        assert (second / "state").read_text() == "half"
        assert not first.exists()
        with pytest.raises(FileNotFoundError):
            (first / "state").write_text("a ghost")
    assert list(tmp_path.iterdir()) == []


def _break_off(root: Path, claim: Claim) -> Path:
    """Half of the work, as a worker leaves it that is killed."""
    with suppress(LeaseLost), work_folder(root, claim) as folder:
        (folder / "state").write_text("half")
        raise LeaseLost
    return folder


def test_what_nobody_goes_on_with_is_removed(tmp_path: Path) -> None:
    with pytest.raises(Cancelled), work_folder(tmp_path, _claim(1)):
        raise Cancelled("stop")
    assert list(tmp_path.iterdir()) == []


def test_folders_of_work_that_is_over_are_swept_and_others_stay(house: House) -> None:
    house.start(house.ready())
    (waiting,) = house.waiting("prepare")
    root = house.context.settings.work_dir
    names = [f"{waiting}-1", f"{uuid4()}-1", "not-ours-1"]
    for name in names:
        (root / name).mkdir(parents=True)
    sweep(house.context)
    assert [name for name in names if (root / name).exists()] == [names[0]]
    (root / names[0]).rmdir()
