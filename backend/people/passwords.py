"""Passwords are kept as argon2 hashes only, which are dear to make: few at a time, so that a flood fills no memory."""

import threading

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

_HASHER = PasswordHasher()  # the library's choice of costs follows RFC 9106
_AT_ONCE = threading.BoundedSemaphore(2)
_NOBODYS = ""


def hash_password(password: str) -> str:
    """What of a password is kept."""
    with _AT_ONCE:
        return _HASHER.hash(password)


def is_right(password_hash: str | None, password: str) -> bool:
    """Whether this is the password. For who has none it takes as long, so that nobody learns who has an account."""
    with _AT_ONCE:
        try:
            _HASHER.verify(password_hash or _hash_of_nobody(), password)
        except (VerificationError, InvalidHashError):
            return False
    return password_hash is not None


def is_outdated(password_hash: str) -> bool:
    """Whether it was made with lower costs than are asked today."""
    return _HASHER.check_needs_rehash(password_hash)


def _hash_of_nobody() -> str:
    global _NOBODYS  # noqa: PLW0603 - made once, and only where somebody signs in with a password
    _NOBODYS = _NOBODYS or _HASHER.hash("nobody")
    return _NOBODYS
