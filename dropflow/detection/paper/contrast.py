"""Which grey levels of the filtered frame become black and white (the contrast of section 3.1.1)."""

import numpy as np
import numpy.typing as npt

from dropflow.parameters import PaperDetection
from dropflow.preprocess import percentiles

Image = npt.NDArray[np.float32]


def black_and_white(image: Image, *, noise: float, knobs: PaperDetection) -> tuple[float, float]:
    """Return the levels of `image`, whose noise has the standard deviation `noise`, that become 0 and 255.

    They are two percentiles of the whole frame, as for the paper's frames, which are full of droplets. In a frame with
    few, the high one would lie in the noise or in the blurred rim of the droplets. Hence white is at least a percentile
    of what stands out of the noise, and a number of standard deviations of the noise above black.
    """
    black, white = percentiles(image, [knobs.contrast_low_percent, knobs.contrast_high_percent])
    bright = image[image > np.median(image[::4, ::4]) + knobs.noise_margin * noise]
    if bright.size:
        white = max(white, percentiles(bright, [knobs.contrast_droplet_percent])[0])
    return black, max(white, black + knobs.contrast_noise * noise)
