import numpy as np
import pytest

from dropflow.droplets import Droplets
from dropflow.parameters import FlowParameters, TrackingParameters
from dropflow.physics.material import resolve
from dropflow.tracking.front import Front
from dropflow.tracking.grid import Grid
from dropflow.tracking.paper import PaperRules
from dropflow.tracking.paper.backward import retreat
from dropflow.tracking.paper.forward import State, advance
from dropflow.tracking.prediction import Motion
from tests.dropflow.tracking.generated import droplets_at, experiment

DT_S = 2.0


@pytest.fixture
def rules() -> PaperRules:
    about = experiment(delta_density_kg_m3=-100.0)
    grid = Grid(height_px=300, width_px=360, n_rows=6, n_columns=7)
    return PaperRules(grid, Motion.of(about, resolve(about)), TrackingParameters(), FlowParameters())


def blind(predicted: Droplets) -> tuple[Droplets, np.ndarray]:
    """An image without any droplet."""
    return predicted, np.zeros(len(predicted), bool)


def showing(shown: Droplets):
    """An image in which exactly the droplets `shown` can be found, from less than a radius away."""

    def look(predicted: Droplets) -> tuple[Droplets, np.ndarray]:
        distance = np.hypot(predicted.x_px[:, None] - shown.x_px, predicted.y_px[:, None] - shown.y_px)
        nearest = distance.argmin(axis=1)
        return shown[nearest], distance.min(axis=1) < predicted.r_px

    return look


def front(ids: list[int], droplets: Droplets) -> Front:
    return Front.of(np.array(ids), droplets, is_detected=True)


