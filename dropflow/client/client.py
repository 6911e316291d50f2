"""The way in: `Client()` with the server of `dropflow login`."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self
from uuid import UUID

from dropflow.client.configuration import Server, find_server
from dropflow.client.connection import Connection
from dropflow.client.documents import Group
from dropflow.client.errors import ServerProblem
from dropflow.client.experiments import Experiment, Experiments, already_there
from dropflow.client.films import film_files, import_key, submission_key
from dropflow.client.runs import Run, Runs
from dropflow.client.versions import ApiVersion, Capability
from dropflow.experiment import load_experiment
from dropflow.progress import Progress, silent


class Client:
    """Talks to one Dropflow server.

    Parameters
    ----------
    url, token
        Server and token; what is left out is taken from DROPFLOW_SERVER and DROPFLOW_TOKEN, else from what
        `dropflow login` wrote down.

    Raises
    ------
    NotConfigured, NotReachable, WrongVersion, ServerProblem
        See `dropflow.client.errors`.

    Examples
    --------
    >>> client = Client()                                                           # doctest: +SKIP
    >>> run = client.submit("frames/", "experiment.yaml").wait()                    # doctest: +SKIP
    >>> run.trajectories()["r_um"].mean()                                           # doctest: +SKIP
    """

    def __init__(self, url: str | None = None, token: str | None = None) -> None:
        self.server: Server = find_server(url, token)
        self._connection = Connection(self.server)
        with ExitStack() as opened:
            opened.callback(self._connection.close)
            self.version: ApiVersion = self._connection.version
            scratch = tempfile.TemporaryDirectory(prefix="dropflow-", ignore_cleanup_errors=True)
            self._scratch = Path(opened.enter_context(scratch))
            """Where tables are kept that were asked for as objects, as long as this client lives."""
            self._opened = opened.pop_all()
        self.experiments = Experiments(self._connection, self._scratch)
        self.runs = Runs(self._connection, self._scratch)

    def __repr__(self) -> str:
        return f"Client({self.server.url!r}, API {self.version})"

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the server, and of the tables that were brought here."""
        self._opened.close()

    def groups(self) -> list[Group]:
        """The groups of this person."""
        return [Group.model_validate(found) for found in self._connection.get("groups")["items"]]

    def film(
        self,
        stack: Path | str,
        description: Path | str,
        *,
        group_id: UUID | str | None = None,
        is_again: bool = False,
        progress: Progress = silent,
    ) -> Experiment:
        """The experiment of a film, made and its frames sent as far as that is not done yet.

        The same film, described in the same way, is the same experiment (for 30 days): a second call goes on where the
        first was cut, and makes no double. `is_again` makes another one.
        """
        stack, description = Path(stack), Path(description)
        document = load_experiment(description)
        files = film_files(stack, document, description.parent)
        group = None if group_id is None else str(group_id)
        if not is_again and not self._connection.can(Capability.IDEMPOTENCY):
            # A server of the first version forgets who has asked: look for what an earlier try has made.
            experiment = already_there(self.experiments.list(), document, files, group)
        else:
            experiment = None
        if experiment is None:
            name = submission_key(document.model_dump(mode="json"), files, group)
            experiment = self._create(description, group_id, name, is_again=is_again)
        experiment.send(files, progress=progress)
        return experiment.wait_ready(progress=progress)

    def film_on_server(
        self,
        root: str,
        path: str,
        description: Path | str,
        *,
        by_reference: bool = False,
        group_id: UUID | str | None = None,
        is_again: bool = False,
        progress: Progress = silent,
    ) -> Experiment:
        """As `film`, of frames that the server takes itself from `path` below one of its import roots."""
        description = Path(description)
        document = load_experiment(description).model_dump(mode="json")
        name = import_key(document, root, path, None if group_id is None else str(group_id))
        experiment = self._create(description, group_id, name, is_again=is_again)
        return experiment.import_from(root, path, by_reference=by_reference, progress=progress)

    def submit(
        self,
        stack: Path | str,
        description: Path | str,
        *,
        parameters: Mapping[str, Any] | None = None,
        group_id: UUID | str | None = None,
        is_again: bool = False,
        progress: Progress = silent,
    ) -> Run:
        """From a folder to a run: `film`, and the run of it with these parameters, unless that is there already."""
        experiment = self.film(stack, description, group_id=group_id, is_again=is_again, progress=progress)
        return experiment.start_once(parameters)

    def _create(self, description: Path, group_id: UUID | str | None, name: str, *, is_again: bool) -> Experiment:
        """The first attempt whose experiment was not deleted; with `is_again` the first that makes a new one."""
        for attempt in range(1000):
            try:
                experiment = self.experiments.create(description, group_id=group_id, key=f"{name}-{attempt}")
            except ServerProblem as problem:
                if problem.code != "idempotency.deleted":
                    raise
                continue
            if experiment.is_new or not is_again:
                return experiment
        raise AssertionError("a thousand experiments of the same film")
