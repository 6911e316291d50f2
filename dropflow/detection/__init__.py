"""From a frame to droplets: one contract (`dropflow.detection.contract.Detector`), one package for each method."""

from dropflow.detection.contract import Detector
from dropflow.detection.default.detector import DefaultDetector
from dropflow.detection.paper.detector import PaperDetector
from dropflow.experiment import Experiment
from dropflow.parameters import Method, Parameters
from dropflow.preprocess import StackEstimate
from dropflow.radius_range import radius_range_px

__all__ = ["make_detector"]


def make_detector(experiment: Experiment, parameters: Parameters, estimate: StackEstimate) -> Detector:
    """Return the detector that `parameters.detection.method` names, for the stack that `estimate` was made of.

    Raises
    ------
    ParametersError
        The radius range does not fit the frames.
    """
    r_min_px, r_max_px = radius_range_px(experiment, parameters, estimate.shape)
    match parameters.detection.method:
        case Method.DEFAULT:
            return DefaultDetector(estimate=estimate, tone=experiment.droplets, r_min_px=r_min_px, r_max_px=r_max_px)
        case Method.PAPER:
            return PaperDetector(
                estimate=estimate,
                tone=experiment.droplets,
                r_min_px=r_min_px,
                r_max_px=r_max_px,
                knobs=parameters.detection.paper,
            )
