"""Which figures a run has, and what each takes."""

from collections.abc import Collection, Sequence

from backend.platform.problems import InvalidRequest
from backend.results.errors import NotKept
from backend.results.schemas import FigureEntry, FigureName, FigureParameter, FigureQuery
from dropflow.errors import FieldProblem
from dropflow.figures.catalogue import BY_NAME, CATALOGUE
from dropflow.figures.entry import Entry, Needs, Parameter
from dropflow.figures.example import WORKING_PANELS
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.oscillations import Signal

_DOCS = "explanation/figures"
LATER = {
    Needs.NOTHING: "It appears when the frames are known.",
    Needs.DETECT: "It appears when the first frames are detected.",
    Needs.TRACK: "It appears when the droplets are tracked.",
    Needs.ANALYSE: "It appears when the analysis is complete.",
}
NEVER = "The run ended before it came to this."


def entries(
    facts: FilmFacts,
    done: Collection[str],
    *,
    duration_s: float,
    is_example_kept: bool = True,
    is_ended: bool = False,
) -> list[FigureEntry]:
    """All figures; `done` are the stages that have left something, and perhaps a frame to show detection on."""
    found = [_entry(entry, facts, done, duration_s, is_ended) for entry in CATALOGUE]
    if is_example_kept or Needs.ANALYSE not in done:
        return found
    return [_of_a_chosen_frame(entry, "prepare" in done) if entry.name in WORKING_PANELS else entry for entry in found]


def _of_a_chosen_frame(entry: FigureEntry, is_prepared: bool) -> FigureEntry:
    """Of a run that kept no frame itself: any can be looked at, where what was measured of the film is there."""
    if not is_prepared:
        return entry.model_copy(update={"is_available": False, "reason": str(NotKept())})
    chosen = [one.model_copy(update={"is_required": one.name == "frame"}) for one in entry.parameters]
    return entry.model_copy(update={"parameters": chosen})


def _entry(entry: Entry, facts: FilmFacts, done: Collection[str], duration_s: float, is_ended: bool) -> FigureEntry:
    reason = entry.drawing.missing(facts)
    if reason is None and entry.needs is not Needs.NOTHING and entry.needs not in done:
        reason = NEVER if is_ended else LATER[entry.needs]
    return FigureEntry(
        name=FigureName(entry.name),
        title=entry.title,
        paper=entry.paper,
        group=entry.group,
        how=entry.how,
        docs=f"{_DOCS}/{entry.docs}.md",
        has_table=entry.drawing.table is not None,
        parameters=[shown_parameter(parameter, facts, duration_s) for parameter in entry.drawing.parameters],
        is_available=reason is None,
        reason=reason,
    )


def shown_parameter(parameter: Parameter, facts: FilmFacts, duration_s: float) -> FigureParameter:
    """A parameter with the range that a film has for it."""
    detection = facts.parameters.detection
    ranges = {
        "s": (0.0, duration_s),
        "µm": (detection.radius_min_um, detection.radius_max_um),
        "frame": (0.0, float(max(facts.n_frames - 1, 0))),
    }
    low, high = ranges.get(parameter.unit or parameter.name, (None, None))
    return FigureParameter(
        name=parameter.name,
        kind=parameter.kind,
        unit=parameter.unit,
        description=parameter.description,
        is_required=parameter.is_required,
        low=low,
        high=high,
        choices=list(parameter.choices) or None,
        default=Signal.N_DROPLETS if parameter.name == "signal" else None,
    )


def checked(name: FigureName, query: FigureQuery) -> Entry:
    """The entry of a figure; parameters that it does not take, or needs and was not given, are an error."""
    entry = BY_NAME[name]
    check_parameters(name, entry.drawing.parameters, query.model_dump(exclude_none=True))
    return entry


def check_parameters(name: str, parameters: Sequence[Parameter], given: Collection[str]) -> None:
    """Refuse what a figure does not take, and that it is not given what it needs."""
    taken = {parameter.name for parameter in parameters}
    problems = [FieldProblem(field, f"{name} does not take it") for field in given if field not in taken]
    problems += [
        FieldProblem(parameter.name, "is needed")
        for parameter in parameters
        if parameter.is_required and parameter.name not in given
    ]
    if problems:
        raise InvalidRequest("The figure cannot be drawn so.", fields=problems)
