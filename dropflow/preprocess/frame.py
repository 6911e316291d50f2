"""From a frame as read to corrected float grey levels with bright droplets."""

from typing import Any

import numpy as np
import numpy.typing as npt

from dropflow.errors import FramesError
from dropflow.experiment import DropletTone
from dropflow.preprocess.estimate import StackEstimate


def corrected(frame: npt.NDArray[Any], estimate: StackEstimate, tone: DropletTone) -> npt.NDArray[np.float32]:
    """Divide by the flat field and, where droplets are dark, invert the grey levels (and nothing else).

    Parameters
    ----------
    frame
        Shape (rows, columns) of `estimate.shape`, any real dtype; it is left as it is.
    estimate
        What holds for the whole stack.
    tone
        Whether droplets are brighter or darker than the fluid around them.

    Returns
    -------
    Shape (rows, columns), float32, droplets bright. Inverted levels are negative; only differences matter hereafter.

    Raises
    ------
    FramesError
        The frame has another shape than its stack, or pixels that are not finite.
    """
    if frame.shape != estimate.shape:
        message = f"The frame has shape {frame.shape}, the stack {estimate.shape}."
        raise FramesError(message, code="frames.shape", hint="Put frames of another size into a stack of their own.")
    with np.errstate(over="ignore"):
        image: npt.NDArray[np.float32] = frame.astype(np.float32)
    if not np.issubdtype(frame.dtype, np.integer) and not np.isfinite(image).all():
        message = "The frame has pixels that are not finite numbers (NaN, infinite or beyond 3e38)."
        raise FramesError(message, code="frames.not_finite", hint="Fill them in before the analysis.")
    if estimate.flat_field is not None:
        image /= estimate.flat_field
    if tone is DropletTone.DARK:
        np.negative(image, out=image)
    return image
