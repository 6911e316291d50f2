"""A service with accounts: people, groups, and each person's browser or program as a client of the API.

lab = ...                                  # the fixture `lab`
group = lab.group("Foams")
ada = lab.person("Ada", {group: Right.EDIT})
experiment = lab.as_(ada).experiment()     # a House whose `api` is Ada's browser
lab.program(ada, Scope.SUBMIT).get("experiments")
"""

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta
from uuid import UUID

import httpx

from backend.models import ApiToken, BrowserSession, Group, Membership, Right, Scope, ShareLink
from backend.people import service
from backend.people.administrator import administrator
from backend.platform.database import make_engine, make_sessions
from backend.platform.identity import session_cookie, share_cookie
from backend.platform.secrets import hashed, new_secret
from backend.platform.settings import Settings
from tests.completed import completed_run
from tests.films import EXPERIMENT
from tests.house import House, open_house

ADDRESS = "http://dropflow.test/"
SECRET = "not a secret: it stands in the tests"  # noqa: S105
ADMINISTRATOR = "root@dropflow.test"


def lab_settings(settings: Settings, **changes: object) -> Settings:
    """The same service with accounts."""
    given = settings.model_dump() | {"auth": "accounts", "secret": SECRET, "public_url": ADDRESS}
    return Settings.model_validate(given | {"sign_ins_per_minute": 10_000} | changes)


@dataclass(frozen=True)
class Lab:
    """A running service with accounts."""

    house: House
    settings: Settings
    administrator: UUID
    _clients: ExitStack = field(default_factory=ExitStack)

    def person(self, name: str, rights: Mapping[UUID, Right] | None = None, *, password: str | None = None) -> UUID:
        """Somebody with an account; their address is NAME@dropflow.test, unless that is taken."""
        with self.house.context.sessions.begin() as session:
            email = f"{name.lower()}.{new_secret()[:6].lower()}@dropflow.test"
            person = service.create(session, name=name, email=email, password=password)
            for group_id, right in (rights or {}).items():
                session.add(Membership(person_id=person.id, group_id=group_id, right=right))
            return person.id

    def email(self, person_id: UUID) -> str:
        """With what somebody signs in."""
        with self.house.context.sessions() as session:
            return str(service.get(session, person_id).email)

    def group(self, name: str) -> UUID:
        """A group without members."""
        with self.house.context.sessions.begin() as session:
            group = Group(name=name)
            session.add(group)
            session.flush()
            return group.id

    def nobody(self) -> httpx.Client:
        """A browser in which nobody is signed in."""
        client = httpx.Client(base_url=self.house.api.base_url, headers={"Origin": ADDRESS.rstrip("/")}, timeout=30)
        return self._clients.enter_context(client)

    def browser(self, person_id: UUID) -> httpx.Client:
        """A browser in which somebody is signed in."""
        secret, now = new_secret(), datetime.now(UTC)
        lasts = {"used_at": now, "expires_at": now + timedelta(days=1)}
        made = BrowserSession(person_id=person_id, secret_hash=hashed(secret), browser="test", came_by="test", **lasts)
        with self.house.context.sessions.begin() as session:
            session.add(made)
        client = self.nobody()
        client.cookies.set(session_cookie(self.settings), secret)
        return client

    def program(self, person_id: UUID, scope: Scope, *, lasts: timedelta = timedelta(days=1)) -> httpx.Client:
        """A program that has a token of somebody."""
        secret = new_secret("df_")
        made = ApiToken(person_id=person_id, name="test", beginning=secret[:8], scope=scope, secret_hash=hashed(secret))
        made.expires_at = datetime.now(UTC) + lasts
        with self.house.context.sessions.begin() as session:
            session.add(made)
        client = httpx.Client(
            base_url=self.house.api.base_url, headers={"Authorization": f"Bearer {secret}"}, timeout=30
        )
        return self._clients.enter_context(client)

    def visitor(self, run_id: UUID) -> httpx.Client:
        """A browser that came by the link to a shared run."""
        secret = new_secret()
        made = ShareLink(run_id=run_id, secret_hash=hashed(secret), expires_at=datetime.now(UTC) + timedelta(days=1))
        with self.house.context.sessions.begin() as session:
            session.add(made)
        client = self.nobody()
        client.cookies.set(share_cookie(self.settings), secret)
        return client

    def as_(self, person_id: UUID) -> House:
        """The house as somebody uses it in their browser."""
        return replace(self.house, api=self.browser(person_id))

    def finished(self, group_id: UUID) -> tuple[UUID, UUID]:
        """The rows of an experiment and of a run that completed, without any frames or results: (experiment, run)."""
        with self.house.context.sessions.begin() as session:
            run = completed_run(session, group_id, EXPERIMENT, (64, 64), 4)
            return run.experiment_id, run.id


@contextmanager
def open_lab(settings: Settings) -> Iterator[Lab]:
    """Serve with accounts until the context ends."""
    engine = make_engine(settings.database_url, application="test")
    with make_sessions(engine).begin() as session:
        administrator(session, settings, email=ADMINISTRATOR, name="Root")
        person_id = next(person.id for person in service.everybody(session) if person.email == ADMINISTRATOR)
    engine.dispose()
    with open_house(settings) as house:
        lab = Lab(house, settings, person_id)
        with lab._clients:
            yield lab
