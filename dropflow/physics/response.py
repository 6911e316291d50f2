"""How fast a droplet follows the flow: response time and Stokes number (section 4.2)."""

import numpy as np
import numpy.typing as npt

_M_PER_UM = 1e-6


def response_time_s(r_um: npt.ArrayLike, *, density_kg_m3: float, viscosity_pa_s: float) -> npt.NDArray[np.float64]:
    """Stokes response time 2 rho r^2 / (9 eta), s, of spheres with radii of any shape.

    The paper prints the density difference here, as in the settling velocity (eq. 4). It is the mass of the sphere
    that makes it lag, so `density_kg_m3` should be the droplet's own density; with the difference in its place one
    gets the paper's numbers: 36 us for r = 40 um at 50 C.
    """
    radii_m = np.asarray(r_um, np.float64) * _M_PER_UM
    return np.asarray(2.0 / 9.0 * abs(density_kg_m3) * radii_m**2 / viscosity_pa_s)


def stokes_number(response_s: npt.ArrayLike, flow_time_s: float) -> npt.NDArray[np.float64]:
    """Response time over the time in which the flow changes; the velocities add up (eq. 5) where it is far below 1."""
    return np.asarray(np.asarray(response_s, np.float64) / flow_time_s)
