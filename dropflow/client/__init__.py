"""A Dropflow server from Python: `from dropflow.client import Client` (`pip install "dropflow[client]"`).

It knows the HTTP API and nothing else of the service.
"""

from importlib.util import find_spec

if missing := [name for name in ("httpx", "xarray") if find_spec(name) is None]:
    raise ImportError(f'{" and ".join(missing)} are missing: pip install "dropflow[client]"')

from dropflow.client.client import Client
from dropflow.client.errors import (
    ClientError,
    Damaged,
    NotConfigured,
    NotReachable,
    ServerProblem,
    WentWrong,
    WrongVersion,
)
from dropflow.client.experiments import Experiment
from dropflow.client.runs import Run
from dropflow.client.waiting import TimedOut

__all__ = [
    "Client",
    "ClientError",
    "Damaged",
    "Experiment",
    "NotConfigured",
    "NotReachable",
    "Run",
    "ServerProblem",
    "TimedOut",
    "WentWrong",
    "WrongVersion",
]
