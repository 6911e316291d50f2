"""Viscosity of pure fluids and of their mixture (appendix, eqs. 10 to 12)."""

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import Field

from dropflow.documents import StrictModel

Floats = npt.NDArray[np.float64]
SourceText = Annotated[str, Field(min_length=1, max_length=2000)]


class PureViscosity(StrictModel):
    """The four coefficients of eq. (10), as in Table 1."""

    a_pa_s: Annotated[float, Field(gt=0)]
    """Viscosity at 20 C, Pa s."""
    b: float
    c_per_k: float
    d_c: float
    source: SourceText
    """Where the numbers come from."""

    def at(self, temperature_c: npt.ArrayLike) -> Floats:
        """Eq. (10): A * 10 ** ((B (20 - T) - C (T - 20)^2) / (T + D)), Pa s, T in C; any shape."""
        t = np.asarray(temperature_c, np.float64)
        exponent = (self.b * (20 - t) - self.c_per_k * (t - 20) ** 2) / (t + self.d_c)
        return np.asarray(self.a_pa_s * 10**exponent)


class CompositionViscosity(StrictModel):
    """A polynomial in the mass fraction at one temperature (eq. 11)."""

    coefficients_mpa_s: Annotated[tuple[float, ...], Field(min_length=1, max_length=12)]
    """Coefficients of Phi^0, Phi^1, ..., mPa s."""
    temperature_c: float
    """Temperature at which it was measured, C."""
    source: SourceText
    """Where the numbers come from."""

    def at(self, composition: npt.ArrayLike) -> Floats:
        """Eq. (11): viscosity at the temperature of the measurement, Pa s; composition as mass fraction, any shape."""
        phi = np.asarray(composition, np.float64)
        return np.asarray(np.polynomial.polynomial.polyval(phi, self.coefficients_mpa_s) * 1e-3)


def rescaled_viscosity(
    composition: npt.ArrayLike, mixed: CompositionViscosity, pure: Sequence[PureViscosity]
) -> npt.NDArray[np.float64]:
    """The weight of the second fluid's viscosity in eq. (12), from eq. (11) and the pure fluids where it was measured.

    It is not bound to 0..1: a mixture may be more viscous than either fluid.
    """
    first, second = (fluid.at(mixed.temperature_c) for fluid in pure)
    return np.asarray((mixed.at(composition) - first) / (second - first))


def mixture_viscosity_pa_s(
    composition: npt.ArrayLike,
    temperature_c: npt.ArrayLike,
    mixed: CompositionViscosity,
    pure: Sequence[PureViscosity],
) -> npt.NDArray[Any]:
    """Eq. (12): viscosity of a mixture, Pa s.

    Parameters
    ----------
    composition
        Mass fraction of the second fluid, 0 to 1; broadcasts with `temperature_c`.
    temperature_c
        C.
    mixed
        Eq. (11) at its temperature.
    pure
        Eq. (10) of the first fluid (composition 0) and the second (composition 1).

    Notes
    -----
    The weight is taken as independent of temperature; the authors found their two phases to follow it within 2 % at
    40 C. At its ends the mixture is as far from the pure fluids as the polynomial is (2 % for water).
    """
    weight = rescaled_viscosity(composition, mixed, pure)
    first, second = (fluid.at(temperature_c) for fluid in pure)
    return np.asarray(weight * second + (1 - weight) * first)
