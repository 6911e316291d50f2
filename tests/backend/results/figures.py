"""The figures that a run of the short film has, each with what it must be asked with."""

from dropflow.figures.catalogue import CATALOGUE
from dropflow.figures.entry import Group

_QUERIES = {
    "flow_field": "?frame=2",
    "displacement": "?frame=2",
    "forward_tracking": "?frame=2&trajectory=0",
    "backward_tracking": "?frame=2&trajectory=0",
}
_OF_OTHER_FILMS = ("temperature", "driving")
FIGURES = [
    entry.name + _QUERIES.get(entry.name, "")
    for entry in CATALOGUE
    if entry.group is not Group.FLUID and entry.name not in _OF_OTHER_FILMS
]
