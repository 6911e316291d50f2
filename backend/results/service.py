"""What can be asked of results, while a run goes and after."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from uuid import UUID

from sqlalchemy.orm import Session

from backend.models import Product, Run
from backend.models.states import RunState
from backend.platform.downloads import Download
from backend.platform.entity_tags import tag_of_bytes
from backend.platform.kept import Kept
from backend.platform.object_store import ObjectStore
from backend.platform.visibility import Viewer
from backend.platform.zip_stream import part, zip_stream
from backend.results import exporting, figures, film, frames, repository
from backend.results.catalogue import checked, entries
from backend.results.errors import NoSuchResult, NoTable, NotKept, NotOfThisFilm, NotYet
from backend.results.schemas import (
    Export,
    FigureEntry,
    FigureName,
    FigureQuery,
    FrameDroplets,
    FrameFlow,
    ResultFile,
    Which,
)
from backend.runs.service import get as get_run
from dropflow.exports.kinds import MEDIA_TYPE, TITLE, Kind
from dropflow.figures.entry import Entry, Needs
from dropflow.figures.example import EXAMPLE_FILE, WORKING_PANELS
from dropflow.frames import Frame
from dropflow.statistics.condensed import Condensed
from dropflow.statistics.condensed_files import STATISTICS_FILE
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.findings import Findings

ZIPPED_FOLDER = ".zarr.zip"
REPORT_FILE = "report.html"


@dataclass(frozen=True)
class Asker:
    """Who asks for results of which run."""

    session: Session
    viewer: Viewer
    run_id: UUID

    @cached_property
    def run(self) -> Run:
        """The run, looked up once a request."""
        return get_run(self.session, self.viewer, self.run_id)

    def check(self) -> None:
        """Raise unless the viewer may see the run."""
        _ = self.run

    def product(self, task: str, frame: int | None = None) -> Product:
        """What a task made, if it has."""
        self.check()
        found = repository.product(self.session, self.viewer, self.run_id, task, frame)
        if found is None:
            raise NotYet
        return found

    @cached_property
    def done(self) -> frozenset[str]:
        """The tasks that have left something, as of this request."""
        return frozenset(repository.done(self.session, self.viewer, self.run_id))

    @cached_property
    def facts(self) -> FilmFacts:
        """What statistics must know of the film, read once a request."""
        return film.facts_of(self.run, self.shape())

    def shape(self) -> tuple[int, int]:
        """Rows and columns of the frames."""
        stack = self.run.experiment.stack
        if stack.rows is None or stack.columns is None:
            raise NotYet
        return stack.rows, stack.columns


def droplets(asker: Asker, store: ObjectStore, frame: int, which: Which) -> FrameDroplets:
    """The droplets of one frame."""
    if which is Which.DETECTED:
        return frames.detected(store, asker.product("detect", frame), frame)
    return frames.tracked(store, asker.product("track", frame), frame)


def flow(asker: Asker, store: ObjectStore, frame: int) -> FrameFlow:
    """The flow between a frame and the next."""
    return frames.flow(store, asker.product("track", frame), frame)


def catalogue(asker: Asker) -> list[FigureEntry]:
    """All figures, and which of them there are by now."""
    run = asker.run
    stack = run.experiment.stack
    facts = film.facts_of(run, (stack.rows or 1, stack.columns or 1))
    done = asker.done
    is_example_kept = "analyse" in done and _has(asker.product("analyse"), EXAMPLE_FILE)
    return entries(
        facts,
        done,
        duration_s=stack.duration_s or 0.0,
        is_example_kept=is_example_kept,
        is_ended=run.state in (RunState.FAILED, RunState.CANCELLED),
    )


def figure(asker: Asker, store: ObjectStore, kept: Kept, name: FigureName, query: FigureQuery) -> str:
    """A figure of the whole film, as Plotly JSON. Of a completed run it never changes: it is drawn once."""
    if asker.run.state != RunState.COMPLETED:
        return _drawn(asker, store, name, query)
    key = (asker.run_id, name, query.model_dump_json(exclude_none=True))
    return kept.get(key, lambda: _drawn(asker, store, name, query))


def _drawn(asker: Asker, store: ObjectStore, name: FigureName, query: FigureQuery) -> str:
    entry = checked(name, query)
    if name in WORKING_PANELS:
        facts, analysed = _facts(asker, entry), asker.product("analyse")
        if not _has(analysed, EXAMPLE_FILE):
            raise NotKept
        return figures.working_panel(entry, facts, figures.kept_example(store, analysed))
    return figures.of_film(entry, _findings(asker, store, entry, query))


def table(asker: Asker, store: ObjectStore, name: FigureName, query: FigureQuery) -> Iterator[bytes]:
    """The numbers of a figure as CSV, piece by piece."""
    entry = checked(name, query)
    if entry.drawing.table is None:
        raise NoTable(name)
    return figures.table_of(entry, _findings(asker, store, entry, query))


def looks_at(asker: Asker, name: FigureName, query: FigureQuery) -> int | None:
    """The frame that a figure is drawn on, if it is one of a frame; what it needs besides is there."""
    entry = checked(name, query)
    if entry.drawing.draw is not None or query.frame is None:
        return None
    asker.product("detect" if name in WORKING_PANELS else "track", query.frame)
    other = {"forward_tracking": 1, "backward_tracking": -1}.get(name, 0)
    return max(query.frame + other, 0)


def frame_figure(asker: Asker, store: ObjectStore, name: FigureName, query: FigureQuery, image: Frame | None) -> str:
    """A figure of one frame, as Plotly JSON."""
    entry = checked(name, query)
    facts = _facts(asker, entry)
    if name not in WORKING_PANELS:
        return figures.of_frame(entry, facts, store, asker.product("track", query.frame), query, image)
    if image is None or query.frame is None:
        raise NotYet
    prepared, detected = asker.product("prepare"), asker.product("detect", query.frame)
    return figures.working_panel(entry, facts, figures.example_of(facts, store, prepared, detected, query.frame, image))


def _facts(asker: Asker, entry: Entry) -> FilmFacts:
    facts = asker.facts
    if missing := entry.drawing.missing(facts):
        raise NotOfThisFilm(missing)
    return facts


def _findings(asker: Asker, store: ObjectStore, entry: Entry, query: FigureQuery) -> Findings:
    facts = _facts(asker, entry)
    return figures.findings(facts, condensed(asker, store, entry.needs, facts), query)


def condensed(asker: Asker, store: ObjectStore, needs: Needs, facts: FilmFacts) -> Condensed:
    """What the analysis left, or while it is not complete what the stages before have counted."""
    done = asker.done
    if "analyse" in done and _has(analysed := asker.product("analyse"), STATISTICS_FILE):
        return film.stored(store, analysed)
    # Runs of the first version have left no statistics: of them there is what was counted while they went.
    if needs is not Needs.NOTHING and needs not in done - {"analyse"}:
        raise NotYet
    session, viewer, run_id = asker.session, asker.viewer, asker.run_id
    return film.LiveCondensed(
        facts,
        detected=lambda: repository.sizes(session, viewer, run_id, "detect"),
        tracked=lambda: repository.sizes(session, viewer, run_id, "track"),
        flow=lambda: repository.flow(session, viewer, run_id),
    )


def exports(asker: Asker) -> list[Export]:
    """The forms in which results can be had."""
    run = asker.run
    is_available = "analyse" in asker.done
    return [
        Export(
            kind=kind,
            title=TITLE[kind],
            file_name=exporting.file_name(kind, run.number) + (".zip" if kind is Kind.ZARR else ""),
            media_type=MEDIA_TYPE[kind],
            is_available=is_available,
        )
        for kind in Kind
    ]


def export(asker: Asker, store: ObjectStore, kind: Kind, work_dir: Path) -> Iterator[bytes]:
    """The bytes of an export, as they are made."""
    analysed, tracked = asker.product("analyse"), asker.product("track")
    return exporting.export(store, tracked, analysed, kind, work_dir)


def report(asker: Asker, store: ObjectStore) -> Iterator[bytes]:
    """The page that the analysis left."""
    analysed = asker.product("analyse")
    if not _has(analysed, REPORT_FILE):
        raise NotYet
    return store.stream(analysed.prefix + REPORT_FILE)


def _has(product: Product, name: str) -> bool:
    return any(file["name"] == name for file in product.files)


def files(asker: Asker) -> list[ResultFile]:
    """What there is to download so far."""
    asker.check()
    found = repository.products(asker.session, asker.viewer, asker.run_id)
    return [ResultFile.model_validate(file) for product in found for file in product.files]


def download(asker: Asker, store: ObjectStore, name: str) -> Download:
    """A file to be streamed. What is published never changes, so that its place is its tag."""
    asker.check()
    for product in repository.products(asker.session, asker.viewer, asker.run_id):
        for file in product.files:
            if file["name"] == name:
                found = ResultFile.model_validate(file)
                return Download(
                    name=found.name,
                    media_type=found.media_type,
                    size_bytes=found.size_bytes,
                    sha256=found.sha256,
                    tag=tag_of_bytes(product.prefix.encode(), name.encode()),
                    read=_reader(store, product.prefix, name),
                )
    raise NotYet if name in RESULT_NAMES else NoSuchResult


RESULT_NAMES = (
    "droplets.parquet",
    "trajectories.parquet",
    "rejected_trajectories.parquet",
    "events.parquet",
    "flow.zarr.zip",
    "trajectory_summary.parquet",
    "coalescences.parquet",
    "statistics.npz",
    "example.npz",
    "report.html",
    "summary.json",
)


def _reader(store: ObjectStore, prefix: str, name: str) -> Callable[[int, int], Iterator[bytes]]:
    """Streams a part of an object, or of a folder of objects as an archive."""
    if not name.endswith(ZIPPED_FOLDER):
        return lambda start, stop: store.stream(prefix + name, start, stop)
    folder = prefix + name.removesuffix(".zip") + "/"

    def read(start: int, stop: int) -> Iterator[bytes]:
        keys = [key for key, _ in store.list(folder)]
        return part(zip_stream((key.removeprefix(prefix), store.read(key)) for key in keys), start, stop)

    return read
