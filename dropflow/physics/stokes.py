"""Sedimentation of a sphere in a viscous fluid."""

import numpy as np
import numpy.typing as npt

GRAVITY_M_S2 = 9.81
_M_PER_UM = 1e-6


def sedimentation_um_s(
    r_um: npt.ArrayLike, *, delta_density_kg_m3: float, viscosity_pa_s: float
) -> npt.NDArray[np.float64]:
    """Stokes velocity of spheres along `up`, the direction against gravity (eq. 4, section 3.2.1).

    The formula as printed, u_sed = 2/9 drho g r^2 / eta, is the speed of sinking: drho is the density of the droplet
    minus that of the fluid around it. Along `up` its sign turns: a lighter droplet (negative drho) rises.

    Parameters
    ----------
    r_um : array_like, any shape
        Radii, um.
    delta_density_kg_m3 : float
        Density of the droplet minus density of the fluid around it, kg/m3.
    viscosity_pa_s : float
        Dynamic viscosity of the fluid around the droplet, Pa s, greater than 0.

    Returns
    -------
    ndarray, float64, shape of `r_um`
        Velocity along `up`, um/s; negative where the droplet sinks.

    Notes
    -----
    Holds for a rigid sphere at Reynolds and Stokes number much below 1 (section 4.2), far from walls and neighbours.

    Examples
    --------
    >>> float(sedimentation_um_s(40.0, delta_density_kg_m3=-100.0, viscosity_pa_s=1e-3).round(1))
    348.8
    """
    radii_m = np.asarray(r_um, dtype=np.float64) * _M_PER_UM
    sinking_m_s = 2.0 / 9.0 * delta_density_kg_m3 * GRAVITY_M_S2 * radii_m**2 / viscosity_pa_s
    return -sinking_m_s / _M_PER_UM
