"""What can be wrong about the trash."""

from backend.platform.problems import Conflict


class NotInTrash(Conflict):
    """Nobody threw it away, or it is gone for good."""

    def __init__(self) -> None:
        super().__init__("This is not in the trash.", code="conflict.not_in_trash")
