"""What people uploaded or typed comes back as what it is: no browser guesses its type or runs it as a page of ours."""

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_SANDBOX = "sandbox allow-scripts allow-downloads allow-popups"
"""A report draws its figures by scripts, but as a page of nowhere: without our cookies, and without our API."""


class HarmlessAnswers:
    """Two headers on every answer of the API."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.setdefault("X-Content-Type-Options", "nosniff")
                if headers.get("content-type", "").startswith(("text/html", "image/svg")):
                    headers.setdefault("Content-Security-Policy", _SANDBOX)
            await send(message)

        is_api = scope["type"] == "http" and scope["path"].startswith("/api/")
        await self._app(scope, receive, sent if is_api else send)
