"""People and their sign-ins as the API shows and takes them."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Literal
from uuid import UUID

from pydantic import AfterValidator, BaseModel, ConfigDict, StrictBool, StringConstraints

from backend.groups.schemas import Name, OwnGroup, Secret
from backend.platform.texts import Line

LEAST_PASSWORD = 10


def _plausible(email: str) -> str:
    if email.count("@") != 1 or any(character.isspace() for character in email) or not all(email.split("@")):
        raise ValueError("must be an e-mail address such as ada@example.org")
    return email


Email = Annotated[
    Line, StringConstraints(strip_whitespace=True, to_lower=True, max_length=320), AfterValidator(_plausible)
]
Password = Annotated[str, StringConstraints(min_length=1, max_length=200)]
NewPasswordText = Annotated[str, StringConstraints(min_length=LEAST_PASSWORD, max_length=200)]


class Way(StrEnum):
    """How one can sign in here."""

    LINK = "link"
    PASSWORD = "password"  # noqa: S105 - the name of a way
    OIDC = "oidc"


class Person(BaseModel):
    """A person as they see themselves."""

    model_config = ConfigDict(from_attributes=True)

    id: UUID
    name: str
    email: str | None
    is_administrator: bool
    is_mailed: bool
    """Whether you get e-mail when a run that you started has ended (where the service sends any)."""
    has_password: bool


class Session(BaseModel):
    """Who is signed in, and how one can."""

    person: Person | None
    groups: list[OwnGroup]
    ways: list[Way]
    oidc_name: str | None
    """What the button says that leads to the provider of sign-ins."""
    is_mailing: bool
    """Whether this service sends e-mail."""
    is_local: bool
    """A service of one person on one machine: there is nobody to invite."""
    shared_run_id: UUID | None
    """The run that a link lets this browser look at."""


class SignIn(BaseModel):
    """One of: e-mail and password, the secret of a link that signs in, or of a link to a shared run."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"examples": [{"email": "ada@example.org", "password": "correct horse battery"}]},
    )

    email: Annotated[str, StringConstraints(strip_whitespace=True, to_lower=True, max_length=320)] | None = None
    password: Password | None = None
    link: Secret | None = None
    share: Secret | None = None


class NewAccount(BaseModel):
    """What somebody says of themselves."""

    model_config = ConfigDict(extra="forbid")

    name: Name
    email: Email
    password: NewPasswordText


class AcceptInvitation(BaseModel):
    """The secret of an invitation; without an account, also who you are."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"secret": "inv_...", "account": None}]})

    secret: Secret
    account: NewAccount | None = None


class ChangeAccount(BaseModel):
    """What to change of your account; what is absent stays."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"name": "Ada Lovelace"}]})

    name: Name | None = None
    is_mailed: StrictBool | None = None


class NewPassword(BaseModel):
    """Another password. `old` is not asked for after signing in with a link."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"old": "correct horse", "new": "correct horse battery"}]}
    )

    old: Password | None = None
    new: NewPasswordText


class SignedInBrowser(BaseModel):
    """A browser in which you are signed in."""

    id: UUID
    browser: str
    came_by: str
    created_at: datetime
    used_at: datetime
    is_this: bool


class SignedInBrowsers(BaseModel):
    """All of them."""

    items: list[SignedInBrowser]


class KnownPerson(BaseModel):
    """A person as an administrator sees them."""

    id: UUID
    name: str
    email: str | None
    is_administrator: bool
    is_disabled: bool
    signs_in_by: list[Literal["password", "oidc"]]
    created_at: datetime
    seen_at: datetime | None


class People(BaseModel):
    """Everybody."""

    items: list[KnownPerson]


class NewPerson(BaseModel):
    """Somebody to make an account for."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"name": "Ada", "email": "ada@example.org"}]}
    )

    name: Name
    email: Email
    is_administrator: bool = False


class ChangePerson(BaseModel):
    """What to change of a person; what is absent stays."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"is_disabled": True}]})

    is_administrator: StrictBool | None = None
    is_disabled: StrictBool | None = None


class PersonLink(BaseModel):
    """A link that signs this person in, once. It is shown this once."""

    person: KnownPerson
    link: str
    expires_at: datetime
