"""What can be wrong about files and frames."""

from http import HTTPStatus

from backend.platform.problems import Conflict, NotFound, ServiceError
from dropflow.errors import FieldProblem


class UploadError(ServiceError):
    """A file cannot be taken."""

    default_code = "upload.refused"
    status = HTTPStatus.UNPROCESSABLE_ENTITY


class BadName(UploadError):
    """The name of a file is none."""

    def __init__(self, message: str) -> None:
        super().__init__("The name cannot be used.", code="upload.name", fields=[FieldProblem("name", message)])


class TooLarge(UploadError):
    """The file or the stack would be larger than this service takes."""

    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE

    def __init__(self, what: str, max_bytes: int, name: str) -> None:
        super().__init__(
            f"The {what} would be larger than the {max_bytes:,} bytes that this service takes.",
            code="upload.too_large",
            file=name,
        )


class WrongKind(UploadError):
    """The content is not what this role needs."""

    status = HTTPStatus.UNSUPPORTED_MEDIA_TYPE

    def __init__(self, name: str, *, code: str, message: str, hint: str) -> None:
        super().__init__(message, code=code, file=name, hint=hint)


class EmptyFile(UploadError):
    """There is nothing in it."""

    def __init__(self, name: str) -> None:
        super().__init__("The file is empty.", code="upload.empty", file=name)


class StackClosed(Conflict):
    """Its frames are complete already."""

    def __init__(self) -> None:
        super().__init__(
            "The stack is complete: no more files can be added.",
            code="conflict.stack_closed",
            hint="Remove the frames to upload others.",
        )


class StackEmpty(Conflict):
    """Nothing was uploaded yet."""

    def __init__(self) -> None:
        super().__init__("There are no frames yet.", code="conflict.stack_empty", hint="Upload the frames first.")


class FilesMissing(Conflict):
    """Files that were announced have not arrived."""

    def __init__(self, n_files: int, n_bytes: int) -> None:
        super().__init__(
            f"{n_files:,} announced files have not arrived yet ({n_bytes:,} bytes).",
            code="conflict.files_missing",
            hint="Send them, or say missing=leave_out to go on without them.",
        )


class StackNotReady(Conflict):
    """Its frames cannot be used yet."""

    def __init__(self) -> None:
        super().__init__(
            "The frames are not ready.", code="conflict.stack_not_ready", hint="Upload them and wait for the index."
        )


class FramesExpired(Conflict):
    """Its raw frames were removed; what was made of them is there."""

    def __init__(self) -> None:
        super().__init__(
            "The raw frames were removed to save room; results stay.",
            code="conflict.frames_expired",
            hint="If they are still in the trash, bring them back from there.",
        )


class OtherFacts(Conflict):
    """What is confirmed is not what is here."""

    def __init__(self) -> None:
        super().__init__(
            "The frames or their description have changed meanwhile.",
            code="conflict.changed_meanwhile",
            hint="Look at them again.",
        )


class RunsExist(Conflict):
    """Runs were made from these frames."""

    def __init__(self) -> None:
        super().__init__(
            "The frames cannot be removed while there are runs of them.",
            code="conflict.runs_exist",
            hint="Delete the runs first.",
        )


class NoSuchFrame(NotFound):
    """The stack has no frame of this number."""

    def __init__(self, frame: int) -> None:
        super().__init__("There is no such frame.", code="not_found.frame", frame=frame)


class NoSuchFile(NotFound):
    """No file of this id was uploaded here."""

    def __init__(self) -> None:
        super().__init__("There is no such file.", code="not_found.file")
