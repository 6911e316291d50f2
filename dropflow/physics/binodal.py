"""The binodal: compositions of the two coexisting phases against temperature (Fig. 1, section 2.1)."""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Protocol

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from dropflow.documents import StrictModel
from dropflow.errors import ExperimentError
from dropflow.physics.viscosity import SourceText

Floats = npt.NDArray[np.float64]

LEFT_ORDER, RIGHT_ORDER = 6, 4
ZERO_C_IN_K = 273.15
_CURVE_POINTS = 20_001
_SLOPE_POINTS = 200
_LEAST_SLOPE = 0.01
"""Of the mean slope of a branch: what a fit rises by at least where the table is flat."""


class Binodal(Protocol):
    """Compositions (mass fractions of the second fluid) of both phases; asking outside its range is an error."""

    @property
    def range_c(self) -> tuple[float, float]:
        """Temperatures between which it is known."""
        ...

    def phases(self, temperature_c: npt.ArrayLike) -> tuple[Floats, Floats]:
        """Composition of the bottom and of the top phase; shapes of `temperature_c`."""
        ...

    def half_width(self, temperature_c: npt.ArrayLike) -> Floats:
        """Phi_0 = (Phi_t - Phi_b) / 2."""
        ...

    def half_width_slope_per_k(self, temperature_c: npt.ArrayLike) -> Floats:
        """The derivative of Phi_0 by temperature."""
        ...


class ScalingBinodal(StrictModel):
    """Phi_c + D t +- B t^beta, with t = (T - Tc) / Tc and Tc in kelvin: symmetric about a straight diameter."""

    critical_temperature_c: float
    """Tc of a lower critical point, C."""
    critical_composition: Annotated[float, Field(gt=0, lt=1)]
    """Phi_c, mass fraction of the second fluid."""
    exponent: Annotated[float, Field(gt=0, lt=1)]
    """beta."""
    amplitude: Annotated[float, Field(gt=0)]
    """B."""
    diameter_slope: float
    """D."""
    highest_temperature_c: float
    """Up to where it may be used, C."""
    source: SourceText
    """Where the numbers come from."""

    @property
    def range_c(self) -> tuple[float, float]:
        """From the critical point to the highest temperature."""
        return (self.critical_temperature_c, self.highest_temperature_c)

    def phases(self, temperature_c: npt.ArrayLike) -> tuple[Floats, Floats]:
        """Composition of the bottom and of the top phase."""
        middle = self.critical_composition + self.diameter_slope * self._distance(temperature_c)
        half = self.half_width(temperature_c)
        return np.asarray(middle - half), np.asarray(middle + half)

    def half_width(self, temperature_c: npt.ArrayLike) -> Floats:
        """Phi_0 = B t^beta."""
        return np.asarray(self.amplitude * self._distance(temperature_c) ** self.exponent)

    def half_width_slope_per_k(self, temperature_c: npt.ArrayLike) -> Floats:
        """Equal to beta Phi_0 / (T - Tc); infinite at the critical point."""
        half = self.half_width(temperature_c)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.exponent * half / (np.asarray(temperature_c) - self.critical_temperature_c))

    def _distance(self, temperature_c: npt.ArrayLike) -> Floats:
        t = inside(temperature_c, self.range_c)
        return np.asarray((t - self.critical_temperature_c) / (self.critical_temperature_c + ZERO_C_IN_K))


class BinodalPoint(StrictModel):
    """One measured temperature of the phase diagram."""

    temperature_c: float
    bottom: Annotated[float, Field(ge=0, le=1)]
    top: Annotated[float, Field(ge=0, le=1)]


