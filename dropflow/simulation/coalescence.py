"""Which droplets touch, and which of those become one."""

import numba
import numpy as np
import numpy.typing as npt

from dropflow.simulation.cloud import Cloud, Coalescence, Origin

Column = npt.NDArray[np.float64]
Pairs = npt.NDArray[np.int64]


def coalesce(cloud: Cloud, *, efficiency: float, time_s: float, next_id: int) -> tuple[Cloud, list[Coalescence]]:
    """Merge droplets that touch in space: a new droplet with the volume of both at their common centre.

    Whether a pair merges or passes is decided once, by a hash of both ids: a share `efficiency` of all pairs merges.
    Products get the ids from `next_id` on. A droplet takes part in one event a call.
    """
    events: list[Coalescence] = []
    is_left = np.ones(len(cloud), bool)
    for i, j in merging_pairs(cloud, 0, efficiency):
        if is_left[i] and is_left[j]:
            is_left[[i, j]] = False
            events.append(_merge(cloud[np.array([i, j])], time_s, next_id + len(events)))
    if not events:
        return cloud, []
    x, y, z, r = np.array([(event.x_um, event.y_um, event.z_um, event.r_um) for event in events]).T
    ids = np.array([event.product for event in events], np.int64)
    products = Cloud(ids, x, y, z, r, np.full(len(events), Origin.COALESCENCE, np.int8))
    return cloud[is_left].followed_by(products), events


def without_early_merges(cloud: Cloud, n_old: int, efficiency: float) -> Cloud:
    """Leave out those droplets from index `n_old` on that would merge at once with another."""
    is_left = np.ones(len(cloud), bool)
    is_left[merging_pairs(cloud, n_old, efficiency)[:, 1]] = False
    return cloud[is_left]


def _merge(pair: Cloud, time_s: float, product: int) -> Coalescence:
    volumes = pair.r_um**3
    x, y, z = (float(np.average(axis, weights=volumes)) for axis in (pair.x_um, pair.y_um, pair.z_um))
    parents = (int(pair.droplet_id[0]), int(pair.droplet_id[1]))
    return Coalescence(time_s, parents, product, x, y, z, float(np.cbrt(volumes.sum())))


def merging_pairs(cloud: Cloud, n_old: int, efficiency: float) -> Pairs:
    """Indices (n, 2), i < j and j >= `n_old`, of droplets that touch and do not pass each other."""
    if efficiency == 0.0 or len(cloud) < 2:
        return np.empty((0, 2), np.int64)
    order = np.argsort(cloud.x_um)
    sorted_by_x = cloud[order]
    pairs = _touching(
        order,
        sorted_by_x.x_um,
        sorted_by_x.y_um,
        sorted_by_x.z_um,
        sorted_by_x.r_um,
        sorted_by_x.droplet_id,
        n_old,
        efficiency,
    )
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


@numba.njit(cache=True)
def _touching(
    order: npt.NDArray[np.int64],
    x: Column,
    y: Column,
    z: Column,
    r: Column,
    droplet_id: npt.NDArray[np.int64],
    n_old: int,
    efficiency: float,
) -> Pairs:
    largest = r.max()
    found = [(np.int64(0), np.int64(0))][:0]
    for a in range(order.size):
        for b in range(a + 1, order.size):
            if x[b] - x[a] > r[a] + largest:
                break
            touch = r[a] + r[b]
            if abs(y[b] - y[a]) > touch or max(order[a], order[b]) < n_old:
                continue
            if (x[b] - x[a]) ** 2 + (y[b] - y[a]) ** 2 + (z[b] - z[a]) ** 2 > touch * touch:
                continue
            if _chance(droplet_id[a], droplet_id[b]) < efficiency:
                found.append((min(order[a], order[b]), max(order[a], order[b])))
    pairs = np.empty((len(found), 2), np.int64)
    for k in range(len(found)):
        pairs[k, 0], pairs[k, 1] = found[k]
    return pairs


@numba.njit(cache=True)
def _chance(first: int, second: int) -> float:
    """A number from 0 to 1 that belongs to this pair of ids in either order (splitmix64)."""
    low, high = np.uint64(min(first, second)), np.uint64(max(first, second))
    state = low * np.uint64(0x9E3779B97F4A7C15) + high * np.uint64(0xD1B54A32D192ED03)
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return float((state ^ (state >> np.uint64(31))) >> np.uint64(11)) / 9007199254740992.0
