"""The words of tus 1.0 in the headers of a request."""

import base64
import binascii
import hashlib
from dataclasses import dataclass

from starlette.datastructures import Headers

from backend.uploads.errors import BadHeader, WrongContentType, WrongVersion

VERSION = "1.0.0"
EXTENSIONS = "creation,creation-with-upload,checksum,expiration,termination"
ALGORITHMS = ("sha256", "sha1", "md5")
BYTES_TYPE = "application/offset+octet-stream"
_LONGEST = 2**53


@dataclass(frozen=True)
class Checksum:
    """What the bytes of a request are to sum up to."""

    algorithm: str
    digest: bytes


def check_version(headers: Headers) -> None:
    """Every request but OPTIONS says which version it speaks."""
    if headers.get("tus-resumable") != VERSION:
        raise WrongVersion


def check_bytes_type(headers: Headers) -> None:
    """The bytes of an upload have a type of their own."""
    if headers.get("content-type") != BYTES_TYPE:
        raise WrongContentType


def number(headers: Headers, name: str) -> int:
    """A header that must be a count of bytes."""
    text = headers.get(name, "")
    if not text.isascii() or not text.isdecimal() or len(text) > 16 or int(text) > _LONGEST:
        raise BadHeader(name, "must be a whole number of bytes, 0 or more")
    return int(text)


def metadata(headers: Headers) -> dict[str, str]:
    """`Upload-Metadata`: names, each with its value in base64."""
    found = {}
    for pair in filter(None, (part.strip() for part in headers.get("upload-metadata", "").split(","))):
        name, _, value = pair.partition(" ")
        try:
            found[name] = base64.b64decode(value, validate=True).decode("utf-8")
        except (binascii.Error, UnicodeDecodeError):
            raise BadHeader("Upload-Metadata", f"the value of {name[:50]} must be UTF-8 in base64") from None
    return found


def checksum(headers: Headers) -> Checksum | None:
    """`Upload-Checksum`: an algorithm and the digest in base64."""
    text = headers.get("upload-checksum")
    if text is None:
        return None
    algorithm, _, value = text.partition(" ")
    if algorithm not in ALGORITHMS:
        raise BadHeader("Upload-Checksum", f"give one of {', '.join(ALGORITHMS)}")
    try:
        digest = base64.b64decode(value, validate=True)
    except binascii.Error:
        digest = b""
    if len(digest) != hashlib.new(algorithm, usedforsecurity=False).digest_size:
        raise BadHeader("Upload-Checksum", f"give the {algorithm} digest in base64")
    return Checksum(algorithm, digest)
