"""Quality of a run over a range of time, at the resolution that is looked at."""

import numpy as np
import numpy.typing as npt

from backend.platform.object_store import QUALITY_FILE, ObjectStore
from backend.platform.packing import unpack
from backend.quality.schemas import Column, Quality
from backend.results.errors import NotYet
from backend.results.service import Asker
from dropflow.statistics.quality import FrameQuality


def over(asker: Asker, store: ObjectStore, from_s: float | None, to_s: float | None, max_columns: int) -> Quality:
    """Means over the frames in a range of time, at most `max_columns` of them."""
    product = asker.product("track")
    try:
        found = unpack(FrameQuality, store.read(product.prefix + QUALITY_FILE))
    except FileNotFoundError:  # made by a version that did not count it
        raise NotYet from None
    time_s = found.time_s
    is_inside = (time_s >= (-np.inf if from_s is None else from_s)) & (time_s <= (np.inf if to_s is None else to_s))
    frames = np.flatnonzero(is_inside)
    if not frames.size:
        return Quality(**{name: [] for name in Quality.model_fields})
    starts = frames[:: -(-frames.size // max_columns)]

    def total(values: npt.NDArray[np.generic]) -> npt.NDArray[np.float64]:
        ends = np.append(starts[1:], frames[-1] + 1)
        sums = np.concatenate([[0.0], np.cumsum(values, dtype=np.float64)])
        return np.asarray(sums[ends] - sums[starts])

    n_frames = total(np.ones(len(time_s)))
    n_tracked, n_predicted = total(found.n_tracked), total(found.n_predicted)
    return Quality(
        first_frame=starts.tolist(),
        time_s=(total(time_s) / n_frames).tolist(),
        n_detected=_shares(total(found.n_detected), n_frames),
        n_tracked=_shares(n_tracked, n_frames),
        predicted_share=_shares(n_predicted, n_tracked),
        match=_shares(total(found.match_sum), n_tracked - n_predicted),
        radius_std_share=_shares(total(found.radius_std_sum), total(found.n_radius_std)),
        residual_px=_shares(total(found.residual_squared_sum_px), total(found.n_residuals), power=0.5),
    )


def _shares(part: npt.NDArray[np.float64], whole: npt.NDArray[np.float64], *, power: float = 1.0) -> Column:
    return [
        float((above / below) ** power) if below > 0 and above >= 0 else None
        for above, below in zip(part, whole, strict=True)
    ]
