"""The server that takes e-mail for others."""

from email.utils import parseaddr
from typing import Annotated, Literal, Self

from pydantic import Field, SecretStr, model_validator

from backend.platform.loopback import is_loopback
from backend.platform.settings_base import EnvironmentSettings

LAST_PORT = 65535


class MailSettings(EnvironmentSettings):
    """How e-mail leaves."""

    smtp_host: str | None = None
    """The server that takes e-mail for others; without one, none is sent."""
    smtp_port: Annotated[int, Field(ge=1, le=LAST_PORT)] = 587
    """Its port."""
    smtp_security: Literal["starttls", "tls", "none"] = "starttls"
    """How the way to it is kept secret; `none` for a server on this machine."""
    smtp_user: str | None = None
    """As whom to sign in there."""
    smtp_password: SecretStr | None = None
    """With what."""
    mail_from: str | None = None
    """The sender of e-mail, such as `Dropflow <droplets@example.org>`. SMTP_HOST needs it."""

    @model_validator(mode="after")
    def _mail_is_whole(self) -> Self:
        if self.smtp_host is None:
            return self
        _, address = parseaddr(self.mail_from or "")
        if "@" not in address or not (self.mail_from or "").isprintable():
            raise ValueError("SMTP_HOST needs MAIL_FROM, such as Dropflow <droplets@example.org>")
        if self.smtp_user is not None:
            if self.smtp_password is None:
                raise ValueError("SMTP_USER needs SMTP_PASSWORD")
            if self.smtp_security == "none" and not is_loopback(self.smtp_host):
                raise ValueError("SMTP_PASSWORD would go unencrypted: set SMTP_SECURITY to starttls or tls")
        return self
