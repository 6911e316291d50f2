"""What can be wrong about an import."""

from http import HTTPStatus

from backend.platform.problems import Conflict, NotFound, ServiceError


class NoSuchRoot(NotFound):
    """It is not on the list, or not for this group."""

    def __init__(self) -> None:
        super().__init__(
            "There is no such place to import from.",
            code="not_found.import_root",
            hint="An administrator lists places in IMPORT_ROOTS.",
        )


class FramesThere(Conflict):
    """Frames were uploaded, or are on their way."""

    def __init__(self) -> None:
        super().__init__(
            "There are frames already, or some are on their way.",
            code="conflict.frames_there",
            hint="Remove them first.",
        )


class RootAway(ServiceError):
    """The store behind a root does not answer."""

    default_code = "service.import_root_away"
    status = HTTPStatus.SERVICE_UNAVAILABLE

    def __init__(self) -> None:
        super().__init__("The place to import from cannot be reached just now.", hint="Try again.")
