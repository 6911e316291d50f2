"""A smooth flow without divergence: a sum of random waves of a stream function, a function of place and time alone."""

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt
from scipy.special import ndtri

from dropflow.simulation.scenario import Scenario
from dropflow.tracking.grid import Grid

Column = npt.NDArray[np.float64]

TURN = 2.0 * np.pi


@dataclass(frozen=True)
class RandomFlow:
    """Velocity u = d(psi)/dy, v = -d(psi)/dx of psi = sum of a sin(kx x + ky y + omega t + phase), plus a drift.

    Wave vectors and frequencies are normal deviates (random Fourier features), so psi correlates as
    exp(-d^2 / (2 length^2) - dt^2 / (2 time^2)). The velocity through the focal plane, w(x, y, t), is another sum over
    the same waves and does not depend on depth: the flow has no divergence in three dimensions either.
    Lengths in um, x right, y down from the centre of the top left pixel.
    """

    kx_per_um: Column
    ky_per_um: Column
    omega_per_s: Column
    phase: Column
    amplitude_um2_s: Column
    depth_phase: Column
    depth_amplitude_um_s: Column
    drift_x_um_s: float
    drift_y_um_s: float

    def velocity_um_s(self, x_um: Column, y_um: Column, time_s: float) -> npt.NDArray[np.float64]:
        """Velocity at points (n,): shape (3, n), along x, along y and through the focal plane."""
        return np.asarray(
            _velocity(
                np.ascontiguousarray(x_um, np.float64),
                np.ascontiguousarray(y_um, np.float64),
                self.kx_per_um,
                self.ky_per_um,
                self.omega_per_s * time_s + self.phase,
                self.amplitude_um2_s,
                self.depth_phase,
                self.depth_amplitude_um_s,
                self.drift_x_um_s,
                self.drift_y_um_s,
            )
        )

    def on_grid(self, grid: Grid, *, pixel_size_um: float, time_s: float) -> npt.NDArray[np.float64]:
        """In-plane velocity at the centres of cells: shape (2, n_rows, n_columns), um/s."""
        x_um, y_um = np.meshgrid(grid.x_px * pixel_size_um, grid.y_px * pixel_size_um)
        velocity = self.velocity_um_s(x_um.ravel(), y_um.ravel(), time_s)
        return velocity[:2].reshape(2, grid.n_rows, grid.n_columns)


def random_flow(scenario: Scenario, rng: np.random.Generator) -> RandomFlow:
    """Draw a flow with the scenario's rms, correlation length and time, spectrum and drift.

    Moduli, directions and frequencies are stratified, so that even few waves have the wanted spectrum.
    """
    n = scenario.n_flow_modes
    broadening = np.exp(scenario.kspread * rng.standard_normal(n))
    modulus = np.sqrt(-2.0 * np.log1p(-_strata(n, rng))) / scenario.flow_length_um * broadening
    direction = 2.0 * np.pi * rng.permutation(_strata(n, rng))
    amplitude = 1.0 / broadening
    # <u^2> + <v^2> = sum of (a k)^2 / 2 must be twice the square of the rms of one component.
    amplitude *= 2.0 * scenario.flow_rms_um_s / np.sqrt(np.sum((amplitude * modulus) ** 2))
    return RandomFlow(
        kx_per_um=modulus * np.cos(direction),
        ky_per_um=modulus * np.sin(direction),
        omega_per_s=rng.permutation(ndtri(_strata(n, rng))) / scenario.flow_time_s,
        phase=rng.uniform(0.0, 2.0 * np.pi, n),
        amplitude_um2_s=amplitude,
        depth_phase=rng.uniform(0.0, 2.0 * np.pi, n),
        depth_amplitude_um_s=np.full(n, scenario.flow_depth_rms_um_s * np.sqrt(2.0 / n)),
        drift_x_um_s=scenario.drift_x_um_s,
        drift_y_um_s=scenario.drift_y_um_s,
    )


def _strata(n: int, rng: np.random.Generator) -> Column:
    """One random number from each of `n` equal parts of 0 to 1, in order."""
    return (np.arange(n) + rng.uniform(1e-6, 1.0 - 1e-6, n)) / n


@numba.njit(cache=True, error_model="numpy", fastmath=True)
def _velocity(
    x: Column,
    y: Column,
    kx: Column,
    ky: Column,
    phase: Column,
    amplitude: Column,
    depth_phase: Column,
    depth_amplitude: Column,
    drift_x: float,
    drift_y: float,
) -> npt.NDArray[np.float64]:
    velocity = np.empty((3, x.size))
    depth_cos = depth_amplitude * np.cos(depth_phase)
    depth_sin = depth_amplitude * np.sin(depth_phase)
    for i in range(x.size):
        u, v, w = drift_x, drift_y, 0.0
        for m in range(kx.size):
            # Sine and cosine from the half angle by Taylor series (to 1e-7 after the reduction to -pi .. pi): without
            # calls the loop runs in vector registers, five times as fast.
            angle = kx[m] * x[i] + ky[m] * y[i] + phase[m]
            half = 0.5 * (angle - TURN * np.floor(angle / TURN + 0.5))
            h = half * half
            s = half * (1 + h * (-1 / 6 + h * (1 / 120 + h * (-1 / 5040 + h * (1 / 362880 - h / 39916800)))))
            c = 1 + h * (-1 / 2 + h * (1 / 24 + h * (-1 / 720 + h * (1 / 40320 + h * (-1 / 3628800 + h / 479001600)))))
            sine, cosine = 2.0 * s * c, c * c - s * s
            u += amplitude[m] * ky[m] * cosine
            v -= amplitude[m] * kx[m] * cosine
            w += depth_cos[m] * cosine - depth_sin[m] * sine
        velocity[0, i], velocity[1, i], velocity[2, i] = u, v, w
    return velocity
