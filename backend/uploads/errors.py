"""What can be wrong about uploads on their way."""

from http import HTTPStatus

from backend.platform.problems import Conflict, NotFound, ServiceError
from dropflow.errors import FieldProblem


class NoSuchUpload(NotFound):
    """It was terminated, expired, or never there for this person."""

    def __init__(self) -> None:
        super().__init__("There is no such upload.", code="not_found.upload", hint="Plan the upload again.")


class WrongOffset(Conflict):
    """The bytes are not those that come next."""

    def __init__(self, offset_bytes: int) -> None:
        super().__init__(
            f"The next byte of this upload is number {offset_bytes:,}.",
            code="conflict.upload_offset",
            hint="Ask for Upload-Offset by HEAD and go on from there.",
            headers={"Upload-Offset": str(offset_bytes)},
        )


class InUse(ServiceError):
    """Somebody else sends the same upload just now."""

    default_code = "upload.in_use"
    status = HTTPStatus.LOCKED

    def __init__(self) -> None:
        super().__init__(
            "Another tab, computer or program is sending this upload.",
            hint="Wait a few seconds: when it ends or stops, this one can go on.",
            headers={"Retry-After": "5"},
        )


class ChecksumMismatch(ServiceError):
    """The bytes that came are not those that were announced."""

    default_code = "upload.checksum"
    status = 460

    def __init__(self, file: str | None = None) -> None:
        super().__init__(
            "The bytes that arrived are not those that were sent.",
            file=file,
            hint="They do not count: send them again.",
        )


class TooManyBytes(ServiceError):
    """More bytes than the upload was announced with."""

    default_code = "upload.too_long"
    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE

    def __init__(self, size_bytes: int) -> None:
        super().__init__(f"The upload was announced with {size_bytes:,} bytes, and more came.")


class WrongVersion(ServiceError):
    """The request does not speak the protocol's version."""

    default_code = "upload.version"
    status = HTTPStatus.PRECONDITION_FAILED

    def __init__(self) -> None:
        super().__init__(
            "This address speaks the upload protocol tus 1.0.0.",
            hint="Send the header Tus-Resumable: 1.0.0.",
            headers={"Tus-Version": "1.0.0"},
        )


class BadHeader(ServiceError):
    """A header of the protocol is missing or malformed."""

    default_code = "upload.header"
    status = HTTPStatus.BAD_REQUEST

    def __init__(self, header: str, message: str) -> None:
        super().__init__("The request is not as the upload protocol wants it.", fields=[FieldProblem(header, message)])


class WrongContentType(ServiceError):
    """The bytes of an upload have a content type of their own."""

    default_code = "upload.content_type"
    status = HTTPStatus.UNSUPPORTED_MEDIA_TYPE

    def __init__(self) -> None:
        super().__init__("Send the bytes with Content-Type: application/offset+octet-stream.")
