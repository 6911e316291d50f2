"""Lists: filters, orders and pages, the same for every noun."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest

from tests.films import Upload, frame, png
from tests.house import House, Json


def _pages(house: House, path: str, **query: Any) -> list[Json]:
    """Every item, two a page."""
    seen: list[Json] = []
    cursor: dict[str, str] = {}
    while True:
        page = house.ok(house.api.get(path, params={"limit": 2, **query, **cursor}))
        seen += page["items"]
        if page["next_cursor"] is None:
            return seen
        assert len(page["items"]) == 2
        cursor = {"cursor": page["next_cursor"]}


def _names(items: list[Json]) -> list[str]:
    return [item["experiment"]["name"] for item in items]


@pytest.mark.parametrize(
    ("sort", "names"),
    [
        ("-created_at", ["Éclair", "alpha", "Beta", "alpha", "gamma"]),
        ("created_at", ["gamma", "alpha", "Beta", "alpha", "Éclair"]),
        ("name", ["alpha", "alpha", "Beta", "gamma", "Éclair"]),
        ("-name", ["Éclair", "gamma", "Beta", "alpha", "alpha"]),
        ("-updated_at", ["Beta", "Éclair", "alpha", "alpha", "gamma"]),
    ],
)
def test_experiments_can_be_sorted(house: House, sort: str, names: list[str]) -> None:
    made = [house.experiment(name=name) for name in ("gamma", "alpha", "Beta", "alpha", "Éclair")]
    house.ok(
        house.api.patch(f"experiments/{made[2]['id']}", json={"experiment": made[2]["experiment"] | {"notes": "x"}})
    )
    assert _names(_pages(house, "experiments", sort=sort)) == names


def test_experiments_can_be_filtered(house: House) -> None:
    house.experiment(name="Top phase, slow", tags=["series 1", "ramp"])
    house.experiment(name="Bottom phase", notes="100 % slow_motion", tags=["series 2"])
    third = house.experiment(name="水 droplets", tags=["series 1"])
    house.upload(third, Upload("a.png", png(frame(0))))
    found = {
        "": 3,
        "q=phase": 2,
        "q=SLOW%20phase": 2,
        "q=slow%20top": 1,
        "q=series%202": 1,
        "q=%25": 1,
        "q=_": 1,
        "q=水": 1,
        "q=nothing": 0,
        "tag=series%201": 2,
        "tag=series": 0,
        "stack_state=uploading": 1,
        "stack_state=empty": 2,
        "run_state=completed": 0,
        f"group_id={third['group']['id']}": 3,
        "group_id=00000000-0000-4000-8000-00000000dead": 0,
        "created_from=2100-01-01T00:00:00Z": 0,
        "created_before=2100-01-01T00:00:00Z": 3,
    }
    for query, n in found.items():
        assert len(house.ok(house.api.get(f"experiments?{query}"))["items"]) == n, query


def test_pages_neither_repeat_nor_leave_out_while_rows_come_and_go(house: House) -> None:
    made = [house.experiment(name=f"film {number}") for number in range(6)]
    first = house.ok(house.api.get("experiments", params={"limit": 2}))
    house.experiment(name="made meanwhile")
    assert house.api.delete(f"experiments/{made[4]['id']}").status_code == 204  # the last one of the first page
    rest = _names(house.ok(house.api.get("experiments", params={"cursor": first["next_cursor"]}))["items"])
    assert _names(first["items"]) + rest == [f"film {number}" for number in (5, 4, 3, 2, 1, 0)]


def test_runs_are_listed_of_one_experiment_and_of_all(house: House) -> None:
    one, two = house.ready(), house.ready(name="another")
    runs = [house.start(one), house.start(two), house.start(one)]
    house.ok(house.api.post(f"runs/{runs[0]['id']}/cancel"), 202)
    ids = [run["id"] for run in runs]
    assert [run["id"] for run in _pages(house, "runs")] == ids[::-1]
    assert [run["id"] for run in _pages(house, "runs", sort="created_at")] == ids
    assert [run["id"] for run in _pages(house, "runs", state="cancelled")] == ids[:1]
    assert [run["id"] for run in _pages(house, f"experiments/{one['id']}/runs")] == [ids[2], ids[0]]
    an_hour_ago = (datetime.now(UTC) - timedelta(hours=1)).isoformat()
    assert _pages(house, "runs", created_before=an_hour_ago) == []
    assert len(_pages(house, "runs", created_from=an_hour_ago)) == 3
    assert [item["id"] for item in _pages(house, "experiments", run_state="cancelled")] == [one["id"]]


def test_files_are_listed_by_name_or_size_and_by_role(house: House) -> None:
    experiment = house.experiment()
    small, large = png(frame(0, (20, 20))), png(frame(0))
    house.upload(experiment, Upload("b.png", small), Upload("a.png", large), Upload("c.png", large))
    house.upload(experiment, Upload("flat.png", small, "flat_field"))
    path = f"experiments/{experiment['id']}/files"

    def names(**query: Any) -> list[str]:
        return [item["name"] for item in _pages(house, path, **query)]

    assert names() == ["flat.png", "a.png", "b.png", "c.png"]
    assert names(sort="-name") == ["c.png", "b.png", "a.png", "flat.png"]
    assert names(sort="-size_bytes")[:2] == ["c.png", "a.png"]
    assert names(role="frames", q="B.") == ["b.png"]
    assert names(role="flat_field") == ["flat.png"]


@pytest.mark.parametrize(
    ("query", "field"),
    [
        ("sort=size", "sort"),
        ("stat=failed", "stat"),
        ("stack_state=gone", "stack_state"),
        ("q=%00", "q"),
        ("created_from=yesterday", "created_from"),
        ("created_from=0.5", "created_from"),
        ("created_from=1767225600", "created_from"),
        ("created_from=2026-01-01T00:00:00", "created_from"),
        ("limit=501", "limit"),
        ("cursor=WyItY3JlYXRlZF9hdCIsICJcdTAwMDAiLCAiIl0=", "cursor"),
        ("sort=name&cursor=WyJuYW1lIiwgIlx1MDAwMCIsICIwMDAwMDAwMC0wMDAwLTQwMDAtODAwMC0wMDAwMDAwMDAwMDIiXQ==", "cursor"),
    ],
)
def test_what_no_list_knows_is_refused_by_name(house: House, query: str, field: str) -> None:
    answer = house.api.get(f"experiments?{query}")
    assert answer.status_code == 422
    assert answer.json()["code"] == "request.invalid"
    assert [found["field"] for found in answer.json()["errors"]] == [field]


def test_a_cursor_of_another_order_is_refused(house: House) -> None:
    for number in range(3):
        house.experiment(name=f"film {number}")
    cursor = house.ok(house.api.get("experiments?limit=1"))["next_cursor"]
    answer = house.api.get("experiments", params={"cursor": cursor, "sort": "name"})
    assert answer.status_code == 422
    assert "-created_at" in answer.json()["errors"][0]["message"]
