"""What the environment says about this instance."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from deploy.local.errors import LauncherError

HOST = "127.0.0.1"


@dataclass(frozen=True)
class Options:
    """`database_url` and `redis_url` are None where the embedded servers are used."""

    port: int = 8000
    data: Path = Path("data")
    database_url: str | None = None
    redis_url: str | None = None
    has_demo: bool = True

    @property
    def address(self) -> str:
        return f"http://{HOST}:{self.port}/"


def sign_in_link(options: Options, secret: str) -> str:
    """Behind the # stands what browsers never send to a server, so that no log holds it."""
    return f"{options.address}sign-in#{secret}"


def read_options(environment: Mapping[str, str]) -> Options:
    """PORT, DATA, DATABASE_URL, REDIS_URL, DEMO (0: none); an empty one counts as absent."""
    given = {name: value for name, value in environment.items() if value}
    return Options(
        port=_port(given.get("PORT", "8000")),
        data=Path(given.get("DATA", "data")).expanduser().absolute(),
        database_url=given.get("DATABASE_URL"),
        redis_url=given.get("REDIS_URL"),
        has_demo=given.get("DEMO", "1") != "0",
    )


def _port(text: str) -> int:
    if not (text.isascii() and text.isdigit() and 1 <= int(text) <= 65535):
        raise LauncherError(f"PORT is {text!r}; it must be a number from 1 to 65535.", exit_code=2)
    return int(text)
