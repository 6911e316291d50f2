"""What a plain tus client says of a file before it sends it."""

from pydantic import ValidationError
from starlette.datastructures import Headers

from backend.stacks.schemas import Role
from backend.uploads import headers as tus
from backend.uploads.errors import BadHeader
from backend.uploads.schemas import Announced


def announced(headers: Headers) -> Announced:
    """The file of `Upload-Length` and `Upload-Metadata`: filename, and if need be role and sha256."""
    if "upload-defer-length" in headers:
        raise BadHeader("Upload-Defer-Length", "is not supported: say Upload-Length")
    said = tus.metadata(headers)
    name = said.get("filename") or said.get("name")
    if not name:
        raise BadHeader("Upload-Metadata", "must have a filename")
    try:
        return Announced(
            name=name,
            size_bytes=tus.number(headers, "Upload-Length"),
            role=Role(said.get("role", Role.FRAMES)),
            sha256=said.get("sha256"),
        )
    except ValidationError:
        raise BadHeader("Upload-Metadata", "sha256 must be 64 hexadecimal digits in lower case") from None
    except ValueError:
        raise BadHeader("Upload-Metadata", f"role must be one of {', '.join(Role)}") from None
