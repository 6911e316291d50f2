"""Runs: wait for them, and have their results as polars, xarray and Plotly objects."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import UUID

from dropflow.client.connection import Connection
from dropflow.client.documents import ResultFile, RunDocument
from dropflow.client.downloads import download, unpack
from dropflow.client.errors import ClientError, WentWrong
from dropflow.client.versions import Capability
from dropflow.client.waiting import follow
from dropflow.progress import Progress, silent

if TYPE_CHECKING:
    import plotly.graph_objects as go
    import polars as pl
    import xarray as xr

FLOW = "flow.zarr"


class Run:
    """One analysis on the server. `state` is what was last seen of it; `refresh` looks again."""

    def __init__(self, connection: Connection, document: RunDocument, scratch: Path, *, is_new: bool = False) -> None:
        self._connection, self._scratch = connection, scratch / str(document.id)
        self.document = document
        self.is_new = is_new
        """Whether the call that gave this object made the run."""

    def __repr__(self) -> str:
        return f"Run({self.id}, number={self.document.number}, state={self.state!r})"

    @property
    def id(self) -> UUID:
        """By which it is found again."""
        return self.document.id

    @property
    def state(self) -> str:
        """`queued`, `running`, `completed`, `failed` or `cancelled`."""
        return self.document.state

    @property
    def summary(self) -> dict[str, Any] | None:
        """The numbers of the run, once it is completed."""
        return self.document.summary

    @property
    def url(self) -> str:
        """Its page."""
        return f"{self._connection.server.url}runs/{self.id}"

    def refresh(self) -> Run:
        """Look again how far it is."""
        self.document = RunDocument.model_validate(self._connection.get(self._path))
        return self

    def follow(self, *, timeout_s: float | None = None) -> Iterator[RunDocument]:
        """What is seen of it now and after each change, until it is over."""
        for seen in follow(
            self._connection,
            self._path,
            RunDocument.model_validate,
            lambda run: run.is_over,
            timeout_s=timeout_s,
        ):
            self.document = seen
            yield seen

    def wait(self, *, progress: Progress = silent, timeout_s: float | None = None) -> Run:
        """Wait until it is completed; raise `WentWrong` if it fails or is cancelled."""
        for seen in self.follow(timeout_s=timeout_s):
            for stage in seen.stages:
                if stage.state != "waiting":
                    progress(stage.name, stage.done_frames, stage.total_frames)
        self._check_completed()
        return self

    def cancel(self) -> Run:
        """Ask it to stop."""
        answer = self._connection.request("POST", f"{self._path}/cancel")
        self.document = RunDocument.model_validate(answer.json())
        return self

    def delete(self) -> None:
        """Remove it with its results; it must have ended."""
        self._connection.request("DELETE", self._path)

    def files(self) -> list[ResultFile]:
        """What there is to download so far."""
        found = self._connection.get(f"{self._path}/files")["items"]
        return [ResultFile.model_validate(file) for file in found]

    def download(self, name: str, target: Path, *, progress: Progress = silent) -> Path:
        """Bring one file to `target`, going on where an earlier try was cut, and check it."""
        file = next((file for file in self.files() if file.name == name), None)
        if file is None:
            self._check_completed()
            raise ClientError("The run has no such file.", code="results.missing", file=name)
        return download(self._connection, f"{self._path}/files/{name}", file, Path(target), progress=progress)

    def fetch(self, folder: Path, *, progress: Progress = silent) -> Path:
        """Bring all results to `folder`, in the form in which `dropflow analyse` leaves them."""
        self._check_completed()
        folder = Path(folder)
        for file in self.files():
            target = self.download(file.name, folder / file.name, progress=progress)
            if file.name == f"{FLOW}.zip":
                unpack(target, folder)
                target.unlink()
        return folder

    def droplets(self) -> pl.DataFrame:
        """All detections."""
        return self._table("droplets.parquet")

    def trajectories(self) -> pl.DataFrame:
        """The droplets of all trajectories, with their velocities."""
        return self._table("trajectories.parquet")

    def rejected_trajectories(self) -> pl.DataFrame:
        """Trajectories that were taken out, and why."""
        return self._table("rejected_trajectories.parquet")

    def events(self) -> pl.DataFrame:
        """Where trajectories begin and end and why, and which two droplets became one; what happens while the run
        goes on is told by `follow`.
        """
        return self._table("events.parquet")

    def flow(self) -> xr.Dataset:
        """The flow field with its axes and units."""
        import xarray as xr

        folder = self._scratch / FLOW
        if not folder.exists():
            unpack(self._scratched(f"{FLOW}.zip"), self._scratch)
        return xr.open_zarr(folder, consolidated=False, chunks=None)  # type: ignore[no-any-return]

    def figure(self, name: str, **parameters: Any) -> go.Figure:
        """A figure of the run; the names are those of `GET /runs/{id}/figures/{name}`, such as `moments`."""
        import plotly.graph_objects as go

        return go.Figure(self._connection.get(f"{self._path}/figures/{name}", **parameters))

    @property
    def _path(self) -> str:
        return f"runs/{self.id}"

    def _table(self, name: str) -> pl.DataFrame:
        import polars as pl

        return pl.read_parquet(self._scratched(name))

    def _scratched(self, name: str) -> Path:
        return self.download(name, self._scratch / name)

    def _check_completed(self) -> None:
        if not self.document.is_over:
            self.refresh()
        if self.state in ("failed", "cancelled"):
            problem = self.document.problem
            raise WentWrong(
                f"The run {self.state if self.state == 'failed' else 'was cancelled'}"
                + (f": {problem.detail}" if problem else "."),
                code=problem.code if problem else None,
                file=problem.file if problem else None,
                frame=problem.frame if problem else None,
                hint=problem.hint if problem else None,
            )
        if self.state != "completed":
            raise WentWrong(f"The run is {self.state}.", code="client.not_yet", hint="Wait for its end first.")


class Runs:
    """The runs of a server that this person may see."""

    def __init__(self, connection: Connection, scratch: Path) -> None:
        self._connection, self._scratch = connection, scratch

    def get(self, run_id: UUID | str) -> Run:
        """One run."""
        found = self._connection.get(f"runs/{_checked(run_id)}")
        return Run(self._connection, RunDocument.model_validate(found), self._scratch)

    def list(self, *, experiment_id: UUID | None = None, state: str | None = None) -> Iterator[Run]:
        """Runs of all experiments or of one, the newest first."""
        if experiment_id is None:
            self._connection.needs(Capability.ALL_RUNS)
        if state is not None:
            self._connection.needs(Capability.LIST_FILTERS)
        path = "runs" if experiment_id is None else f"experiments/{experiment_id}/runs"
        for found in self._connection.pages(path, state=state):
            yield Run(self._connection, RunDocument.model_validate(found), self._scratch)


def _checked(given: UUID | str) -> UUID:
    """An id, or the end of the address of a page."""
    try:
        return given if isinstance(given, UUID) else UUID(given.rstrip("/").rpartition("/")[2])
    except ValueError:
        raise ClientError(f"{given} is no id of a run.", code="client.no_id") from None
