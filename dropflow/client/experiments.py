"""Experiments: describe what was filmed, send its frames, start runs."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from uuid import UUID

from dropflow.client.connection import Connection
from dropflow.client.documents import ExperimentDocument, RunDocument, UploadedFile
from dropflow.client.errors import ServerProblem, WentWrong
from dropflow.client.films import NAMED, FilmFile, film_files
from dropflow.client.runs import Run, Runs
from dropflow.client.uploads import send_files
from dropflow.client.versions import Capability
from dropflow.client.waiting import follow
from dropflow.experiment import Experiment as Document
from dropflow.experiment import load_experiment, parse_experiment
from dropflow.parameters import parse_parameters
from dropflow.progress import Progress, silent

INDEX, IMPORT = "index", "import"


class Experiment:
    """One experiment on the server. `document` is what was last seen of it; `refresh` looks again."""

    def __init__(
        self, connection: Connection, document: ExperimentDocument, scratch: Path, *, is_new: bool = False
    ) -> None:
        self._connection, self._scratch = connection, scratch
        self.document = document
        self.is_new = is_new
        """Whether the call that gave this object made the experiment."""

    def __repr__(self) -> str:
        return f"Experiment({self.id}, name={self.name!r}, frames={self.document.stack.state!r})"

    @property
    def id(self) -> UUID:
        """By which it is found again."""
        return self.document.id

    @property
    def name(self) -> str:
        """What people call it."""
        return str(self.document.experiment["name"])

    @property
    def url(self) -> str:
        """Its page."""
        return f"{self._connection.server.url}experiments/{self.id}"

    def refresh(self) -> Experiment:
        """Look again."""
        self.document = ExperimentDocument.model_validate(self._connection.get(self._path))
        return self

    def change(self, description: Mapping[str, Any]) -> Experiment:
        """Replace the description; raise `ServerProblem` 412 if somebody else changed it after it was last seen."""
        seen = self._connection.request("GET", self._path)
        now = ExperimentDocument.model_validate(seen.json())
        if now.experiment != self.document.experiment:
            raise ServerProblem(
                "It was changed by somebody else.",
                status=412,
                code="conflict.changed_meanwhile",
                hint="Call refresh().",
            )
        headers = {"If-Match": seen.headers["ETag"]} if "ETag" in seen.headers else {}
        body = {"experiment": dict(description)}
        answer = self._connection.request("PATCH", self._path, json=body, headers=headers)
        self.document = ExperimentDocument.model_validate(answer.json())
        return self

    def delete(self) -> None:
        """Put it into the trash, with its frames, runs and results."""
        self._connection.request("DELETE", self._path)

    def files(self) -> list[UploadedFile]:
        """The files that are on the server."""
        return [UploadedFile.model_validate(file) for file in self._connection.pages(f"{self._path}/files")]

    def upload(self, stack: Path, *, beside: Path | None = None, progress: Progress = silent) -> Experiment:
        """Send the frames, and the files that the description names, looked up in `beside` (else beside the stack).

        What is there already is not sent again, so that this goes on where an earlier try was cut. Then the server
        reads every frame: `wait_ready`.
        """
        stack = Path(stack)
        described = parse_experiment(self.document.experiment)
        return self.send(film_files(stack, described, beside or stack.parent), progress=progress)

    def send(self, files: list[FilmFile], *, progress: Progress = silent) -> Experiment:
        """Send files, and say that all are there."""
        if self.refresh().document.stack.state in ("empty", "uploading", "rejected"):
            send_files(self._connection, self.id, files, progress)
            self._seal()
        return self.refresh()

    def import_from(
        self, root: str, path: str = "", *, by_reference: bool = False, progress: Progress = silent
    ) -> Experiment:
        """Have the server take the frames from `path` below one of its import roots, and wait until all were read.

        With `by_reference` they stay where they are and must not change as long as runs need them. Called again after
        a kill, it goes on waiting.
        """
        self._connection.needs(Capability.IMPORTS)
        if self.refresh().document.stack.state in ("empty", "uploading", "rejected"):
            mode = "reference" if by_reference else "copy"
            body = {"root": root, "path": path, "mode": mode}
            self._connection.request("POST", f"{self._path}/imports", json=body)
        return self.wait_ready(progress=progress)

    def wait_ready(self, *, progress: Progress = silent, timeout_s: float | None = None) -> Experiment:
        """Wait until every frame was read; raise `WentWrong` naming the file and frame that cannot be used."""
        for seen in follow(
            self._connection,
            self._path,
            ExperimentDocument.model_validate,
            lambda seen: seen.stack.state != "indexing",
            timeout_s=timeout_s,
        ):
            self.document, stack = seen, seen.stack
            if stack.importing is not None:
                progress(IMPORT, stack.importing.done_bytes, max(stack.importing.size_bytes, 1))
                continue
            n_attached = sum(self.document.experiment.get(name) is not None for name in NAMED)
            done = (stack.n_frames if stack.state == "ready" else stack.done_frames) or 0
            progress(INDEX, done, stack.n_frames or max(stack.n_files - n_attached, done, 1))
        self._check_ready()
        return self

    def start(self, parameters: Mapping[str, Any] | None = None, *, key: str | None = None) -> Run:
        """Start a run with the parameters that differ from their defaults. With a `key`, twice is once."""
        body = {"parameters": dict(parameters or {})}
        found, is_replayed = self._connection.create(f"{self._path}/runs", body, key=key)
        return Run(self._connection, RunDocument.model_validate(found), self._scratch, is_new=not is_replayed)

    def start_once(self, parameters: Mapping[str, Any] | None = None) -> Run:
        """The run with these parameters: the one that goes on or is completed, else a new one."""
        name = json.dumps([str(self.id), dict(parameters or {})], sort_keys=True)
        if not self._connection.can(Capability.IDEMPOTENCY):
            wanted = parse_parameters(dict(parameters or {}))
            there = (run for run in self.runs() if run.state not in ("failed", "cancelled"))
            same = next((run for run in there if parse_parameters(run.document.parameters) == wanted), None)
            return same or self.start(parameters)
        for attempt in range(1000):
            key = hashlib.sha256(f"{name} {attempt}".encode()).hexdigest()
            try:
                run = self.start(parameters, key=key)
            except ServerProblem as problem:
                if problem.code not in ("idempotency.deleted", "not_found.run"):
                    raise
                continue
            if run.is_new or run.state not in ("failed", "cancelled"):
                return run
        raise AssertionError("a thousand runs with the same parameters failed")

    def runs(self) -> Iterator[Run]:
        """Its runs, the newest first."""
        return Runs(self._connection, self._scratch).list(experiment_id=self.id)

    @property
    def _path(self) -> str:
        return f"experiments/{self.id}"

    def _seal(self) -> None:
        try:
            self._connection.request("POST", f"{self._path}/stack")
        except ServerProblem as problem:
            if problem.code != "conflict.stack_closed":  # an earlier try had said it
                raise

    def _check_ready(self) -> None:
        stack = self.document.stack
        if stack.state == "ready":
            return
        if problem := stack.problem:
            raise WentWrong(
                problem.detail, code=problem.code, file=problem.file, frame=problem.frame, hint=problem.hint
            )
        raise WentWrong(f"The frames are {stack.state}.", code="client.not_yet", hint="Upload them first.")


def already_there(
    experiments: Iterable[Experiment], document: Document, files: Sequence[FilmFile], group_id: str | None
) -> Experiment | None:
    """The experiment that is described alike and has no other files than these, as far as it has any."""
    own = {file.key: file for file in files}
    for experiment in experiments:
        if parse_experiment(experiment.document.experiment) != document:
            continue
        if group_id not in (None, str(experiment.document.group.id)):
            continue
        sent = experiment.files()
        if all((file := own.get((there.role, there.name))) and file.sha256() == there.sha256 for there in sent):
            return experiment
    return None


class Experiments:
    """The experiments of a server that this person may see."""

    def __init__(self, connection: Connection, scratch: Path) -> None:
        self._connection, self._scratch = connection, scratch

    def create(
        self, description: Path | Mapping[str, Any], *, group_id: UUID | str | None = None, key: str | None = None
    ) -> Experiment:
        """Describe what was filmed, by an experiment.yaml or its content. With a `key`, twice is once."""
        document = (
            load_experiment(description) if isinstance(description, Path) else parse_experiment(dict(description))
        )
        body = {
            "experiment": document.model_dump(mode="json", exclude_none=True),
            "group_id": None if group_id is None else str(group_id),
        }
        found, is_replayed = self._connection.create("experiments", body, key=key)
        return self._made(found, is_new=not is_replayed)

    def get(self, experiment_id: UUID | str) -> Experiment:
        """One experiment."""
        return self._made(self._connection.get(f"experiments/{experiment_id}"))

    def list(self, **query: Any) -> Iterator[Experiment]:
        """Experiments, the newest first. `q`, `tag`, `sort`, ... are those of `GET /experiments`."""
        if query:
            self._connection.needs(Capability.LIST_FILTERS)
        for found in self._connection.pages("experiments", **query):
            yield self._made(found)

    def _made(self, found: Mapping[str, Any], *, is_new: bool = False) -> Experiment:
        return Experiment(self._connection, ExperimentDocument.model_validate(found), self._scratch, is_new=is_new)
