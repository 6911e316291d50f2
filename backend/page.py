"""The built page: everything that is not the API. Its own addresses (/runs/...) all answer index.html."""

from pathlib import Path

from fastapi import FastAPI, HTTPException, Request
from fastapi.responses import FileResponse, HTMLResponse, Response

from backend.platform.methods import allowed_methods

NOT_BUILT = """<!doctype html><html lang="en"><title>Dropflow</title><h1>The page is not built yet</h1>
<p>Run <code>make setup</code> in the checkout and load this again.
The API works: <a href="/api/v1/openapi.json">/api/v1/openapi.json</a> describes it.
</html>"""
_HEADERS = {
    "Content-Security-Policy": "object-src 'none'; base-uri 'self'; frame-ancestors 'none'",
    "Referrer-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
}
_FOR_EVER = "public, max-age=31536000, immutable"
_BASE = '<base href="/">'


def install(app: FastAPI, dist: Path) -> None:
    """Serve what was built into `dist`; it may be built (again) while the service runs."""

    @app.api_route("/{path:path}", methods=["GET", "HEAD"], include_in_schema=False)
    def page(request: Request, path: str) -> Response:
        if path == "api" or path.startswith("api/"):
            # A call that there is, asked for by a method that it has not, comes here as the last that matches.
            raise HTTPException(405 if allowed_methods(app.openapi(), request.url.path) else 404)
        file = _file(dist, path)
        if file is not None:
            keep = _FOR_EVER if path.startswith("assets/") else "no-cache"
            return FileResponse(file, headers={**_HEADERS, "Cache-Control": keep})
        if path.startswith("assets/"):
            raise HTTPException(404)
        index = _file(dist, "index.html")
        if index is None:
            return HTMLResponse(NOT_BUILT, 503, headers=_HEADERS)
        prefix = request.scope.get("root_path", "").rstrip("/")
        content = index.read_text(encoding="utf-8").replace(_BASE, f'<base href="{prefix}/">', 1)
        return HTMLResponse(content, headers={**_HEADERS, "Cache-Control": "no-cache"})


def _file(dist: Path, path: str) -> Path | None:
    """The file of the build that `path` names, never one outside of it."""
    if not path or "\0" in path:
        return None
    try:
        file = (dist / path).resolve()
        return file if file.is_relative_to(dist.resolve()) and file.is_file() else None
    except (OSError, ValueError):
        return None
