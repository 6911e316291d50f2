"""`dropflow login`: which server, and with which token."""

import os
import sys
from typing import Annotated

import typer

from dropflow.client.configuration import LOCAL, Server, checked_url, forget, remember
from dropflow.client.connection import Connection
from dropflow.client.errors import ServerProblem


def login(
    server: Annotated[str, typer.Argument(metavar="SERVER", help="Address of the server.")] = LOCAL,
    is_out: Annotated[bool, typer.Option("--out", help="Forget the server and its token.")] = False,
) -> None:
    """Remember a server for the other commands, with a token where it asks for one.

    The token is asked for without being shown, or read from standard input or DROPFLOW_TOKEN; it is kept in a file
    that only you can read. Make one of the scope `submit` on your account page.

    Example: `dropflow login https://dropflow.lab.example/`
    """
    url = checked_url(server)
    if is_out:
        typer.echo(f"{url} is forgotten." if forget(url) else f"{url} was not known.")
        return
    token = os.environ.get("DROPFLOW_TOKEN")
    if token is None and not _lets_in(Server(url)):
        token = _asked_token(url)
    if token is not None and not (token and _lets_in(Server(url, token))):
        message = (
            "The server does not know this token." if token else "The server asks for a token, and none was given."
        )
        hint = f"Make one at {url}account; a service on this machine has one in its data folder (< data/token)."
        raise ServerProblem(message, status=401, code="client.wrong_token", hint=hint)
    path = remember(Server(url, token))
    typer.echo(f"{url} is remembered in {path}.")


def _lets_in(server: Server) -> bool:
    connection = Connection(server, n_tries=2)
    try:
        _ = connection.version
        connection.get("experiments", limit=1)
    except ServerProblem as problem:
        if problem.status != 401:
            raise
        return False
    finally:
        connection.close()
    return True


def _asked_token(url: str) -> str:
    if sys.stdin.isatty():
        return str(typer.prompt(f"Token (make one at {url}account)", hide_input=True)).strip()
    return sys.stdin.readline().strip()