class TableBinodal(StrictModel):
    """A measured table. Each branch is fitted as T(Phi), sixth order on the left, fourth order on the right (Fig. 1).

    T is fitted against Phi and not the other way round, for near a critical point T(Phi) is smooth and flat while
    Phi(T) has an infinite slope that no polynomial follows.
    """

    points: Annotated[tuple[BinodalPoint, ...], Field(min_length=8, max_length=10_000)]
    """Rising in temperature."""
    source: SourceText
    """Where the numbers come from."""

    @model_validator(mode="after")
    def _rises(self) -> "TableBinodal":
        t, bottom, top = self._columns
        if np.any(np.diff(t) <= 0):
            raise ValueError("temperatures must rise from point to point")
        if np.any(bottom >= top) or np.any(np.diff(bottom) > 0) or np.any(np.diff(top) < 0):
            raise ValueError("the miscibility gap (bottom < top) must widen with temperature")
        return self

    @property
    def range_c(self) -> tuple[float, float]:
        """Lowest and highest temperature of the table."""
        return (self.points[0].temperature_c, self.points[-1].temperature_c)

    @property
    def residual_k(self) -> tuple[float, float]:
        """Root mean square distance of the table from the fits, left and right, K."""
        return (self._left.residual_k, self._right.residual_k)

    def phases(self, temperature_c: npt.ArrayLike) -> tuple[Floats, Floats]:
        """Composition of the bottom and of the top phase."""
        t = inside(temperature_c, self.range_c)
        return self._left.composition(t), self._right.composition(t)

    def half_width(self, temperature_c: npt.ArrayLike) -> Floats:
        """Phi_0 = (Phi_t - Phi_b) / 2."""
        bottom, top = self.phases(temperature_c)
        return np.asarray((top - bottom) / 2)

    def half_width_slope_per_k(self, temperature_c: npt.ArrayLike) -> Floats:
        """From the derivatives of both fits."""
        bottom, top = self.phases(temperature_c)
        return np.asarray((self._right.slope_per_k(top) - self._left.slope_per_k(bottom)) / 2)

    @property
    def _columns(self) -> tuple[Floats, Floats, Floats]:
        table = np.array([(point.temperature_c, point.bottom, point.top) for point in self.points])
        return table[:, 0], table[:, 1], table[:, 2]

    @cached_property
    def _left(self) -> "_Branch":
        t, bottom, _ = self._columns
        return _fit_branch(bottom, t, LEFT_ORDER)

    @cached_property
    def _right(self) -> "_Branch":
        t, _, top = self._columns
        return _fit_branch(top, t, RIGHT_ORDER)


@dataclass(frozen=True)
class _Branch:
    """T(Phi) of one side, and its inverse as a fine curve."""

    fit: Any
    curve_c: Floats
    curve_composition: Floats
    residual_k: float

    def composition(self, temperature_c: Floats) -> Floats:
        return np.asarray(np.interp(temperature_c, self.curve_c, self.curve_composition))

    def slope_per_k(self, composition: Floats) -> Floats:
        return np.asarray(1 / self.fit.deriv()(composition))


def _fit_branch(composition: Floats, temperature_c: Floats, order: int) -> _Branch:
    # A little past the table, so that the fit reaches the table's first and last temperature.
    past = 0.05 * (composition[-1] - composition[0])
    curve = np.linspace(composition[0] - past, composition[-1] + past, _CURVE_POINTS)
    fit = np.polynomial.Chebyshev.fit(composition, temperature_c, order, domain=(curve.min(), curve.max()))
    if np.any(np.diff(fit(curve)) <= 0):
        fit = _rising(fit, composition, temperature_c)
    residual_k = float(np.sqrt(np.mean((fit(composition) - temperature_c) ** 2)))
    return _Branch(fit, np.asarray(fit(curve)), curve, residual_k)


def _rising(free: Any, composition: Floats, temperature_c: Floats) -> Any:
    """The best polynomial of the same order that rises all along the branch: a free one may dip where T is flat."""
    from scipy.optimize import minimize

    basis = np.polynomial.chebyshev.chebvander(free.mapparms()[0] + free.mapparms()[1] * composition, free.degree())
    places = np.linspace(-1, 1, _SLOPE_POINTS)
    unit = np.eye(free.degree() + 1)
    slopes = np.stack([np.polynomial.Chebyshev(row).deriv()(places) for row in unit], axis=1)
    sign = np.sign((temperature_c[-1] - temperature_c[0]) * (composition[-1] - composition[0]))
    least = _LEAST_SLOPE * (temperature_c[-1] - temperature_c[0]) / 2
    scale = float(np.ptp(temperature_c))
    found = minimize(
        lambda c: float(((basis @ c - temperature_c) ** 2).sum()) / scale,
        free.coef,
        jac=lambda c: 2 * basis.T @ (basis @ c - temperature_c) / scale,
        method="SLSQP",
        constraints={"type": "ineq", "fun": lambda c: sign * (slopes @ c) - least, "jac": lambda _: sign * slopes},
        options={"maxiter": 500, "ftol": 1e-12},
    )
    fit = np.polynomial.Chebyshev(found.x, domain=free.domain)
    if not found.success or np.any(sign * (slopes @ found.x) <= 0):
        raise ExperimentError(
            f"No rising polynomial of order {free.degree()} follows the binodal's table.",
            code="material.binodal_not_monotonic",
            hint="Give more points, or the scaling form.",
        )
    return fit


def inside(temperature_c: npt.ArrayLike, range_c: tuple[float, float]) -> Floats:
    """`temperature_c` as an array; raise `ExperimentError` where it is outside the range."""
    t = np.asarray(temperature_c, np.float64)
    low, high = range_c
    if not np.all((t >= low) & (t <= high)):
        raise ExperimentError(
            f"The binodal is known from {low:g} to {high:g} °C, not at {float(t.min()):g} to {float(t.max()):g} °C.",
            code="material.temperature_outside",
        )
    return t
