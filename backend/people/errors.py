"""What can be wrong about people and how they sign in."""

from http import HTTPStatus

from backend.platform.problems import Conflict, NotFound, ServiceError
from dropflow.errors import FieldProblem


class NoSuchPerson(NotFound):
    """Nobody has this id."""

    def __init__(self) -> None:
        super().__init__("There is no such person.", code="not_found.person")


class NoSuchSession(NotFound):
    """They are not signed in there."""

    def __init__(self) -> None:
        super().__init__("You are not signed in there.", code="not_found.session")


class WrongSignIn(ServiceError):
    """Which part of it is wrong is not said."""

    status = HTTPStatus.UNAUTHORIZED

    def __init__(self) -> None:
        super().__init__("The e-mail address and the password do not belong together.", code="session.wrong_password")


class LinkSpent(ServiceError):
    """A link that signs in works once, and not for ever."""

    status = HTTPStatus.UNAUTHORIZED

    def __init__(self) -> None:
        super().__init__(
            "This link was used already, or is too old.",
            code="session.link_spent",
            hint="Ask for another: an administrator can make one; on your own machine `make sign-in` prints one.",
        )


class LockedOut(ServiceError):
    """An administrator locked this account."""

    status = HTTPStatus.FORBIDDEN

    def __init__(self) -> None:
        super().__init__("This account is locked.", code="session.locked_out", hint="Ask an administrator.")


class NoProvider(NotFound):
    """Nobody signs in elsewhere here."""

    def __init__(self) -> None:
        super().__init__("This service has no provider of sign-ins.", code="not_found.provider")


class ShareExpired(ServiceError):
    """A link to a shared run does not work for ever."""

    status = HTTPStatus.UNAUTHORIZED

    def __init__(self) -> None:
        super().__init__(
            "This link to a run is too old, or was taken back.",
            code="session.share_expired",
            hint="Ask whoever sent it for another.",
        )


class WrongPassword(ServiceError):
    """The password one has is asked for before another is taken."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY

    def __init__(self) -> None:
        message = "is not the password you have now"
        super().__init__("Please correct:", code="account.wrong_password", fields=[FieldProblem("old", message)])


class EmailTaken(Conflict):
    """One address, one person."""

    def __init__(self) -> None:
        super().__init__(
            "Somebody has an account with this e-mail address already.",
            code="conflict.email",
            hint="If that is you, sign in first and open the link again.",
        )


class LastAdministrator(Conflict):
    """Nobody would be left to look after the service."""

    def __init__(self) -> None:
        super().__init__("Nobody else is an administrator here.", code="conflict.last_administrator")


class BadEmail(ServiceError):
    """What was given is no e-mail address."""

    status = HTTPStatus.UNPROCESSABLE_ENTITY

    def __init__(self, email: str) -> None:
        super().__init__(f"{email!r} is no e-mail address.", code="account.email")
