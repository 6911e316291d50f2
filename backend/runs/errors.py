"""What can be wrong about runs."""

from backend.platform.problems import Conflict, NotFound


class NoSuchRun(NotFound):
    """It does not exist, or this person may not see it."""

    def __init__(self) -> None:
        super().__init__("There is no such run.", code="not_found.run")


class RunFinished(Conflict):
    """It has ended, and what has ended never changes."""

    def __init__(self) -> None:
        super().__init__("The run has ended already.", code="conflict.run_finished")


class RunNotFailed(Conflict):
    """Only what failed can be retried."""

    def __init__(self) -> None:
        super().__init__(
            "Only a failed run can be retried.", code="conflict.run_not_failed", hint="Start a new run instead."
        )


class RunActive(Conflict):
    """It goes on."""

    def __init__(self) -> None:
        super().__init__(
            "The run cannot be deleted while it goes on.", code="conflict.run_active", hint="Cancel it first."
        )
