"""The figures of a run and their numbers, as the library draws them."""

import io
import json
from collections.abc import Iterator
from typing import Any

import numpy.typing as npt
import plotly.graph_objects as go
import polars as pl
import pyarrow.parquet as pq

from backend.models import Product
from backend.platform.object_store import ObjectStore
from backend.results.frames import detected_droplets, open_flow
from backend.results.schemas import FigureQuery
from dropflow import figures
from dropflow.figures.entry import Entry, draw
from dropflow.figures.example import EXAMPLE_FILE, Example, draw_example, make_example
from dropflow.figures.of_frame import COLUMNS, FlowStep, displacement_of, flow_field_of, tracking_step_of
from dropflow.statistics.condensed import Condensed
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.findings import Findings
from dropflow.statistics.oscillations import Signal
from dropflow.statistics.scope import Scope

DIRECTIONS = {"forward_tracking": figures.Direction.FORWARD, "backward_tracking": figures.Direction.BACKWARD}
_ROWS_AT_ONCE = 1 << 14


def findings(facts: FilmFacts, condensed: Condensed, query: FigureQuery) -> Findings:
    """The statistics of the part of a film that is asked for."""
    scope = Scope(query.from_s, query.to_s, query.radius_min_um, query.radius_max_um)
    return Findings(facts, condensed, scope=scope, signal=query.signal or Signal.N_DROPLETS)


def of_film(entry: Entry, found: Findings) -> str:
    """A figure of the whole film, as Plotly JSON."""
    return as_json(draw(entry, found))


def table_of(entry: Entry, found: Findings) -> Iterator[bytes]:
    """The numbers of a figure as CSV, the first line of which says where they come from."""
    assert entry.drawing.table is not None  # noqa: S101 - whoever asks has looked
    # Made before the answer begins: what is wrong must still become an error.
    return as_csv(entry.drawing.table(found), json.dumps(dict(found.facts.provenance)))


def as_csv(table: pl.DataFrame, about: str) -> Iterator[bytes]:
    """A table, its first line a comment that says where it comes from."""
    yield f"# dropflow: {about}\n".encode()
    yield table.clear().write_csv().encode()
    for start in range(0, len(table), _ROWS_AT_ONCE):
        yield table.slice(start, _ROWS_AT_ONCE).write_csv(include_header=False).encode()


def kept_example(store: ObjectStore, analysed: Product) -> Example:
    """The frame that the analysis kept."""
    with store.open(analysed.prefix + EXAMPLE_FILE) as file:
        return Example.load(file)


def example_of(
    facts: FilmFacts, store: ObjectStore, prepared: Product, detected: Product, frame: int, image: npt.NDArray[Any]
) -> Example:
    """Any other frame, prepared as the analysis did."""
    from dropflow.preprocess.estimate import ESTIMATE_FILE, StackEstimate

    measured = StackEstimate.load(io.BytesIO(store.read(prepared.prefix + ESTIMATE_FILE)))
    droplets = detected_droplets(store, detected, frame)
    return make_example(image, frame, droplets, facts.experiment, facts.parameters, measured)


def working_panel(entry: Entry, facts: FilmFacts, example: Example) -> str:
    """A step of detection."""
    caption = figures.caption_of(facts.caption())
    return as_json(draw_example(entry.name, example, parameters=facts.parameters, title=entry.title, caption=caption))


def of_frame(
    entry: Entry,
    facts: FilmFacts,
    store: ObjectStore,
    tracked: Product,
    query: FigureQuery,
    image: npt.NDArray[Any] | None,
) -> str:
    """A figure of one frame; `image` is the one in which it looks."""
    frame = query.frame or 0
    direction = DIRECTIONS.get(entry.name)
    flow = open_flow(store, tracked)
    step = FlowStep.read(flow, frame - 1 if direction is figures.Direction.BACKWARD else frame)
    with store.open(tracked.prefix + "trajectories.parquet") as file:
        wanted = ("frame", "in", [frame, frame + 1]) if direction is None else ("trajectory_id", "=", query.trajectory)
        rows = pl.DataFrame(pq.read_table(file, columns=COLUMNS, filters=[wanted]))
    if direction is not None:
        return as_json(tracking_step_of(facts, step, rows, frame, direction=direction, title=entry.title, image=image))
    drawn = displacement_of if entry.name == "displacement" else flow_field_of
    return as_json(drawn(facts, step, rows, title=entry.title, image=image))


def as_json(figure: go.Figure) -> str:
    """A figure as the page takes it."""
    text: str = figure.to_json()
    return text
