"""What can be wrong about trajectories."""

from backend.platform.problems import NotFound


class NoSuchTrajectory(NotFound):
    """No droplet of the run has this number."""

    def __init__(self) -> None:
        super().__init__("This run has no trajectory of this number.", code="not_found.trajectory")
