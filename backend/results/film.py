"""A run as the library's statistics see it: what was filmed, and what its tables were condensed to."""

from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import polars as pl

from backend.models import Product, Run
from backend.platform.object_store import ObjectStore
from backend.platform.packing import unpack
from backend.results.errors import NotYet
from dropflow.experiment import parse_experiment
from dropflow.parameters import parse_parameters
from dropflow.statistics.calibration import Calibration
from dropflow.statistics.condensed import Clock, Condensed
from dropflow.statistics.condensed_files import StoredCondensed
from dropflow.statistics.facts import FilmFacts
from dropflow.statistics.flow_correlation import FlowCorrelation
from dropflow.statistics.flow_moments import FlowMoments
from dropflow.statistics.histograms import FrameHistograms, merge, radius_edges_um
from dropflow.statistics.in_sight import InSight
from dropflow.statistics.lengths import ObservedDepth

Packed = Callable[[], Sequence[bytes]]


def facts_of(run: Run, shape: tuple[int, int]) -> FilmFacts:
    """What statistics must know of a run's film."""
    experiment, parameters = parse_experiment(run.document), parse_parameters(run.parameters)
    rows, columns = shape
    pixel_um = experiment.pixel_size_um
    about = (run.summary or {}).get("provenance") or {
        "dropflow_version": run.version,
        "experiment": run.document,
        "parameters": run.parameters,
        "input_sha256": run.experiment.stack.checksum,
    }
    n_frames = run.experiment.stack.n_frames or 0
    return FilmFacts(
        experiment, parameters, (columns * pixel_um, rows * pixel_um), n_frames, about | {"run": run.number}
    )


def stored(store: ObjectStore, product: Product) -> Condensed:
    """What the analysis left. Of the films last looked at the arrays stay in memory: each zoom is drawn from them."""
    return StoredCondensed(lambda name: store.open(product.prefix + name), kept=kept_arrays(store.url, product.prefix))


@lru_cache(maxsize=3)
def kept_arrays(store_url: str, prefix: str) -> dict[str, Any]:  # noqa: ARG001 - they are the key
    """Arrays by part, empty at first. About 20 MB of a film of 20,000 frames; what is published never changes."""
    return {}


class LiveCondensed:
    """What is known while a run goes: the counts of its shards, and the flow once it was tracked.

    Parameters
    ----------
    facts
        What was filmed.
    detected, tracked
        Packed histograms, as far as there are any.
    flow
        Packed moments of the flow, if there are any.
    """

    def __init__(
        self, facts: FilmFacts, *, detected: Packed, tracked: Packed, flow: Callable[[], bytes | None]
    ) -> None:
        self._facts, self._detected, self._tracked, self._flow = facts, detected, tracked, flow

    @cached_property
    def before(self) -> FrameHistograms:
        """Of the frames that are done."""
        return self._merged(self._detected())

    @cached_property
    def after(self) -> FrameHistograms:
        """Empty until the film was tracked."""
        return self._merged(self._tracked())

    @cached_property
    def flow(self) -> FlowMoments:
        """Once the film was tracked."""
        packed = self._flow()
        if packed is None:
            raise NotYet
        return unpack(FlowMoments, packed)

    @property
    def seen(self) -> InSight | None:
        """Not known yet."""
        return None

    @property
    def depth(self) -> ObservedDepth:
        """Not known yet."""
        return ObservedDepth(np.nan, np.nan, np.empty(0))

    @property
    def clock(self) -> Clock:
        """Comes with the analysis."""
        raise NotYet

    @property
    def correlation(self) -> FlowCorrelation:
        """Comes with the analysis."""
        raise NotYet

    @property
    def calibration(self) -> Calibration:
        """Comes with the analysis."""
        raise NotYet

    @property
    def trajectories(self) -> pl.DataFrame:
        """Comes with the analysis."""
        raise NotYet

    @property
    def events(self) -> pl.DataFrame:
        """Comes with the analysis."""
        raise NotYet

    def _merged(self, packed: Sequence[bytes]) -> FrameHistograms:
        detection = self._facts.parameters.detection
        nothing = FrameHistograms.empty(radius_edges_um(detection.radius_min_um, detection.radius_max_um))
        return merge(nothing, *(unpack(FrameHistograms, content) for content in packed))
