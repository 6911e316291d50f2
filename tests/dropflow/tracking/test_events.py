from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from dropflow.droplets import Droplets
from dropflow.physics.material import resolve
from dropflow.tracking.events import EVENTS, Surroundings, events_of_steps
from dropflow.tracking.grid import Grid
from dropflow.tracking.prediction import Motion
from dropflow.tracking.sightings import Sightings
from tests.dropflow.tracking.generated import Film, droplets_at, experiment, film, vortices
from tests.dropflow.tracking.tracked import tracked

SHAPE = (400, 500)
N_FRAMES = 12
UNITED = 6
"""The first frame in which two are one."""


def paths(*, r_1: float, r_2: float, r_after: float, is_new: bool = True) -> Film:
    """Two droplets that drift towards each other and become one, among others that drift along."""
    rng = np.random.default_rng(3)
    others = np.column_stack([rng.uniform(20, 480, 30), rng.uniform(250, 380, 30), rng.uniform(4, 8, 30)])
    frames = []
    for frame in range(N_FRAMES):
        away = max(UNITED - frame, 0) * 0.3
        gap = 0.8 * (r_1 + r_2)
        drift = np.array([3.0 * frame, 0.0, 0.0])
        if frame < UNITED:
            pair = [[200 - gap / 2 - away, 100, r_1], [200 + gap / 2 + away, 100, r_2]]
        else:
            share = r_2**3 / (r_1**3 + r_2**3)
            pair = [[200 + gap * (share - 0.5), 100, r_after]]
        frames.append(droplets_at(np.concatenate([pair, others]) + drift))
    return still(frames)


def still(frames: list[Droplets]) -> Film:
    """A film of droplets that do not sediment."""
    known = [np.full(len(droplets), -1) for droplets in frames]
    return Film(experiment(0.0), SHAPE, np.arange(float(len(frames))), frames, known)


def events(given: Film, folder: Path) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = pq.read_table(tracked(given, folder).events).to_pylist()
    return rows


def test_two_that_become_one_are_an_event_with_their_volumes(tmp_path: Path) -> None:
    """Equal droplets: both trajectories end, or one goes on; the radii are those before and after."""
    rows = events(paths(r_1=12, r_2=12, r_after=12 * 2 ** (1 / 3)), tmp_path)
    (event,) = (row for row in rows if row["kind"] == "coalescence")
    assert event["frame"] == UNITED
    assert event["cause"] == "coalescence"
    assert event["trajectory_id"] != event["other_id"]
    size = 12 * experiment(0.0).pixel_size_um
    assert (event["r_1_um"], event["r_2_um"]) == pytest.approx((size, size))
    assert event["r_um"] == pytest.approx(size * 2 ** (1 / 3))
    assert abs(float(str(event["volume_residual"]))) < 0.5
    ended = {row["trajectory_id"] for row in rows if row["kind"] == "exit"}
    assert not ended & {event["trajectory_id"], event["other_id"]}


def test_a_droplet_that_takes_another_up_must_have_grown_by_it(tmp_path: Path) -> None:
    """A smaller one that ends beside it was absorbed only if the volume is there."""
    grown = events(paths(r_1=14, r_2=11, r_after=(14**3 + 11**3) ** (1 / 3)), tmp_path / "grown")
    assert [row["frame"] for row in grown if row["kind"] == "coalescence"] == [UNITED]
    same = events(paths(r_1=14, r_2=8, r_after=14), tmp_path / "same")
    assert not [row for row in same if row["kind"] == "coalescence"]


def test_a_coalescence_is_seen_whatever_the_material_is_said_to_be(tmp_path: Path) -> None:
    """Droplets go on as they went, not as Stokes says: here he says that these move by twice their radius in a step."""
    given = paths(r_1=12, r_2=12, r_after=12 * 2 ** (1 / 3))
    mistaken = replace(given, experiment=experiment(-140.0))
    motion = Motion.of(mistaken.experiment, resolve(mistaken.experiment))
    assert np.hypot(*motion.sinking_px(np.array([12.0]), 1.0)) > 24
    rows = events(mistaken, tmp_path)
    assert [row["frame"] for row in rows if row["kind"] == "coalescence"] == [UNITED]


def test_volumes_that_do_not_add_up_are_no_event(tmp_path: Path) -> None:
    rows = events(paths(r_1=12, r_2=12, r_after=9), tmp_path)
    assert not [row for row in rows if row["kind"] == "coalescence"]


