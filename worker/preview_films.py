"""Films that previews look at, kept open between two looks: whoever moves a knob asks again at once."""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar
from uuid import UUID

from backend.models import Experiment as ExperimentRow
from backend.platform.store_files import StoreFiles
from dropflow.detection import make_detector
from dropflow.detection.contract import Detection, Detector, Image
from dropflow.errors import FramesError
from dropflow.experiment import Experiment, parse_experiment
from dropflow.frames import Choice, Frame, Frames, open_frames
from dropflow.ingest import StackIndex
from dropflow.parameters import Parameters
from dropflow.preprocess import StackEstimate
from dropflow.preprocess.measure import estimate_stack
from worker.context import Context
from worker.film import FRAMES_ROLE, uploaded_files

Thing = TypeVar("Thing")

MOST_FILMS, MOST_THINGS = 2, 12


class Kept:
    """The last few things that were made, by what they were made from."""

    def __init__(self, most: int) -> None:
        self._most, self._things = most, OrderedDict[Any, Any]()

    def get(self, key: Any, make: Callable[[], Thing]) -> Thing:
        """The thing of this key, made if it is not there."""
        if key not in self._things:
            self._things[key] = make()
        self._things.move_to_end(key)
        while len(self._things) > self._most:
            close = getattr(self._things.popitem(last=False)[1], "close", None)
            if close is not None:
                close()
        thing: Thing = self._things[key]
        return thing


@dataclass
class Film:
    """An open film, and what was measured of it for one choice of parameters or another."""

    experiment: Experiment
    index: StackIndex
    frames: Frames
    flat_field: Frame | None
    _made: Kept = field(default_factory=lambda: Kept(MOST_THINGS))

    def measured(self, parameters: Parameters) -> StackEstimate:
        """What holds for all frames; it depends on the method alone."""
        method = parameters.detection.method
        return self._made.get(
            ("estimate", method), lambda: estimate_stack(self.frames, self.experiment, parameters, self.flat_field)
        )

    def detector(self, parameters: Parameters) -> Detector:
        """The detector of a run with these parameters."""
        return make_detector(self.experiment, parameters, self.measured(parameters))

    def prepared(self, parameters: Parameters, frame: int) -> Image:
        """A frame as detection sees it."""
        detection = parameters.detection.model_dump_json()
        detector = self.detector(parameters)
        return self._made.get(("image", detection, frame), lambda: detector.prepare(self.frames.read(frame)))

    def detection(self, parameters: Parameters, frame: int) -> Detection:
        """What is found in a whole frame."""
        detection = parameters.detection.model_dump_json()
        image = self.prepared(parameters, frame)
        return self._made.get(("droplets", detection, frame), lambda: self.detector(parameters).detect(image))

    def close(self) -> None:
        """Close its files."""
        self.frames.close()


class Films:
    """The films that were looked at last, in this process."""

    def __init__(self) -> None:
        self._kept = Kept(MOST_FILMS)

    def get(self, context: Context, experiment_id: UUID, told: dict[str, Any] | None = None) -> Film:
        """An experiment's film, as `told` or as it is now: another description or other frames are another film."""
        with context.sessions.begin() as session:
            row = session.get(ExperimentRow, experiment_id)
            if row is None or row.stack.index_key is None:
                raise FramesError("The frames are not there any more.", code="frames.gone")
            document, index_key, checksum = row.document, row.stack.index_key, row.stack.checksum
            files = uploaded_files(session, experiment_id)
        experiment = parse_experiment(document if told is None else told)

        def open_film() -> Film:
            source = StoreFiles(context.store, files[FRAMES_ROLE])
            index = StackIndex.model_validate_json(context.store.read(index_key)).timed(experiment)
            flat_files = files.get("flat_field")
            flat_field = None
            if flat_files:
                with open_frames(StoreFiles(context.store, flat_files)) as flat:
                    flat_field = flat[0]
            return Film(experiment, index, open_frames(source, Choice.of(experiment, index.broken_frames)), flat_field)

        return self._kept.get((experiment_id, checksum, experiment.model_dump_json()), open_film)


films = Films()
