"""What can be asked of results, while a run goes and after."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from uuid import UUID

from sqlalchemy.orm import Session

from backend.models import Product, Run
from backend.platform.downloads import Download
from backend.platform.entity_tags import tag_of_bytes
from backend.platform.object_store import ObjectStore
from backend.platform.visibility import Viewer
from backend.platform.zip_stream import part, zip_stream
from backend.results import figures, frames, repository
from backend.results.errors import FrameMissing, NoSuchResult, NotYet
from backend.results.schemas import FigureName, FrameDroplets, FrameFlow, ResultFile, Which
from backend.runs.service import get as get_run
from dropflow.frames import Frame

ZIPPED_FOLDER = ".zarr.zip"


@dataclass(frozen=True)
class Asker:
    """Who asks for results of which run."""

    session: Session
    viewer: Viewer
    run_id: UUID

    def run(self) -> Run:
        """The run."""
        return get_run(self.session, self.viewer, self.run_id)

    def product(self, task: str, frame: int | None = None) -> Product:
        """What a task made, if it has."""
        self.run()
        found = repository.product(self.session, self.viewer, self.run_id, task, frame)
        if found is None:
            raise NotYet
        return found

    def sizes(self, *tasks: str) -> list[bytes]:
        """Packed histograms of the first of `tasks` that has any."""
        for task in tasks:
            if found := repository.sizes(self.session, self.viewer, self.run_id, task):
                return found
        raise NotYet

    def flow(self) -> bytes:
        """Packed moments of the flow."""
        found = repository.flow(self.session, self.viewer, self.run_id)
        if found is None:
            raise NotYet
        return found

    def shape(self) -> tuple[int, int]:
        """Rows and columns of the frames."""
        stack = self.run().experiment.stack
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


def film_figure(asker: Asker, name: FigureName) -> str:
    """A figure of the whole film, as Plotly JSON."""
    run, shape = asker.run(), asker.shape()
    if name is FigureName.SIZE_DISTRIBUTION_BEFORE:
        return figures.as_json(figures.size_distribution(run, shape, "detect", asker.sizes("detect")))
    if name is FigureName.SIZE_DISTRIBUTION_AFTER:
        return figures.as_json(figures.size_distribution(run, shape, "track", asker.sizes("track")))
    if name is FigureName.MOMENTS:
        return figures.as_json(figures.moments(run, shape, asker.sizes("track", "detect")))
    if name is FigureName.FLOW_MOMENTS:
        return figures.as_json(figures.flow_moments(run, asker.flow()))
    raise FrameMissing


def flow_figure(asker: Asker, store: ObjectStore, image: Frame, frame: int) -> str:
    """The flow field over its frame, as Plotly JSON."""
    product = asker.product("track", frame)
    found, seen = frames.flow(store, product, frame), frames.tracked(store, product, frame)
    return figures.as_json(figures.flow_field(asker.run(), found, seen, image))


def files(asker: Asker) -> list[ResultFile]:
    """What there is to download so far."""
    asker.run()
    found = repository.products(asker.session, asker.viewer, asker.run_id)
    return [ResultFile.model_validate(file) for product in found for file in product.files]


def download(asker: Asker, store: ObjectStore, name: str) -> Download:
    """A file to be streamed. What is published never changes, so that its place is its tag."""
    asker.run()
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
    "flow.zarr.zip",
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
