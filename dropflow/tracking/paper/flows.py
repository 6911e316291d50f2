"""The paper's flow field of each step, from the trajectories that are left at the end (section 3.3.3)."""

from collections.abc import Iterable
from dataclasses import replace

from dropflow.tracking.checkpoint import Arrays
from dropflow.tracking.flow import FlowField
from dropflow.tracking.front import Front
from dropflow.tracking.paper.rules import PaperRules
from dropflow.tracking.prediction import Motion


class PaperFlows:
    """Each step by itself."""

    def __init__(self, rules: PaperRules) -> None:
        self._rules = rules

    def add(self, before: Front, after: Front, dt_s: float, motion: Motion) -> Iterable[FlowField]:
        """The field of this step."""
        return [replace(self._rules, motion=motion).flow_between(before.droplets, after.droplets, dt_s)]

    def finish(self) -> Iterable[FlowField]:
        """Nothing is left."""
        return []

    def learn_from(self, arrays: Arrays) -> None:
        """The paper has nothing that holds for the whole film."""

    def state(self) -> Arrays:
        """Nothing is remembered."""
        return {}

    def restore(self, arrays: Arrays) -> None:
        """Nothing is remembered."""
