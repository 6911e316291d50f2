"""What differs between one machine, a lab server and a cluster; read from the environment, refused where nonsense."""

import hashlib
import re
import tempfile
from functools import cache
from ipaddress import IPv4Network, IPv6Network
from pathlib import Path
from typing import Annotated, Literal, Self
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, SecretStr, field_validator, model_validator
from sqlalchemy import make_url
from sqlalchemy.exc import ArgumentError

from backend.platform.loopback import is_loopback
from backend.platform.settings_of_mail import LAST_PORT, MailSettings
from backend.platform.settings_of_provider import ProviderSettings

CHECKOUT = Path(__file__).resolve().parents[2]
GIGABYTE = 1_000_000_000
LEAST_SECRET = 32


class ImportRoot(BaseModel):
    """A place that frames may be imported from, and for whom."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    url: str
    groups: tuple[str, ...] | None = None
    """Names of groups; without it, all."""

    @model_validator(mode="before")
    @classmethod
    def _short(cls, given: object) -> object:
        return {"url": given} if isinstance(given, str) else given

    @field_validator("url")
    @classmethod
    def _folder_or_prefix(cls, url: str) -> str:
        if not url.startswith(("file:///", "s3://")) or url.rstrip("/") in ("file:", "s3:"):
            raise ValueError("must be file:///an/absolute/folder or s3://bucket/prefix")
        return url


class Settings(MailSettings, ProviderSettings):
    """Every setting of a process."""

    database_url: str
    """`postgresql://user:password@host:port/name`."""
    redis_url: str
    """`redis://host:port/0` of a Redis or Valkey server, which carries nothing that may not be lost."""
    object_store_url: str
    """`file:///some/folder`, or `s3://bucket/prefix` (then AWS_ENDPOINT_URL, AWS_ACCESS_KEY_ID, ... as usual)."""
    frontend_dist: Path = CHECKOUT / "frontend" / "dist"
    """The built page."""
    work_dir: Path = Path(tempfile.gettempdir()) / "dropflow-work"
    """Where workers keep what they are making until it is in the object store."""

    auth: Literal["local", "accounts"] = "local"
    """`local`: one person on one machine, which alone can reach it. `accounts`: people sign in."""
    local_token: SecretStr | None = None
    """With AUTH=local: the token of programs. Without one, every program of this machine is let in."""
    sign_in_token: SecretStr | None = None
    """With AUTH=local: whoever shows it first signs a browser in, as the link does that `make run` prints."""
    secret: SecretStr | None = None
    """What the service signs with: at least 32 characters that nobody can guess. AUTH=accounts needs it."""
    public_url: str | None = None
    """Where people reach the service, such as `https://droplets.example.org/`. AUTH=accounts needs it."""
    sign_ins_per_minute: Annotated[int, Field(ge=1)] = 20
    """Tries to sign in, from one address and with one e-mail address, before more are refused."""
    group_max_bytes: Annotated[int, Field(ge=0)] | None = None
    """Room for the frames and results of a group, unless an administrator gives it another; without it, no limit."""
    group_max_active_runs: Annotated[int, Field(ge=1)] | None = None
    """Runs of a group that are queued or running at once; likewise."""
    outward_networks: tuple[IPv4Network | IPv6Network, ...] = ()
    """JSON: networks inside the house to which webhooks may be sent, such as `["10.1.0.0/16"]`. Else: none."""
    host: str = "127.0.0.1"
    """Address to listen on."""
    port: Annotated[int, Field(ge=0, le=LAST_PORT)] = 8000
    """Port to listen on."""

    max_file_bytes: Annotated[int, Field(ge=1)] = 100 * GIGABYTE
    """Largest file that is taken."""
    max_stack_bytes: Annotated[int, Field(ge=1)] = 200 * GIGABYTE
    """Largest stack that is taken, all files together."""
    max_body_bytes: Annotated[int, Field(ge=1024)] = 1_000_000
    """Largest request that is no file."""

    import_roots: dict[str, ImportRoot] = Field(default_factory=dict)
    """JSON: what frames may be imported from, by name, such as `{"microscope": "file:///data/microscope", "archive":
    {"url": "s3://bucket/films", "groups": ["Foams"]}}`: nothing else of the server, and for these groups alone."""

    upload_expires_s: Annotated[float, Field(ge=60)] = 7 * 86_400.0
    """How long an upload that broke off can be continued after its last byte."""

    trash_keeps_s: Annotated[float, Field(ge=0)] | None = 30 * 86_400.0
    """How long what was deleted stays in the trash before it is removed for good."""
    frames_expire_s: Annotated[float, Field(ge=60)] | None = None
    """So long after their last completed run, raw frames go to the trash; results stay. Without it, they stay, too."""

    orphan_grace_s: Annotated[float, Field(ge=0)] = 86_400.0
    """How old an object that no row speaks of must be before it is removed."""

    worker_nice: Annotated[int, Field(ge=0, le=19)] = 10
    """How far workers step back on a machine that also answers people: `nice`. 0 for what somebody waits for."""
    lease_s: Annotated[float, Field(ge=1, le=3600)] = 60.0
    """How long a worker may be silent before its work goes to another."""
    longest_step_s: Annotated[float, Field(ge=1, le=86400)] = 1800.0
    """How long work may go on without a frame being done. What takes longer hangs, and is tried again."""
    reconcile_every_s: Annotated[float, Field(ge=0.1, le=60)] = 5.0
    """How often lost messages and expired leases are looked for."""
    resend_after_s: Annotated[float, Field(ge=0.1, le=600)] = 10.0
    """How long a shard waits before its message counts as lost, if its queue is empty."""
    metrics_address: str | None = None
    """`host:port` where Prometheus finds measures, beside the API and never through its proxy."""
    otel_exporter_otlp_endpoint: str | None = None
    """Where a collector of OpenTelemetry takes traces (OTLP over HTTP), such as `http://collector:4318`. Without it
    none are made."""
    log_level: Literal["DEBUG", "INFO", "WARNING", "ERROR"] = "INFO"
    """Least severe message that is written."""

    @field_validator("database_url")
    @classmethod
    def _postgres(cls, url: str) -> str:
        return with_driver(url)

    @field_validator("redis_url")
    @classmethod
    def _redis(cls, url: str) -> str:
        if not url.startswith(("redis://", "rediss://", "redis+socket://")):
            raise ValueError("must be a redis:// or rediss:// URL")
        return url

    @field_validator("object_store_url")
    @classmethod
    def _store(cls, url: str) -> str:
        if not url.startswith(("file:///", "s3://")):
            raise ValueError("must be file:///an/absolute/folder or s3://bucket/prefix")
        return url

    @field_validator("import_roots")
    @classmethod
    def _names_of_roots(cls, roots: dict[str, ImportRoot]) -> dict[str, ImportRoot]:
        if wrong := [name for name in roots if not re.fullmatch(r"[\w .-]{1,50}", name)]:
            raise ValueError(f"{wrong[0]!r} must be a name of letters, digits, spaces, dots and dashes")
        return roots

    @field_validator("otel_exporter_otlp_endpoint")
    @classmethod
    def _collector(cls, url: str | None) -> str | None:
        if not url:
            return None
        if not url.startswith(("http://", "https://")):
            raise ValueError("must be an http:// or https:// URL, such as http://127.0.0.1:4318")
        return url

    @field_validator("metrics_address")
    @classmethod
    def _host_and_port(cls, address: str | None) -> str | None:
        if address is None or address == "":
            return None
        host, _, port = address.rpartition(":")
        if not host or not port.isdecimal() or not 0 < int(port) <= LAST_PORT:
            raise ValueError("must be host:port, such as 127.0.0.1:9100")
        return address

    @model_validator(mode="after")
    def _sizes_fit(self) -> Self:
        if self.max_file_bytes > self.max_stack_bytes:
            raise ValueError("MAX_FILE_BYTES must not be larger than MAX_STACK_BYTES")
        return self

    @field_validator("public_url")
    @classmethod
    def _address(cls, url: str | None) -> str | None:
        if url is None:
            return None
        parts = urlsplit(url)
        if parts.scheme not in ("http", "https") or not parts.hostname or parts.query or parts.fragment:
            raise ValueError("must be an address such as https://droplets.example.org/")
        return url.rstrip("/") + "/"

    @model_validator(mode="after")
    def _open_to_this_machine_only(self) -> Self:
        if self.auth == "local" and not is_loopback(self.host):
            raise ValueError(
                "without accounts (AUTH=local) HOST must be a loopback address such as 127.0.0.1; "
                "for others to reach it set AUTH=accounts, SECRET and PUBLIC_URL"
            )
        return self

    @model_validator(mode="after")
    def _accounts_are_safe(self) -> Self:
        if self.auth == "local":
            if self.oidc_issuer is not None:
                raise ValueError("OIDC_ISSUER needs AUTH=accounts and OIDC_CLIENT_ID")
            return self
        if self.secret is None or len(self.secret.get_secret_value()) < LEAST_SECRET:
            raise ValueError(
                f"AUTH=accounts needs a SECRET of at least {LEAST_SECRET} characters (openssl rand -hex 32)"
            )
        if self.public_url is None:
            raise ValueError("AUTH=accounts needs PUBLIC_URL, the address at which people reach the service")
        return self

    @property
    def outside(self) -> dict[str, str]:
        """URLs of what frames may be imported from, by name."""
        return {name: root.url for name, root in self.import_roots.items()}

    @property
    def is_open(self) -> bool:
        """Whether whoever reaches the service is its one person."""
        return self.auth == "local" and self.local_token is None

    @property
    def is_https(self) -> bool:
        """Whether people reach the service through TLS."""
        return self.address.startswith("https://")

    @property
    def address(self) -> str:
        """Where people reach the service; ends in a slash."""
        return self.public_url or f"http://{self.host}:{self.port}/"

    @property
    def origins(self) -> tuple[str, ...]:
        """What a browser says of our own pages."""
        parts = urlsplit(self.address)
        return (f"{parts.scheme}://{parts.netloc}",)

    @property
    def signing_key(self) -> bytes:
        """What we sign with. On one machine without a SECRET, the database's password is as good."""
        secret = self.secret.get_secret_value() if self.secret else self.database_url
        return hashlib.sha256(b"dropflow:" + secret.encode()).digest()


def with_driver(url: str) -> str:
    """A Postgres URL as SQLAlchemy wants it; anything else is refused."""
    try:
        parsed = make_url(url)
    except ArgumentError:
        raise ValueError("must be a URL such as postgresql://user:password@127.0.0.1:5432/dropflow") from None
    if parsed.get_backend_name() not in {"postgresql", "postgres"}:
        raise ValueError(f"must be a postgresql:// URL, not {parsed.drivername}://")
    return parsed.set(drivername="postgresql+psycopg").render_as_string(hide_password=False)


@cache
def environment_settings() -> Settings:
    """The settings of this process."""
    return Settings()
