"""The disturbance that sedimenting droplets make in the flow around each other."""

import numba
import numpy as np
import numpy.typing as npt

from dropflow.simulation.cloud import Cloud

Column = npt.NDArray[np.float64]


def wake_um_s(
    cloud: Cloud, rise_um_s: Column, up: tuple[float, float], *, strength: float, range_um: float
) -> npt.NDArray[np.float64]:
    """Velocity that all droplets give to each one, shape (3, n), um/s.

    Each droplet drags the fluid like a point force (Stokeslet): at distance d in direction e, a droplet of radius r
    that rises with speed U along `up` adds 3/4 r U / d (up + (up . e) e). Inside the sum of both radii the value
    there is taken; towards `range_um` it is faded out, as the walls and the other droplets screen it.
    """
    return np.asarray(
        _stokeslets(cloud.x_um, cloud.y_um, cloud.z_um, cloud.r_um, strength * rise_um_s, up[0], up[1], range_um)
    )


@numba.njit(cache=True, error_model="numpy")
def _stokeslets(
    x: Column, y: Column, z: Column, r: Column, rise: Column, up_x: float, up_y: float, range_um: float
) -> npt.NDArray[np.float64]:
    wake = np.zeros((3, x.size))
    order = np.argsort(x)
    for a in range(order.size):
        for b in range(a + 1, order.size):
            i, j = order[a], order[b]
            dx, dy, dz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
            if dx > range_um:
                break
            d2 = dx * dx + dy * dy + dz * dz
            if d2 >= range_um * range_um or d2 == 0.0:
                continue
            d = np.sqrt(d2)
            fade = (1.0 - d2 / (range_um * range_um)) ** 2
            scale = 0.75 * fade / max(d, r[i] + r[j])
            along = (up_x * dx + up_y * dy) / d2
            from_i, from_j = scale * r[i] * rise[i], scale * r[j] * rise[j]
            to_x, to_y, to_z = up_x + along * dx, up_y + along * dy, along * dz
            wake[0, j] += from_i * to_x
            wake[1, j] += from_i * to_y
            wake[2, j] += from_i * to_z
            wake[0, i] += from_j * to_x
            wake[1, i] += from_j * to_y
            wake[2, i] += from_j * to_z
    return wake
