"""What can be wrong about presets."""

from backend.platform.problems import Conflict, NotFound


class NoSuchPreset(NotFound):
    """The group has no such preset."""

    def __init__(self) -> None:
        super().__init__("This group has no such preset (any more).", code="not_found.preset")


class NameTaken(Conflict):
    """The group has a preset of this name."""

    def __init__(self, name: str) -> None:
        super().__init__(
            f"This group has a preset “{name}” already.",
            code="conflict.preset_name",
            hint="Choose another name, or replace that preset.",
        )


class TooManyPresets(Conflict):
    """More than anybody finds their way in."""

    def __init__(self, most: int) -> None:
        super().__init__(
            f"This group has {most} presets already, and no more are kept.",
            code="conflict.presets_full",
            hint="Delete one that is not used any more.",
        )
