"""Sign-in at a provider (OpenID Connect, code flow with PKCE): where the browser is sent, and what it brings back.

What must be remembered in between (state, nonce, verifier, where to go on) is a cookie that we sign: the browser that
comes back is the one that was sent, and nobody can have put it together.
"""

import base64
import hashlib
import hmac
import json
import time
from dataclasses import asdict, dataclass
from http import HTTPStatus
from typing import Any
from urllib.parse import urlencode

import httpx
import structlog
from authlib.common.errors import AuthlibBaseError
from authlib.common.security import generate_token
from authlib.oauth2.rfc7636 import create_s256_code_challenge
from authlib.oidc.core import CodeIDToken
from joserfc import jwt
from joserfc.errors import JoseError
from joserfc.jwk import KeySet

from backend.platform.problems import ServiceError
from backend.platform.settings import Settings

COOKIE = "dropflow_oidc"
LASTS_S = 600
_LEEWAY_S = 60
_TIMEOUT_S = 10.0
_ALGORITHMS = ["RS256", "PS256", "ES256", "EdDSA", "Ed25519"]
"""Asymmetric ones only: with the others whoever knows our secret could make tokens, and `none` is nobody's."""
Json = dict[str, Any]
log = structlog.get_logger()


class ProviderRefused(ServiceError):
    """What came back from the provider proves nothing."""

    default_code = "session.oidc"
    status = HTTPStatus.UNAUTHORIZED


class ProviderAway(ServiceError):
    """The provider does not answer."""

    default_code = "service.oidc_away"
    status = HTTPStatus.SERVICE_UNAVAILABLE


@dataclass(frozen=True)
class Attempt:
    """One browser on its way to the provider and back."""

    state: str
    nonce: str
    verifier: str
    go_on: str
    until_s: float


def begin(settings: Settings, go_on: str) -> tuple[str, str]:
    """Where to send the browser, and the cookie that it takes along."""
    attempt = Attempt(generate_token(32), generate_token(32), generate_token(64), go_on, time.time() + LASTS_S)
    asked = {
        "response_type": "code",
        "client_id": settings.oidc_client_id,
        "redirect_uri": _callback(settings),
        "scope": settings.oidc_scope,
        "state": attempt.state,
        "nonce": attempt.nonce,
        "code_challenge": create_s256_code_challenge(attempt.verifier),
        "code_challenge_method": "S256",
    }
    address = str(_metadata(settings)["authorization_endpoint"])
    return f"{address}{'&' if '?' in address else '?'}{urlencode(asked)}", _signed(settings, attempt)


def finish(settings: Settings, cookie: str | None, state: str | None, code: str | None) -> tuple[Json, str]:
    """The claims of who came back, and where they go on."""
    attempt = _attempt(settings, cookie)
    if attempt is None or state is None or not hmac.compare_digest(attempt.state.encode(), state.encode()):
        raise ProviderRefused("This sign-in was not begun in this browser, or took too long.", hint="Begin it again.")
    if not code:
        raise ProviderRefused("The provider let nobody in.", hint="Try again, or ask whoever looks after the server.")
    metadata = _metadata(settings)
    given = {
        "grant_type": "authorization_code",
        "code": code,
        "redirect_uri": _callback(settings),
        "code_verifier": attempt.verifier,
    }
    secret = settings.oidc_client_secret.get_secret_value() if settings.oidc_client_secret else ""
    tokens = _asked("POST", metadata["token_endpoint"], data=given, auth=(settings.oidc_client_id or "", secret))
    return _claims(settings, metadata, tokens, attempt.nonce), attempt.go_on


def _claims(settings: Settings, metadata: Json, tokens: Json, nonce: str) -> Json:
    keys = KeySet.import_key_set(_asked("GET", metadata["jwks_uri"]))  # type: ignore[arg-type]
    expected = {
        "iss": {"essential": True, "value": settings.oidc_issuer},
        "aud": {"essential": True, "value": settings.oidc_client_id},
    }
    try:
        token = jwt.decode(str(tokens.get("id_token", "")), keys, algorithms=_ALGORITHMS)
        about = {"nonce": nonce, "client_id": settings.oidc_client_id}
        claims = CodeIDToken(token.claims, token.header, expected, about)
        claims.validate(leeway=_LEEWAY_S)
    except (JoseError, AuthlibBaseError, ValueError) as problem:
        log.warning("identity refused", reason=str(problem))
        raise ProviderRefused("What the provider said of you could not be verified.") from None
    found = dict(claims)
    if "userinfo_endpoint" in metadata and "access_token" in tokens:
        bearer = {"Authorization": f"Bearer {tokens['access_token']}"}
        more = _asked("GET", metadata["userinfo_endpoint"], headers=bearer)
        if more.get("sub") == found["sub"]:
            found = more | found
    return found


def _metadata(settings: Settings) -> Json:
    issuer = str(settings.oidc_issuer)
    found = _asked("GET", issuer.rstrip("/") + "/.well-known/openid-configuration")
    if found.get("issuer") != issuer:
        raise ProviderRefused("The provider says that it is another one than OIDC_ISSUER.")
    return found


def _asked(method: str, url: str, **about: Any) -> Json:
    try:
        answer = httpx.request(method, url, timeout=_TIMEOUT_S, follow_redirects=False, **about)
        if answer.is_client_error:
            raise ProviderRefused("The provider did not accept this sign-in.", hint="Begin it again.")
        return dict(answer.raise_for_status().json())
    except (httpx.HTTPError, ValueError) as problem:
        log.error("provider away", url=url, reason=str(problem))
        raise ProviderAway("The provider of sign-ins cannot be reached just now.", hint="Try again later.") from None


def _callback(settings: Settings) -> str:
    return f"{settings.address}api/v1/session/oidc/callback"


def _signed(settings: Settings, attempt: Attempt) -> str:
    content = base64.urlsafe_b64encode(json.dumps(asdict(attempt)).encode()).decode()
    return f"{content}.{_signature(settings, content)}"


def _attempt(settings: Settings, cookie: str | None) -> Attempt | None:
    content, _, signature = (cookie or "").partition(".")
    if not hmac.compare_digest(_signature(settings, content).encode(), signature.encode()):
        return None
    attempt = Attempt(**json.loads(base64.urlsafe_b64decode(content)))
    return attempt if attempt.until_s > time.time() else None


def _signature(settings: Settings, content: str) -> str:
    return hmac.new(settings.signing_key, b"oidc:" + content.encode(), hashlib.sha256).hexdigest()
