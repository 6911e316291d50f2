import numpy as np

from dropflow.droplets import Droplets
from dropflow.tracking.filtering import Trails, reasons
from dropflow.tracking.front import Front
from tests.dropflow.tracking.generated import droplets_at


def front(ids: list[int], droplets: Droplets) -> Front:
    return Front.of(np.array(ids), droplets, is_detected=True)


def walk_back(paths: dict[int, list[tuple[int, float, float]]], step_px: tuple[float, float]) -> Trails:
    """Trails of paths given as (frame, x, y); the prediction is the same step for all, each time."""
    n_frames = 1 + max(frame for path in paths.values() for frame, _, _ in path)
    trails = Trails.begin(Front.empty(), n_frames)
    complete = []
    for frame in reversed(range(n_frames)):
        here = {key: (x, y, 5.0) for key, path in paths.items() for at, x, y in path if at == frame}
        ids = sorted(here)
        steps = np.repeat(np.array(step_px)[:, None], len(ids), axis=1)
        trails, ended = trails.extend(front(ids, droplets_at([here[key] for key in ids])), frame, steps)
        complete.append(ended)
    complete.append(trails)
    names = list(Trails.__dataclass_fields__)
    everything = Trails(*(np.concatenate([getattr(part, name) for part in complete]) for name in names))
    return everything[np.argsort(everything.trajectory_id)]


def test_trails_know_where_trajectories_begin_and_end() -> None:
    """Whatever the frames they span."""
    trails = walk_back({4: [(0, 10, 10), (1, 12, 11), (2, 14, 12)], 7: [(1, 50, 50), (2, 51, 50)]}, (3.0, 1.0))
    assert trails.trajectory_id.tolist() == [4, 7]
    assert trails.n_frames.tolist() == [3, 2]
    assert trails.first_frame.tolist() == [0, 1]
    assert trails.last_frame.tolist() == [2, 2]
    assert trails.last_x_px.tolist() == [14, 51]
    assert trails.predicted_x_px.tolist() == [6, 3]
    assert trails.predicted_y_px.tolist() == [2, 1]


def test_reasons_are_short_or_stationary_or_none() -> None:
    """Section 3.3.3: fewer than three frames; less than half the predicted way."""
    paths = {
        0: [(0, 10, 10), (1, 20, 10)],
        1: [(0, 30, 30), (1, 30, 30), (2, 30.5, 30)],
        2: [(0, 60, 60), (1, 65, 60), (2, 70, 60)],
        3: [(0, 90, 90), (1, 90, 94), (2, 90, 98)],
    }
    why = reasons(walk_back(paths, (4.0, 0.0)), shortest_frames=3, stationary_fraction=0.5)
    assert why.tolist() == ["short", "stationary", "", ""]


def test_nothing_is_stationary_in_a_fluid_that_is() -> None:
    """Where no motion is predicted there is nothing to compare with."""
    paths = {0: [(0, 10, 10), (1, 10, 10), (2, 10, 10)]}
    assert reasons(walk_back(paths, (0.0, 0.0)), shortest_frames=3, stationary_fraction=0.5).tolist() == [""]


def in_view(x_px: float, *, entering_px: float, leaving_px: float, first_frame: int = 5, n_frames: int = 1) -> str:
    """The verdict on one trajectory in a frame 100 px wide that should move as said before and after it."""
    steps = [np.array([[px], [0.0]]) for px in (entering_px, leaving_px)]
    here = front([3], droplets_at([(x_px, 50.0, 5.0)]))
    trails = Trails.begin(Front.empty(), 20)
    for frame in reversed(range(first_frame, first_frame + n_frames)):
        trails, _ = trails.extend(here, frame, steps[1])
    _, complete = trails.extend(Front.empty(), first_frame - 1, np.empty((2, 0)), steps[0])
    return str(reasons(complete, shortest_frames=3, stationary_fraction=0.0, frame_px=(100, 100))[0])


def test_what_crosses_the_view_in_fewer_frames_than_needed_is_brief() -> None:
    """It came from outside and goes there again; one that should still be there, or have been, is short."""
    assert in_view(50, entering_px=60, leaving_px=60) == "brief"
    assert in_view(80, entering_px=20, leaving_px=40) == "short"
    assert in_view(80, entering_px=45, leaving_px=40) == "brief"
    assert in_view(80, entering_px=90, leaving_px=40, n_frames=2) == "brief"
    assert in_view(50, entering_px=0, leaving_px=0) == "short"


def test_what_the_film_begins_or_ends_with_is_brief() -> None:
    """Nobody knows for how long it was in view; without the size of the frames it is short as ever."""
    trails = walk_back({0: [(0, 50, 50)], 1: [(2, 20, 20)], 2: [(4, 70, 70)]}, (0.0, 0.0))
    judged = reasons(trails, shortest_frames=3, stationary_fraction=0.0, frame_px=(100, 100))
    assert judged.tolist() == ["brief", "short", "short"]
    trails = trails[:2]
    assert reasons(trails, shortest_frames=3, stationary_fraction=0.0).tolist() == ["short", "short"]
