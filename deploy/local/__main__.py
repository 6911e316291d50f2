"""`python -m deploy.local`: everything on this machine until Ctrl-C. `make run` starts it.

It takes no arguments. Its environment says the rest: PORT (8000), DATA (folder, ./data), DATABASE_URL and REDIS_URL
(servers of your own instead of the embedded ones), DEMO (0: without the example film).
"""

import argparse
import os
import sys

from deploy.local.errors import LauncherError
from deploy.local.folder import open_folder
from deploy.local.instance import Instance
from deploy.local.options import read_options
from deploy.local.signals import StopRequested, stop_on_signals


def main() -> int:
    """Run; 0 after an orderly stop, 2 where nothing could be started, 1 where something broke."""
    argparse.ArgumentParser(prog="python -m deploy.local", description=__doc__).parse_args()
    try:
        options = read_options(os.environ)
        with stop_on_signals(), open_folder(options) as folder, Instance(options, folder, say) as instance:
            instance.start()
            print(f"Dropflow is ready: {instance.link}", flush=True)  # noqa: T201 - this is the product
            instance.watch()
    except StopRequested:
        return 0
    except LauncherError as problem:
        say(str(problem))
        return problem.exit_code
    return 0


def say(message: str) -> None:
    """Tell the person who started us; standard output has the link alone."""
    print(f"Dropflow: {message}", file=sys.stderr, flush=True)  # noqa: T201 - said to a person, not logged


if __name__ == "__main__":
    sys.exit(main())
