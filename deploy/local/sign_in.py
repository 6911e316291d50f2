"""`python -m deploy.local.sign_in`: one more link to sign in with, for another browser. `make sign-in` runs it."""

import http.client
import json
import os
import sys
from contextlib import closing

from deploy.local.errors import LauncherError
from deploy.local.folder import InstanceFolder
from deploy.local.options import HOST, Options, read_options

LOCAL_PERSON = "00000000-0000-4000-8000-000000000001"


def new_link(options: Options) -> str:
    """Ask the instance that runs here for a link."""
    token = InstanceFolder(options.data).token
    if not token.exists():
        raise LauncherError(f"no instance was started on {options.data} yet. Start one: make run", exit_code=2)
    with closing(http.client.HTTPConnection(HOST, options.port, timeout=10)) as connection:
        try:
            headers = {"Authorization": f"Bearer {token.read_text().strip()}"}
            connection.request("POST", f"/api/v1/people/{LOCAL_PERSON}/link", headers=headers)
            answer = connection.getresponse()
            content = answer.read()
        except (OSError, http.client.HTTPException):
            raise LauncherError(f"nothing answers at {options.address}. Start it: make run") from None
    if answer.status != http.client.CREATED:
        raise LauncherError(f"what runs at {options.address} was started on another folder than {options.data}.")
    return str(json.loads(content)["link"])


def main() -> int:
    """Print it."""
    try:
        print(new_link(read_options(os.environ)))  # noqa: T201 - this is what it is for
    except LauncherError as problem:
        print(f"Dropflow: {problem}", file=sys.stderr)  # noqa: T201 - said to a person
        return problem.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
