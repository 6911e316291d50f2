"""Runs beside each other: numbers, differences and figures, each only of runs that the viewer may see."""

import json
from collections.abc import Iterator, Sequence
from uuid import UUID

from sqlalchemy.orm import Session

from backend.comparisons.schemas import (
    ComparedField,
    ComparedNumber,
    ComparedRun,
    Comparison,
    ComparisonFigureEntry,
    ComparisonFigureName,
    ComparisonFigureQuery,
)
from backend.models import Run
from backend.platform.object_store import ObjectStore
from backend.platform.visibility import Viewer
from backend.results import service as results
from backend.results.catalogue import LATER, check_parameters, shown_parameter
from backend.results.errors import NotYet
from backend.results.figures import as_csv, as_json, findings
from backend.results.schemas import FigureParameter, FigureQuery
from backend.results.service import Asker
from dropflow.figures.compared import COMPARED, COMPARED_BY_NAME, Compared, ComparedEntry, table_of_all
from dropflow.figures.layout import COLOURS_OF_RUNS
from dropflow.statistics.side_by_side import KEY_NUMBERS, KeyNumber, at, differing

_LONGEST_NAME = 24


def askers(session: Session, viewer: Viewer, run_ids: Sequence[UUID]) -> list[Asker]:
    """Who asks for each run; a run that they may not see is not there."""
    found = [Asker(session, viewer, run_id) for run_id in run_ids]
    for asker in found:
        asker.check()
    return found


def comparison(asked: Sequence[Asker]) -> Comparison:
    """Everything but the figures themselves."""
    runs = [asker.run for asker in asked]
    rows = [_number(number, runs) for number in KEY_NUMBERS]
    return Comparison(
        runs=_shown(runs),
        numbers=[row for row in rows if any(value is not None for value in row.values)],
        parameters=_fields([run.parameters for run in runs]),
        experiment=_fields([run.document for run in runs]),
        figures=[_entry(entry, asked) for entry in COMPARED],
    )


def figure(asked: Sequence[Asker], store: ObjectStore, name: ComparisonFigureName, query: ComparisonFigureQuery) -> str:
    """A figure of the runs that have something for it, as Plotly JSON."""
    entry = _checked(name, query)
    compared, left_out = _compared(asked, store, entry, query)
    drawn = entry.draw(compared, entry.title)
    return as_json(drawn.update_layout(meta={"left_out": left_out}))


def table(
    asked: Sequence[Asker], store: ObjectStore, name: ComparisonFigureName, query: ComparisonFigureQuery
) -> Iterator[bytes]:
    """The numbers of a figure as CSV."""
    entry = _checked(name, query)
    compared, _ = _compared(asked, store, entry, query)
    about = {"runs": {one.label: dict(one.found.facts.provenance) for one in compared}}
    return as_csv(table_of_all(entry, compared), json.dumps(about))


def _checked(name: ComparisonFigureName, query: ComparisonFigureQuery) -> ComparedEntry:
    entry = COMPARED_BY_NAME[name]
    check_parameters(name, entry.parameters, query.model_dump(exclude_none=True, exclude={"run"}))
    return entry


def _compared(
    asked: Sequence[Asker], store: ObjectStore, entry: ComparedEntry, query: ComparisonFigureQuery
) -> tuple[list[Compared], list[dict[str, str]]]:
    """Those that have something for a figure, and those that have not, with the reason."""
    asked_for = FigureQuery(**query.model_dump(exclude={"run"}))
    compared, left_out = [], []
    for asker, shown in zip(asked, _shown([asker.run for asker in asked]), strict=True):
        try:
            facts = asker.facts
            found = findings(facts, results.condensed(asker, store, entry.needs, facts), asked_for)
        except NotYet:
            reason: str | None = LATER[entry.needs]
        else:
            one = Compared(shown.label, shown.colour, found)
            reason = entry.left_out(one)
            if reason is None:
                compared.append(one)
        if reason is not None:
            left_out.append({"run": str(asker.run_id), "label": shown.label, "reason": reason})
    return compared, left_out


def _shown(runs: Sequence[Run]) -> list[ComparedRun]:
    is_one_experiment = len({run.experiment_id for run in runs}) == 1
    return [
        ComparedRun(
            id=run.id,
            experiment_id=run.experiment_id,
            experiment_name=run.document["name"],
            number=run.number,
            label=label,
            colour=colour,
            state=run.state,
            created_at=run.created_at,
            version=run.version,
            n_frames=run.experiment.stack.n_frames,
        )
        for run, label, colour in zip(runs, _labels(runs, is_one_experiment), _colours(runs), strict=True)
    ]


def _labels(runs: Sequence[Run], is_one_experiment: bool) -> list[str]:
    """Short, and no two alike."""
    labels: list[str] = []
    for run in runs:
        name = str(run.document["name"])
        name = name if len(name) <= _LONGEST_NAME else f"{name[: _LONGEST_NAME - 1]}…"
        label = f"run {run.number}" if is_one_experiment else f"{name} · run {run.number}"
        # Experiments of one name, or of one beginning.
        labels.append(label if label not in labels else f"{label} ({str(run.experiment_id)[:4]})")
    return labels


def _colours(runs: Sequence[Run]) -> list[str]:
    """Each run's own colour, by its number, or the next that is free."""
    taken: list[str] = []
    for run in runs:
        turn = [COLOURS_OF_RUNS[(run.number - 1 + i) % len(COLOURS_OF_RUNS)] for i in range(len(COLOURS_OF_RUNS))]
        taken.append(next(colour for colour in turn if colour not in taken))
    return taken


def _number(number: KeyNumber, runs: Sequence[Run]) -> ComparedNumber:
    return ComparedNumber(
        name=number.name,
        title=number.title,
        unit=number.unit,
        values=[at(run.summary, number.name) for run in runs],
        stds=[at(run.summary, number.std) for run in runs] if number.std else None,
    )


def _fields(documents: Sequence[dict[str, object]]) -> list[ComparedField]:
    return [ComparedField(name=name, values=values) for name, values in differing(documents).items()]


def _entry(entry: ComparedEntry, asked: Sequence[Asker]) -> ComparisonFigureEntry:
    is_available = any(entry.needs in asker.done for asker in asked)
    return ComparisonFigureEntry(
        name=ComparisonFigureName(entry.name),
        title=entry.title,
        how=entry.how,
        docs=f"explanation/figures/{entry.docs}.md",
        parameters=_parameters(entry, asked),
        is_available=is_available,
        reason=None if is_available else LATER[entry.needs],
    )


def _parameters(entry: ComparedEntry, asked: Sequence[Asker]) -> list[FigureParameter]:
    """With the range that holds those of all runs."""
    of_each = [
        [
            shown_parameter(parameter, asker.facts, asker.run.experiment.stack.duration_s or 0.0)
            for parameter in entry.parameters
        ]
        for asker in asked
    ]
    return [
        same[0].model_copy(
            update={
                "low": min((one.low for one in same if one.low is not None), default=None),
                "high": max((one.high for one in same if one.high is not None), default=None),
            }
        )
        for same in zip(*of_each, strict=True)
    ]
