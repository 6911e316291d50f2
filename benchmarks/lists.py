"""Lists of experiments: a service that holds 10,000 beside one that holds 100."""

import statistics
import tempfile
import time
from pathlib import Path
from uuid import uuid4

import httpx
from sqlalchemy import insert

from backend.models import Experiment, Run, Stack
from backend.models.states import RunState, StackState
from backend.people.service import LOCAL_GROUP_ID
from tests.films import EXPERIMENT
from tests.house import House, house_settings, open_house
from tests.services import migrate, running_postgres, running_valkey

SMALL, LARGE, N_RUNS, N_TIMES = 100, 10_000, 2, 30
ASKED = {
    "newest": {},
    "by name": {"sort": "name"},
    "last changed": {"sort": "-updated_at"},
    "two words": {"q": "film 77"},
    "a tag": {"tag": "series 7"},
    "runs of all": {},
}


def main() -> None:
    """Print the median time of each list, and what a hundred times as many experiments make of it."""
    medians = {n: _measured(n) for n in (SMALL, LARGE)}
    print(f"{'list':<14}{SMALL:>10,}{LARGE:>10,}    ratio   (ms, median of {N_TIMES}, 50 a page)")
    for name in ASKED:
        small, large = medians[SMALL][name], medians[LARGE][name]
        print(f"{name:<14}{small:>10.1f}{large:>10.1f}    {large / small:.1f}")


def _measured(n_experiments: int) -> dict[str, float]:
    with running_postgres() as postgres, running_valkey() as valkey, tempfile.TemporaryDirectory() as folder:
        postgres.create_database("lists")
        migrate(postgres.url("lists"))
        with open_house(house_settings(postgres.url("lists"), valkey.url(0), Path(folder))) as house:
            _fill(house, n_experiments)
            return {
                name: _median_ms(house.api, "runs" if name == "runs of all" else "experiments", query)
                for name, query in ASKED.items()
            }


def _fill(house: House, n_experiments: int) -> None:
    ids = [uuid4() for _ in range(n_experiments)]
    with house.context.sessions.begin() as session:
        session.execute(
            insert(Experiment),
            [
                {
                    "id": made,
                    "group_id": LOCAL_GROUP_ID,
                    "document": EXPERIMENT
                    | {"name": f"film {index}", "notes": "words " * 40, "tags": [f"series {index % 50}"]},
                }
                for index, made in enumerate(ids)
            ],
        )
        session.execute(
            insert(Stack), [{"experiment_id": made, "state": StackState.READY, "warnings": []} for made in ids]
        )
        session.execute(
            insert(Run),
            [
                {
                    "id": uuid4(),
                    "experiment_id": made,
                    "number": number,
                    "state": RunState.COMPLETED,
                    "parameters": {},
                    "document": EXPERIMENT,
                    "version": "0",
                    "warnings": [],
                }
                for made in ids
                for number in range(1, N_RUNS + 1)
            ],
        )


def _median_ms(api: httpx.Client, path: str, query: dict[str, str]) -> float:
    times_ms = []
    for _ in range(N_TIMES):
        began = time.perf_counter()
        api.get(path, params=query).raise_for_status()
        times_ms.append((time.perf_counter() - began) * 1e3)
    return statistics.median(times_ms)


if __name__ == "__main__":
    main()
