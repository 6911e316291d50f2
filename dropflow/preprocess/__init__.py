"""What is done to a frame before droplets are looked for in it (section 3.1.1), and what is measured once per stack."""

from dropflow.preprocess.contrast import percentiles, stretch
from dropflow.preprocess.estimate import StackEstimate
from dropflow.preprocess.filters import Blur, band_pass, smooth
from dropflow.preprocess.frame import corrected
from dropflow.preprocess.measure import estimate_stack
from dropflow.preprocess.noise import noise_level, noise_std
from dropflow.preprocess.stripes import Stripes, measure_stripes, remove_stripes

__all__ = [
    "Blur",
    "StackEstimate",
    "Stripes",
    "band_pass",
    "corrected",
    "estimate_stack",
    "measure_stripes",
    "noise_level",
    "noise_std",
    "percentiles",
    "remove_stripes",
    "smooth",
    "stretch",
]