def crowd(shift: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Twelve droplets on a lattice, r 5 px, displaced by `shift`."""
    x, y = np.meshgrid([60.0, 140.0, 220.0, 300.0], [60.0, 150.0, 240.0])
    return np.column_stack([x.ravel() + shift[0], y.ravel() + shift[1], np.full(12, 5.0)])


def rise_px(rules: PaperRules, r_px: float) -> float:
    return float(rules.motion.sedimentation_um_s(np.array([r_px]))[0] * DT_S / rules.motion.pixel_size_um)


def test_prediction_is_flow_plus_sedimentation_and_goes_back_to_where_it_came_from(rules: PaperRules) -> None:
    """Eq. 5: forward and backward cancel in a flow that changes over the frame."""
    before = droplets_at([(100, 100, 5), (200, 150, 20)])
    flow = rules.flow_between(droplets_at(crowd()), droplets_at(crowd((12, 6)) * [1.01, 1, 1]), DT_S)
    after = rules.motion.forward(before, flow, DT_S)
    assert before.y_px[1] - after.y_px[1] > before.y_px[0] - after.y_px[0]  # the bigger one rises faster
    back = rules.motion.backward(after, flow, DT_S)
    np.testing.assert_allclose(back.x_px, before.x_px, atol=1e-3)
    np.testing.assert_allclose(back.y_px, before.y_px, atol=1e-3)


def test_trajectories_go_on_and_new_droplets_begin_new_ones(rules: PaperRules) -> None:
    """All of the crowd is found again after a common displacement, in whatever order it is detected."""
    rise = rise_px(rules, 5.0)
    first = advance(State.initial(), droplets_at(crowd()), None, rules, DT_S)
    new_one = np.array([[20.0, 20.0, 8.0]])
    there = np.concatenate([new_one, crowd((15, 10 - rise))[::-1]])
    second = advance(first, droplets_at(there), None, rules, DT_S)
    assert second.front.trajectory_id.tolist() == list(range(13))
    np.testing.assert_allclose(second.front.droplets.x_px[:12], crowd()[:, 0] + 15)
    assert second.front.droplets.x_px[12] == 20
    assert second.flow is not None
    velocity = second.flow.sample(np.array([180.0]), np.array([150.0]))[:, 0]
    np.testing.assert_allclose(velocity, np.array([15, 10]) * rules.motion.pixel_size_um / DT_S, atol=1e-6)


def test_a_droplet_that_detection_missed_is_found_in_the_image(rules: PaperRules) -> None:
    """It goes on, and says that it was not detected."""
    first = advance(State.initial(), droplets_at(crowd()), None, rules, DT_S)
    there = crowd((10, -rise_px(rules, 5.0)))
    second = advance(first, droplets_at(there[:-1]), showing(droplets_at(there)), rules, DT_S)
    assert second.front.trajectory_id.tolist() == list(range(12))
    assert second.front.is_detected.tolist() == [True] * 11 + [False]
    np.testing.assert_allclose(second.front.droplets.x_px[-1], there[-1, 0])


def test_what_neither_detection_nor_image_shows_ends(rules: PaperRules) -> None:
    """And nothing takes its id."""
    first = advance(State.initial(), droplets_at(crowd()), None, rules, DT_S)
    there = crowd((10, -rise_px(rules, 5.0)))[:-1]
    second = advance(first, droplets_at(there), blind, rules, DT_S)
    assert second.front.trajectory_id.tolist() == list(range(11))


def test_two_trajectories_never_share_a_droplet(rules: PaperRules) -> None:
    """Two droplets of which the image shows one: the nearer one has it, whether detected or not."""
    pair = [(180.0, 105.0, 5.0), (186.0, 105.0, 5.0)]
    first = advance(State.initial(), droplets_at([*crowd(), *pair]), None, rules, DT_S)
    rise = rise_px(rules, 5.0)
    one = droplets_at([*crowd((0, -rise)), (181.0, 105.0 - rise, 5.0)])
    for detected in (one, one[:12]):
        second = advance(first, detected, showing(one), rules, DT_S)
        assert second.front.trajectory_id.tolist() == list(range(13))


def test_an_empty_frame_ends_all_trajectories_and_keeps_the_flow(rules: PaperRules) -> None:
    """The flow stays as a guess for the droplets that come after."""
    first = advance(State.initial(), droplets_at(crowd()), None, rules, DT_S)
    second = advance(first, droplets_at(crowd((10, 0))), None, rules, DT_S)
    third = advance(second, Droplets.empty(), blind, rules, DT_S)
    assert len(third.front) == 0
    assert third.flow is not None
    assert third.flow.is_known
    fourth = advance(third, droplets_at(crowd()), blind, rules, DT_S)
    assert fourth.front.trajectory_id.tolist() == list(range(12, 24))


def test_going_back_merges_an_interrupted_trajectory(rules: PaperRules) -> None:
    """The later one's id takes over the earlier one's rows."""
    rise = rise_px(rules, 5.0)
    earlier = front(list(range(12)), droplets_at(crowd()))
    later = front([*range(11), 20], droplets_at(crowd((5, -rise))))
    step, _ = retreat(later, earlier, blind, rules, None, DT_S)
    assert (step.merged.tolist(), step.merged_into.tolist()) == ([11], [20])
    assert step.front.trajectory_id.tolist() == [*range(11), 20]


def test_going_back_extends_a_beginning_that_only_the_image_shows(rules: PaperRules) -> None:
    """The trajectory grows by one row that was not detected."""
    rise = rise_px(rules, 5.0)
    earlier = front(list(range(11)), droplets_at(crowd()[:11]))
    later = front([*range(11), 20], droplets_at(crowd((5, -rise))))
    step, _ = retreat(later, earlier, showing(droplets_at(crowd())), rules, None, DT_S)
    assert step.front.trajectory_id.tolist() == [*range(11), 20]
    assert step.front.is_detected.tolist() == [True] * 11 + [False]
    np.testing.assert_allclose(step.front.droplets.x_px[-1], crowd()[-1, 0])


def test_going_back_does_not_branch(rules: PaperRules) -> None:
    """A beginning that would come from a droplet which goes on elsewhere stays where it is."""
    rise = rise_px(rules, 5.0)
    earlier = front(list(range(12)), droplets_at(crowd()))
    there = np.concatenate([crowd((5, -rise)), [crowd((7, -rise))[0]]])
    later = front([*range(12), 20], droplets_at(there))
    step, _ = retreat(later, earlier, showing(droplets_at(crowd())), rules, None, DT_S)
    assert step.front.trajectory_id.tolist() == list(range(12))
    assert len(step.merged) == 0