def test_droplets_that_drift_over_the_border_leave_for_that_reason(tmp_path: Path) -> None:
    """And those that come in are born there; what vanishes inside went out of focus."""
    rng = np.random.default_rng(1)
    x, y, r = rng.uniform(-400, 480, 60), rng.uniform(20, 380, 60), rng.uniform(4, 8, 60)
    frames = []
    for frame in range(N_FRAMES):
        now = x + 30.0 * frame
        is_seen = (now > r / 2) & (now < 500 - r / 2)
        is_seen[0] = False
        lost = np.array([[150 + 30.0 * frame, 200.0, 12.0]] if frame < 5 else np.empty((0, 3)))
        frames.append(droplets_at(np.concatenate([np.column_stack([now, y, r])[is_seen], lost])))
    rows = events(still(frames), tmp_path)
    causes = Counter((row["kind"], row["cause"]) for row in rows)
    assert set(causes) == {("birth", "border"), ("exit", "border"), ("exit", "focus")}
    (lost_row,) = (row for row in rows if row["cause"] == "focus")
    assert (lost_row["frame"], lost_row["x_px"], lost_row["r_px"]) == (5, 270.0, 12.0)
    assert all(float(str(row["x_px"])) > 450 for row in rows if row["kind"] == "exit" and row["cause"] == "border")


def test_each_beginning_and_each_end_inside_the_film_is_one_event(tmp_path: Path) -> None:
    """Also across the parts in which a film is worked on; the table keeps its contract."""
    given = film(flow=vortices(8, 250), n_frames=70, n_droplets=40, found_share=0.95, seed=5)
    result = tracked(given, tmp_path, made_by="a test")
    table, rows = pq.read_table(result.trajectories), pq.read_table(result.events)
    assert rows.schema.remove_metadata() == EVENTS
    assert b"a test" in rows.schema.metadata[b"dropflow"]
    assert rows["frame"].to_pylist() == sorted(rows["frame"].to_pylist())
    ids, frames = table["trajectory_id"].to_numpy(), table["frame"].to_numpy()
    first, last = np.flatnonzero(np.diff(ids, prepend=-1)), np.flatnonzero(np.diff(ids, append=-1))
    begun = {(int(ids[k]), int(frames[k])) for k in first if frames[k] > 0}
    ended = {(int(ids[k]), int(frames[k]) + 1) for k in last if frames[k] < 69}
    births, exits = set(), set()
    for row in rows.to_pylist():
        if row["kind"] == "birth":
            births.add((row["trajectory_id"], row["frame"]))
        elif row["kind"] == "exit":
            exits.add((row["trajectory_id"], row["frame"]))
        else:
            if row["product_id"] != row["trajectory_id"]:
                births.add((row["product_id"], row["frame"]))
                exits.add((row["trajectory_id"], row["frame"]))
            exits.add((row["other_id"], row["frame"]))
    assert births == begun
    assert exits == ended


def test_a_single_frame_has_no_events(tmp_path: Path) -> None:
    given = film(flow=vortices(8, 300), n_frames=1)
    assert pq.read_table(tracked(replace(given), tmp_path).events).num_rows == 0


def test_steps_together_have_the_events_of_each_alone() -> None:
    """Droplets of one frame have nothing to do with those of others, be they in the same place."""
    rng, n_frames, n_trajectories = np.random.default_rng(4), 8, 200
    first = rng.integers(0, n_frames, n_trajectories)
    n_rows = np.minimum(rng.integers(1, n_frames, n_trajectories), n_frames - first)
    ids = np.repeat(np.arange(n_trajectories), n_rows)
    frame = np.concatenate([np.arange(start, start + n) for start, n in zip(first, n_rows, strict=True)])
    places = rng.uniform(0, 300, (n_trajectories, 2))[ids] + rng.normal(0, 1, (len(ids), 2))
    r_px, r_std_px = rng.uniform(5, 15, len(ids)), np.full(len(ids), 0.5)
    seen = Sightings(ids, frame, *places.T, r_px, r_std_px, *rng.normal(0, 2, (3, len(ids))))
    about, flow_um_s, shifts_px = experiment(), rng.normal(0, 3, (n_frames - 1, 2, 8, 10)), np.zeros((n_frames - 1, 2))
    shifts_px[3] = 5.0, -2.0
    around = Surroundings(Grid(*SHAPE, 8, 10), Motion.of(about, resolve(about)))

    def events_of(steps: range) -> pa.Table:
        flows = flow_um_s[steps.start : steps.stop]
        return events_of_steps(seen, steps, np.arange(float(n_frames)), flows, shifts_px, around)

    together = events_of(range(n_frames - 1))
    assert set(together["kind"].to_pylist()) == {"birth", "coalescence", "exit", "shift"}
    assert together.equals(pa.concat_tables([events_of(range(step, step + 1)) for step in range(n_frames - 1)]))
