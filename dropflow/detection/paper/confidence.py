"""How sure the paper's detection is. The paper gives no numbers for single droplets: these are measured.

On simulated frames of all scenarios, whose truth is known (`docs/explanation/paper-detection.md` has the figures and
the commands): a true value lies within one of these standard deviations in about 68 % of the visible droplets. Most
of the radius error is a bias: blur makes the steepest descent, where the match is best, lie inside the true edge.
"""

import numpy as np
import numpy.typing as npt

Column = npt.NDArray[np.float64]

RADIUS_STD = 0.22
RADIUS_STD_MAX_PX = 1.8
"""The form is that of section 4.4: a constant share of small radii, a constant length for large ones."""
POSITION_STD = 0.06
EVEN_MATCH = 0.025
"""A circle with this match is as likely a droplet as not."""


def radius_std_px(r_px: Column) -> Column:
    """Standard deviation of the radius about the true one, bias included, px."""
    return np.minimum(RADIUS_STD * r_px, RADIUS_STD_MAX_PX)


def position_std_px(r_px: Column) -> Column:
    """Standard deviation of either coordinate about the true one, px."""
    return POSITION_STD * r_px


def probability(match: Column) -> Column:
    """Probability that there is a real droplet, sharp or not, in view: m / (m + 0.025), 0 for m < 0.

    It tells a droplet from dirt and from edges of other droplets, as they look in simulated frames. It does not say
    that the droplet is in focus.
    """
    positive = np.maximum(match, 0.0)
    return positive / (positive + EVEN_MATCH)
