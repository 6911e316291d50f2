"""How strong, how long and how compressible the flow's motions are, before any droplet is seen in a step."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from dropflow.tracking.grid import Column
from dropflow.tracking.probable.waves import Waves

N_COMMON = 3
"""Unknowns that are no waves: mean velocity across `up`, along it, and the error of the sedimentation's factor."""
_MEAN_OVER_RMS = 3.0
"""A mean velocity of some times the rms is nothing unexpected."""
_LEAST_SHARE = 1e-9
_FAINTEST = -23.0
"""Logarithm of the least energy of a wave over that of the strongest; it must be possible to divide by it."""
_GAUSSIAN_BELOW = 1e-3
_UNRESOLVED = 5e-4
"""Share of the energy that waves need not have."""
_N_HALVINGS = 40


@dataclass(frozen=True)
class Spectrum:
    """A Gaussian random flow, the same everywhere and in all directions.

    Its stream function (and the potential of its divergent part) correlates as exp(-d^2 / (2 length^2)), or over a
    broader range of lengths where `broadness` is above 0: energies at wave number k are proportional to
    k^3 (1 + broadness (k length)^2 / 2)^-(2 + 1 / broadness), which is the Gaussian for broadness to 0.
    """

    rms_um_s: float
    """Of each component of the velocity."""
    length_px: float
    potential_share: float
    """Share of the energy in motion that has a divergence in the plane, 0 to 1."""
    broadness: float
    noise_um_s: float
    """Standard deviation of each component of what single droplets do beyond flow, Stokes and known errors."""

    def variances(self, waves: Waves, *, with_potential: bool, factor_variance: float) -> Column:
        """Prior variance of each unknown of `dropflow.tracking.probable.regression`."""
        per_wave = self.energies(waves)
        shares = [1 - self.potential_share, self.potential_share] if with_potential else [1.0]
        parts = [np.tile(per_wave * max(share, _LEAST_SHARE), 2) for share in shares]
        mean = (_MEAN_OVER_RMS * self.rms_um_s) ** 2
        return np.concatenate([[mean, mean, factor_variance], *parts])

    def energies(self, waves: Waves) -> Column:
        """Variance of the amplitude of each wave; their sum is twice the variance of a component of the velocity."""
        return _energies(self, waves)

    @property
    def finest_per_px(self) -> float:
        """Wave number beyond which `_UNRESOLVED` of the energy is left: 4.5 over the length, more where it is broad.

        With s = 1 + broadness (k length)^2 / 2 and p = 1 / broadness that share is s^-p (1 + p - p / s).
        """
        power = 1 / max(self.broadness, _GAUSSIAN_BELOW)
        low, high = 0.0, 100.0
        for _ in range(_N_HALVINGS):
            middle = (low + high) / 2
            log_share = -power * middle + np.log1p(power * -np.expm1(-middle))
            low, high = (middle, high) if log_share > np.log(_UNRESOLVED) else (low, middle)
        return float(np.sqrt(2 * power * np.expm1(low)) / self.length_px)

    def log_shape(self, waves: Waves) -> Column:
        """Logarithm of the energies, up to a constant."""
        squared = (waves.modulus_per_px * self.length_px) ** 2
        if self.broadness < _GAUSSIAN_BELOW:
            fall = squared / 2
        else:
            fall = (2 + 1 / self.broadness) * np.log1p(self.broadness * squared / 2)
        return np.asarray(2 * np.log(waves.modulus_per_px) - fall)


@lru_cache(maxsize=8)
def _energies(spectrum: Spectrum, waves: Waves) -> Column:
    """Kept, for both stay the same over many steps."""
    log_shape = spectrum.log_shape(waves)
    shape = np.exp(np.maximum(log_shape - log_shape.max(), _FAINTEST))
    return np.asarray(2 * spectrum.rms_um_s**2 * shape / shape.sum())
