"""Which server, and with which token: given, in the environment, or in a file that only this person can read."""

import os
import sys
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

import yaml

from dropflow.client.errors import NotConfigured

LOCAL = "http://127.0.0.1:8000/"


@dataclass(frozen=True)
class Server:
    """A server, and the token that says who asks. A service on one machine (`make run`) needs none."""

    url: str
    token: str | None = None

    def __repr__(self) -> str:
        return f"Server({self.url!r}, token={'...' if self.token else None})"


def find_server(url: str | None = None, token: str | None = None) -> Server:
    """What is given, else DROPFLOW_SERVER and DROPFLOW_TOKEN, else what `dropflow login` wrote."""
    known = _known()
    address = url or os.environ.get("DROPFLOW_SERVER") or next(iter(known), None)
    if address is None:
        raise NotConfigured(
            "No server is known.",
            hint=f"Run `dropflow login SERVER` (on this machine: `dropflow login {LOCAL}`), or set DROPFLOW_SERVER.",
        )
    address = checked_url(address)
    return Server(address, token or os.environ.get("DROPFLOW_TOKEN") or known.get(address))


def remember(server: Server) -> Path:
    """Write a server down as the first of those that are known; the file is for this person alone."""
    others = {url: token for url, token in _known().items() if url != server.url}
    entries = [{"url": url, "token": token} for url, token in {server.url: server.token, **others}.items()]
    path = configuration_file()
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    unfinished = path.with_suffix(".new")
    unfinished.unlink(missing_ok=True)
    # Made with these rights, not given them afterwards: nobody reads it in between.
    with os.fdopen(os.open(unfinished, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as file:
        yaml.safe_dump({"servers": entries}, file, sort_keys=False)
    unfinished.replace(path)
    return path


def forget(url: str) -> bool:
    """Take a server off the list; whether it was there."""
    known = _known()
    if checked_url(url) not in known:
        return False
    path = configuration_file()
    entries = [{"url": other, "token": token} for other, token in known.items() if other != checked_url(url)]
    path.write_text(yaml.safe_dump({"servers": entries}, sort_keys=False), encoding="utf-8")
    return True


def configuration_file() -> Path:
    """Where servers and tokens are kept, as is usual on each system; DROPFLOW_CONFIG names another file."""
    if given := os.environ.get("DROPFLOW_CONFIG"):
        return Path(given)
    if sys.platform == "win32":
        base = Path(os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        base = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    return base / "dropflow" / "servers.yaml"


def checked_url(url: str) -> str:
    """The address of a server, ending in a slash; the page's or the API's own address will do."""
    try:
        parts = urlsplit(url if "://" in url else f"http://{url}")
        is_address = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        is_address = False
    if not is_address or parts.username or parts.query or parts.fragment:
        raise NotConfigured(f"{url} is no address of a server.", hint="Give one such as https://dropflow.lab.example/.")
    path = parts.path.rstrip("/").removesuffix("/api/v1")
    return f"{parts.scheme}://{parts.netloc}{path}/"


def _known() -> dict[str, str | None]:
    path = configuration_file()
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
        return {str(entry["url"]): entry.get("token") for entry in content["servers"]}
    except FileNotFoundError:
        return {}
    except OSError as problem:
        raise NotConfigured(f"The file cannot be read ({problem.strerror}).", file=str(path)) from None
    except (yaml.YAMLError, TypeError, KeyError, AttributeError, UnicodeDecodeError):
        raise NotConfigured(
            "This is no list of servers.", file=str(path), hint="Remove it and run `dropflow login`."
        ) from None
