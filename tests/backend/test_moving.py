"""An experiment goes from one group to another: with rights in both, room there, and a line in the log."""

from uuid import UUID, uuid4

import pytest

from backend.models import Right
from tests.films import EXPERIMENT
from tests.lab import Lab


@pytest.fixture
def groups(lab: Lab) -> tuple[UUID, UUID]:
    return lab.group("Foams"), lab.group("Drops")


def test_who_edits_in_both_moves_an_experiment_with_its_runs(lab: Lab, groups: tuple[UUID, UUID]) -> None:
    before, after = groups
    experiment, run = lab.finished(before)
    ada = lab.browser(lab.person("Ada", {before: Right.EDIT, after: Right.EDIT}))
    there = lab.browser(lab.person("Grace", {after: Right.VIEW}))
    here = lab.browser(lab.person("Edith", {before: Right.VIEW}))
    assert there.get(f"runs/{run}").status_code == 404
    moved = ada.put(f"experiments/{experiment}/group", json={"group_id": str(after)})
    assert (moved.status_code, moved.json()["group"]["name"]) == (200, "Drops")
    assert there.get(f"runs/{run}").status_code == 200
    assert here.get(f"runs/{run}").status_code == 404
    assert here.get(f"experiments/{experiment}").status_code == 404
    log = lab.browser(lab.administrator).get("administration/audit", params={"action": "experiments_move"}).json()
    about = log["items"][0]["about"]
    assert (about["from_group"], about["to_group"]) == ("Foams", "Drops")


@pytest.mark.parametrize(
    ("here", "there", "expected"),
    [
        (Right.VIEW, Right.EDIT, (403, "forbidden.edit")),
        (Right.EDIT, Right.VIEW, (403, "forbidden.edit")),
        (Right.EDIT, None, (404, "not_found.group")),
        (None, Right.EDIT, (404, "not_found.experiment")),
    ],
)
def test_who_lacks_the_right_in_one_of_both_moves_nothing(
    lab: Lab, groups: tuple[UUID, UUID], here: Right | None, there: Right | None, expected: tuple[int, str]
) -> None:
    experiment, _ = lab.finished(groups[0])
    rights = {group: right for group, right in zip(groups, (here, there), strict=True) if right is not None}
    answer = lab.browser(lab.person("Ada", rights)).put(
        f"experiments/{experiment}/group", json={"group_id": str(groups[1])}
    )
    assert (answer.status_code, answer.json()["code"]) == expected


def test_what_does_not_fit_is_not_moved(lab: Lab, groups: tuple[UUID, UUID]) -> None:
    before, after = groups
    ada = lab.as_(lab.person("Ada", dict.fromkeys(groups, Right.EDIT)))
    made = ada.api.post("experiments", json={"experiment": EXPERIMENT, "group_id": str(before)}).json()
    ada.api.put(f"experiments/{made['id']}/files", params={"name": "a.tif"}, content=b"II*\0" + bytes(600))
    limits = {"max_bytes": 100, "max_active_runs": None}
    lab.browser(lab.administrator).put(f"groups/{after}/limits", json=limits)
    answer = ada.api.put(f"experiments/{made['id']}/group", json={"group_id": str(after)})
    assert (answer.status_code, answer.json()["code"]) == (413, "quota.bytes")
    assert ada.api.put(f"experiments/{made['id']}/group", json={"group_id": str(uuid4())}).status_code == 404
