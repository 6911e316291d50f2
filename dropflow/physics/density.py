"""Density of pure fluids and of their mixture (section 2.1)."""

from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field

from dropflow.documents import StrictModel
from dropflow.errors import ExperimentError
from dropflow.physics.viscosity import SourceText

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

Floats = npt.NDArray[np.float64]

WATER_RANGE_C = (0.5, 99.0)
_ATMOSPHERE_MPA = 0.101325
_KNOT_SPACING_C = 2.0


class WaterDensity(StrictModel):
    """Water at 1 atm from IAPWS-95."""

    formulation: Literal["iapws-95"]
    source: SourceText
    """Where the numbers come from."""

    def at(self, temperature_c: npt.ArrayLike) -> Floats:
        """Density, kg/m3, between 0.5 and 99 C; any shape."""
        return water_density_kg_m3(temperature_c)


class ExpandingDensity(StrictModel):
    """A density at one temperature and a constant coefficient of thermal expansion."""

    reference_kg_m3: Annotated[float, Field(gt=0)]
    """Density at the reference temperature, kg/m3."""
    reference_temperature_c: float
    """C."""
    thermal_expansion_per_k: float
    """Relative growth of the volume per kelvin."""
    source: SourceText
    """Where the numbers come from."""

    def at(self, temperature_c: npt.ArrayLike) -> Floats:
        """Density, kg/m3; any shape."""
        warmer_k = np.asarray(temperature_c, np.float64) - self.reference_temperature_c
        return np.asarray(self.reference_kg_m3 / (1 + self.thermal_expansion_per_k * warmer_k))


def water_density_kg_m3(temperature_c: npt.ArrayLike) -> Floats:
    """Density of liquid water at 1 atm (IAPWS-95, from the `iapws` library), kg/m3; any shape.

    Between knots 2 K apart a cubic spline stands for the slow equation of state: within 1e-3 kg/m3.
    """
    t = np.asarray(temperature_c, np.float64)
    low, high = WATER_RANGE_C
    if np.any((t < low) | (t > high)):
        raise ExperimentError(
            f"The density of water is known from {low} to {high} °C only.", code="material.temperature_outside"
        )
    return np.asarray(_water_spline()(t))


@lru_cache(maxsize=1)
def _water_spline() -> "CubicSpline":
    from iapws import IAPWS95
    from scipy.interpolate import CubicSpline

    knots_c = np.arange(WATER_RANGE_C[0], WATER_RANGE_C[1] + _KNOT_SPACING_C, _KNOT_SPACING_C)
    knots_c = np.minimum(knots_c, 99.5)
    return CubicSpline(knots_c, [IAPWS95(T=t + 273.15, P=_ATMOSPHERE_MPA).rho for t in knots_c])


class ExcessVolume(StrictModel):
    """Excess molar volume as Redlich-Kister coefficients: V = x1 x2 sum_k A_k (x1 - x2)^k."""

    coefficients_cm3_mol: Annotated[tuple[float, ...], Field(min_length=1, max_length=12)]
    """A_0, A_1, ..., cm3/mol."""
    source: SourceText
    """Where the numbers come from."""

    def at(self, first_mole_fraction: npt.ArrayLike) -> Floats:
        """Excess molar volume, cm3/mol; any shape."""
        x1 = np.asarray(first_mole_fraction, np.float64)
        series = np.polynomial.polynomial.polyval(2 * x1 - 1, self.coefficients_cm3_mol)
        return np.asarray(x1 * (1 - x1) * series)


def mixture_density_kg_m3(
    composition: npt.ArrayLike,
    pure_kg_m3: tuple[npt.ArrayLike, npt.ArrayLike],
    molar_mass_g_mol: tuple[float, float],
    excess: ExcessVolume | None,
) -> Floats:
    """Density of a mixture, kg/m3: the mass of a mole over its volume, excess volume included.

    Parameters
    ----------
    composition
        Mass fraction of the second fluid, 0 to 1; broadcasts with the pure densities.
    pure_kg_m3
        Densities of the first and the second fluid at the temperature in question.
    molar_mass_g_mol
        Of the first and the second fluid.
    excess
        None mixes ideally.
    """
    phi = np.asarray(composition, np.float64)
    first_mol, second_mol = (1 - phi) / molar_mass_g_mol[0], phi / molar_mass_g_mol[1]
    moles_per_g = first_mol + second_mol
    volume_cm3 = (1 - phi) / (np.asarray(pure_kg_m3[0]) * 1e-3) + phi / (np.asarray(pure_kg_m3[1]) * 1e-3)
    if excess is not None:
        volume_cm3 = volume_cm3 + moles_per_g * excess.at(first_mol / moles_per_g)
    return np.asarray(1e3 / volume_cm3)
