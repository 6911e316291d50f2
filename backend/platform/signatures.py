"""How webhooks are signed: as standardwebhooks.com says, so that receivers have a library for it."""

import base64
import hashlib
import hmac
import secrets

from backend.platform.settings import Settings

_KIND = "whsec_"


def new_salt() -> str:
    """What makes the secret of one webhook another than that of every other."""
    return secrets.token_hex(32)


def secret_of(settings: Settings, salt: str) -> str:
    """The secret of a webhook. It is made anew whenever it is needed: the database does not hold it.

    A service of one machine that has no SECRET makes it from the salt alone.
    """
    own = settings.secret.get_secret_value() if settings.secret else ""
    key = hmac.new(b"dropflow webhook:" + own.encode(), salt.encode(), hashlib.sha256).digest()
    return _KIND + base64.b64encode(key).decode()


def signed(secret: str, notice_id: str, timestamp_s: int, body: bytes) -> dict[str, str]:
    """The headers that prove who sent `body`, and when."""
    key = base64.b64decode(secret.removeprefix(_KIND))
    content = f"{notice_id}.{timestamp_s}.".encode() + body
    signature = base64.b64encode(hmac.new(key, content, hashlib.sha256).digest()).decode()
    return {
        "webhook-id": notice_id,
        "webhook-timestamp": str(timestamp_s),
        "webhook-signature": f"v1,{signature}",
    }
