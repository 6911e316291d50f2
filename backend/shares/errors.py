"""What can be wrong about links to runs."""

from backend.platform.problems import NotFound


class NoSuchShare(NotFound):
    """The run has no such link."""

    def __init__(self) -> None:
        super().__init__("This run has no such link.", code="not_found.share")
