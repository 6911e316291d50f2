"""How well droplets were followed from one frame to the next."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dropflow.scoring.detection import share
from dropflow.scoring.matching import Matching, Rows
from dropflow.simulation.truth import Visibility


@dataclass(frozen=True)
class LinkScore:
    """Links between consecutive frames against truth. A number is None where nothing was there to count."""

    n_links: int
    """Links of the results."""
    n_true_links: int
    """Steps of true droplets that are visible in both frames."""
    n_right: int
    n_neutral: int
    precision: float | None
    recall: float | None


def score_links(matching: Matching, products: Mapping[int, int] | None = None) -> LinkScore:
    """Precision and recall of links, from the rows of trajectories in `matching`.

    A link is two rows of one trajectory in consecutive frames; a step over missing frames is none. It is right if both
    rows match the same true droplet. Links with an end at a borderline droplet are neutral, right or wrong, and so are
    links from a droplet to the one that it coalesced into. Precision is right over all but neutral links. Recall is
    the share of steps of droplets which are visible in both frames that have a right link.

    Parameters
    ----------
    matching : Matching
        Its results have a column `trajectory_id`.
    products : mapping, optional
        For each droplet that coalesced the id of what it became.
    """
    first, second = links_of(matching.results["trajectory_id"].to_numpy(), matching.results["frame"].to_numpy())
    droplet_id = np.append(matching.truth["droplet_id"].to_numpy(), -1)
    id_1, id_2 = (droplet_id[matching.truth_row[end]] for end in (first, second))
    is_right = (id_1 == id_2) & (id_1 >= 0)
    is_borderline = matching.is_matched_to(Visibility.BORDERLINE)
    is_neutral = is_borderline[first] | is_borderline[second] | _became(id_1, id_2, products or {})
    is_visible = matching.is_matched_to(Visibility.VISIBLE)
    n_found = int((is_right & is_visible[first] & is_visible[second]).sum())
    n_true = _n_true_links(matching)
    n_right = int((is_right & ~is_neutral).sum())
    return LinkScore(
        n_links=len(first),
        n_true_links=n_true,
        n_right=n_right,
        n_neutral=int(is_neutral.sum()),
        precision=share(n_right, len(first) - int(is_neutral.sum())),
        recall=share(n_found, n_true),
    )


def links_of(track_id: npt.NDArray[np.int64], frame: npt.NDArray[np.int32]) -> tuple[Rows, Rows]:
    """Rows of both ends of each link: the same track in consecutive frames."""
    order = np.lexsort((frame, track_id))
    is_link = (np.diff(track_id[order]) == 0) & (np.diff(frame[order]) == 1)
    return order[:-1][is_link], order[1:][is_link]


def _n_true_links(matching: Matching) -> int:
    is_visible = matching.truth_is(Visibility.VISIBLE)
    first, second = links_of(matching.truth["droplet_id"].to_numpy(), matching.truth["frame"].to_numpy())
    return int((is_visible[first] & is_visible[second]).sum())


def _became(
    id_1: npt.NDArray[np.int64], id_2: npt.NDArray[np.int64], products: Mapping[int, int]
) -> npt.NDArray[np.bool_]:
    """Whether the first droplet became the second by one or more coalescences."""
    became = np.zeros(len(id_1), bool)
    for link in np.flatnonzero(np.isin(id_1, list(products))):
        now = products.get(int(id_1[link]))
        while now is not None and now != id_2[link]:
            now = products.get(now)
        became[link] = now is not None
    return became
