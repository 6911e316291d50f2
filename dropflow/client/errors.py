"""What can go wrong between here and a server. All are `dropflow.errors.DropflowError`: one line, and a stable code.

ClientError
|-- ServerProblem      the server's own answer; `code` and `status` are the server's
|-- NotReachable       client.not_reachable      nobody answers, or somebody who is no Dropflow
|-- WrongVersion       client.wrong_version      the server speaks another major version, or is too old for this call
|-- NotConfigured      client.not_configured     no server is known
|-- WentWrong          client.went_wrong         frames were rejected, a run failed or was cancelled
`-- Damaged            client.damaged            what arrived is not what was sent
"""

from typing import Any

from dropflow.errors import DropflowError, FieldProblem


class ClientError(DropflowError):
    """Base of all errors of the client."""

    default_code = "client.error"


class ServerProblem(ClientError):
    """What the server answered instead of what was asked for."""

    def __init__(self, message: str, *, status: int = 0, **about: Any) -> None:
        super().__init__(message, **about)
        self.status = status


class NotReachable(ClientError):
    """Nobody answers there."""

    default_code = "client.not_reachable"


class WrongVersion(ClientError):
    """Server and client do not understand each other, or not in this."""

    default_code = "client.wrong_version"


class NotConfigured(ClientError):
    """No server is known."""

    default_code = "client.not_configured"


class WentWrong(ClientError):
    """What was waited for ended otherwise."""

    default_code = "client.went_wrong"


class Damaged(ClientError):
    """The bytes that arrived are not those that were sent."""

    default_code = "client.damaged"


def problem_error(content: Any, status: int) -> ServerProblem:
    """The server's problem document as an error."""
    if not isinstance(content, dict) or "detail" not in content:
        return ServerProblem(f"The server answered {status}.", status=status, code=f"http.{status}")
    return ServerProblem(
        str(content["detail"]),
        status=status,
        code=str(content.get("code") or f"http.{status}"),
        file=content.get("file"),
        frame=content.get("frame"),
        fields=[FieldProblem(found["field"], found["message"]) for found in content.get("errors") or ()],
        hint=content.get("hint"),
    )
