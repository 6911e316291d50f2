"""What can be wrong about experiments."""

from backend.platform.problems import Conflict, NotFound


class NoSuchExperiment(NotFound):
    """It does not exist, or this person may not see it."""

    def __init__(self) -> None:
        super().__init__("There is no such experiment.", code="not_found.experiment")


class RunActive(Conflict):
    """A run of it is queued or running."""

    def __init__(self, doing: str) -> None:
        super().__init__(
            f"The experiment cannot be {doing} while a run of it goes on.",
            code="conflict.run_active",
            hint="Cancel the run or wait for its end.",
        )


class StackIndexing(Conflict):
    """Its frames are being read."""

    def __init__(self) -> None:
        super().__init__(
            "The experiment cannot be changed while its frames are being read.",
            code="conflict.stack_indexing",
            hint="Wait until that is done.",
        )


class DescribesFiles(Conflict):
    """The change is about files that were read already."""

    def __init__(self, fields: list[str]) -> None:
        super().__init__(
            f"{', '.join(fields)} cannot be changed: the uploaded files were read with it.",
            code="conflict.describes_files",
            hint="Remove the frames, change the experiment and upload them again.",
        )
