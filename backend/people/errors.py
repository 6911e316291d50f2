"""What can be wrong about people and groups."""

from backend.platform.problems import NotFound


class NoSuchGroup(NotFound):
    """The group does not exist, or this person is not in it."""

    def __init__(self) -> None:
        super().__init__("There is no such group.", code="not_found.group")
