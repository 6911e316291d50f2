"""What can be asked of single trajectories."""

from backend.platform.object_store import ObjectStore
from backend.results.service import Asker
from backend.trajectories import tables
from backend.trajectories.errors import NoSuchTrajectory
from backend.trajectories.schemas import Tails, Trajectory
from dropflow.experiment import parse_experiment


def tails(asker: Asker, store: ObjectStore, frame: int, n_frames: int) -> Tails:
    """Where the droplets of a frame come from."""
    product = asker.product("track", frame)
    rows = tables.frames_between(store, product, max(0, frame - n_frames), frame)
    ids, offsets, points = tables.tails(rows, frame)
    return Tails(
        frame=frame,
        n_frames=n_frames,
        trajectory_id=ids.tolist(),
        offsets=offsets.tolist(),
        x_px=points["x_px"].to_pylist(),
        y_px=points["y_px"].to_pylist(),
    )


def trajectory(asker: Asker, store: ObjectStore, trajectory_id: int) -> Trajectory:
    """One droplet over time."""
    product = asker.product("track")
    rows = tables.one(store, product, trajectory_id)
    if len(rows) == 0:
        raise NoSuchTrajectory
    experiment = parse_experiment(asker.run.document)
    r_std_px = tables.values(rows, "r_std_px")
    same = ("frame", "time_s", "x_px", "y_px", "r_um", "match", "probability", "is_detected", "u_um_s", "v_um_s")
    return Trajectory(
        trajectory_id=trajectory_id,
        r_std_um=[None if std is None else std * experiment.pixel_size_um for std in r_std_px],
        sedimentation_um_s=tables.values(rows, "sedimentation_um_s"),
        up=experiment.up,
        **{name: tables.values(rows, name) for name in same},
    )
