"""What can be wrong about tokens."""

from backend.platform.problems import Conflict, NotFound


class NoSuchToken(NotFound):
    """It does not exist, or is somebody else's."""

    def __init__(self) -> None:
        super().__init__("You have no such token.", code="not_found.token")


class TooManyTokens(Conflict):
    """More than anybody can look after."""

    def __init__(self, n_tokens: int) -> None:
        super().__init__(
            f"You have {n_tokens} tokens already.", code="conflict.tokens", hint="Revoke those that nothing uses."
        )
