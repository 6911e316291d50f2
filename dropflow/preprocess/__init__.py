"""What is done to a frame before droplets are looked for in it (section 3.1.1), and what is measured once per stack."""

from dropflow.preprocess.contrast import percentiles, stretch
from dropflow.preprocess.estimate import StackEstimate, estimate_stack
from dropflow.preprocess.filters import Blur, band_pass, smooth
from dropflow.preprocess.frame import corrected
from dropflow.preprocess.noise import noise_std

__all__ = [
    "Blur",
    "StackEstimate",
    "band_pass",
    "corrected",
    "estimate_stack",
    "noise_std",
    "percentiles",
    "smooth",
    "stretch",
]
