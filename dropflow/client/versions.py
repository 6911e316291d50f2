"""Which version of the API a server speaks, and what follows for what this client can do with it.

The rule: within /api/v1 a minor version only adds. So a newer server is always understood, and for an older one each
capability below says since when it is there. A server without a version document speaks 1.0.
"""

from dataclasses import dataclass
from enum import Enum

from dropflow.client.errors import WrongVersion

MAJOR = 1


@dataclass(frozen=True, order=True)
class ApiVersion:
    """`major.minor` of an API."""

    major: int
    minor: int

    def __str__(self) -> str:
        return f"{self.major}.{self.minor}"


FIRST = ApiVersion(1, 0)


class Capability(Enum):
    """What was added after the first version, and when."""

    RESUMABLE_UPLOADS = (ApiVersion(1, 1), "resumable uploads")
    IDEMPOTENCY = (ApiVersion(1, 1), "creating without doubles")
    LIST_FILTERS = (ApiVersion(1, 1), "filters of lists")
    ALL_RUNS = (ApiVersion(1, 1), "the list of all runs")
    RESUMABLE_DOWNLOADS = (ApiVersion(1, 1), "resumable downloads")
    IMPORTS = (ApiVersion(1, 2), "imports")

    @property
    def since(self) -> ApiVersion:
        """The first version that has it."""
        return self.value[0]

    @property
    def words(self) -> str:
        """What people call it."""
        return self.value[1]


def read_version(text: str | None) -> ApiVersion:
    """The version that a server tells; raise `WrongVersion` where it is none that this client speaks."""
    if text is None:
        return FIRST
    major, _, minor = text.partition(".")
    if not (major.isdecimal() and minor.isdecimal()):
        raise WrongVersion(f"The server speaks version {text} of the API, which this client does not know.")
    version = ApiVersion(int(major), int(minor))
    if version.major != MAJOR:
        raise WrongVersion(
            f"The server speaks version {version} of the API, this client version {MAJOR}.x.",
            hint="Install the dropflow package of the server's version.",
        )
    return version


def check(version: ApiVersion, capability: Capability) -> None:
    """Raise `WrongVersion` where a server is too old for something."""
    if version < capability.since:
        raise WrongVersion(
            f"The server speaks version {version} of the API; {capability.words} came with {capability.since}.",
            hint="Ask for an update of the server.",
        )
