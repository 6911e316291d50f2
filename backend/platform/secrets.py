"""Secrets that are shown once: made long enough that a plain hash cannot be guessed, and looked up by that hash."""

import hashlib
import secrets

_N_BYTES = 32


def new_secret(kind: str = "") -> str:
    """A secret of 256 bits; `kind` begins it, so that people (and scanners of code) know what they look at."""
    return kind + secrets.token_urlsafe(_N_BYTES)


def hashed(secret: str) -> str:
    """What of a secret is kept."""
    return hashlib.sha256(secret.encode()).hexdigest()
