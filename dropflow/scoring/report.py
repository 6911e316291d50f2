"""All scores of a folder of results."""

import csv
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from dropflow.errors import ResultsError
from dropflow.scoring.detection import DetectionScore, score_detection
from dropflow.scoring.flow import FlowScore, read_flow, score_flow
from dropflow.scoring.isbi import IsbiScore, score_isbi
from dropflow.scoring.links import LinkScore, score_links
from dropflow.scoring.matching import match_to_truth
from dropflow.scoring.sizes import SizeScore, score_size_distribution
from dropflow.simulation.events import Kind
from dropflow.statistics.counted import COUNTED, counted_droplets


@dataclass(frozen=True)
class Report:
    """Scores of what was there, and the names of what was not."""

    detection: DetectionScore | None
    """Of ``droplets.parquet``."""
    tracked: DetectionScore | None
    """The same of the droplets in ``trajectories.parquet``."""
    links: LinkScore | None
    isbi: IsbiScore | None
    flow: FlowScore | None
    sizes_before: SizeScore | None
    """Of ``droplets.parquet``."""
    sizes_after: SizeScore | None
    """Of the droplets that the size distribution after tracking counts (`dropflow.statistics.counted`)."""
    missing: tuple[str, ...]

    def to_json(self) -> dict[str, Any]:
        """The report as plain values."""
        return asdict(self)


def score_results(results: Path, truth: Path) -> Report:
    """Score a folder of results, or a single table of droplets, against ``truth.parquet``.

    ``events.csv`` and ``truth_flow.zarr`` are looked for beside the truth.

    Raises
    ------
    ResultsError
        Where the truth or `results` cannot be read, or none of the tables is there.
    """
    true = _read(truth)
    is_folder = results.is_dir()
    droplets_file = results / "droplets.parquet" if is_folder else results
    files = {
        "droplets.parquet": droplets_file,
        "trajectories.parquet": results / "trajectories.parquet",
        "flow.zarr": results / "flow.zarr",
        "truth_flow.zarr": truth.with_name("truth_flow.zarr"),
    }
    missing = [name for name, path in files.items() if not path.exists()]
    if not is_folder and not droplets_file.is_file():
        raise ResultsError("There is no such file or folder.", code="results.missing", file=str(results))
    if len({"droplets.parquet", "trajectories.parquet", "flow.zarr"} & set(missing)) == 3:
        raise ResultsError(
            "There are no results here: no droplets.parquet, trajectories.parquet or flow.zarr.",
            code="results.missing",
            file=str(results),
        )
    before = None if "droplets.parquet" in missing else match_to_truth(_read(droplets_file), true)
    after = None if "trajectories.parquet" in missing else match_to_truth(_read(files["trajectories.parquet"]), true)
    counted = None if after is None else match_to_truth(counted_of(results, true), true)
    has_flow = not {"flow.zarr", "truth_flow.zarr"} & set(missing)
    return Report(
        detection=score_detection(before) if before else None,
        tracked=score_detection(after) if after else None,
        links=score_links(after, read_products(truth.with_name("events.csv"))) if after else None,
        isbi=score_isbi(after) if after else None,
        flow=score_flow(read_flow(files["flow.zarr"]), read_flow(files["truth_flow.zarr"])) if has_flow else None,
        sizes_before=score_size_distribution(before) if before else None,
        sizes_after=score_size_distribution(counted) if counted else None,
        missing=tuple(missing),
    )


def counted_of(results: Path, true: pa.Table) -> pa.Table:
    """The droplets that the size distribution after tracking counts, as the parameters of the results say."""
    pixel_size_um = float(true["r_um"][0].as_py() / true["r_px"][0].as_py()) if len(true) else 1.0
    try:
        about = (pq.read_schema(results / "trajectories.parquet").metadata or {}).get(b"dropflow", b"{}")
        tracking = json.loads(about).get("parameters", {}).get("tracking", {})
        out_of_focus = bool(tracking.get("count_out_of_focus"))
        rows = counted_droplets(results, pixel_size_um=pixel_size_um, out_of_focus=out_of_focus)
        return pa.concat_tables([COUNTED.empty_table(), *rows])
    except (pa.ArrowException, OSError, KeyError, ValueError) as problem:
        raise ResultsError(
            f"This is no Parquet table ({problem}).", code="results.unreadable", file=str(results)
        ) from None


def read_products(events: Path) -> dict[int, int]:
    """For each droplet that coalesced the id of what it became; none where there is no file."""
    if not events.is_file():
        return {}
    products = {}
    with events.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["kind"] == Kind.COALESCENCE:
                products[int(row["droplet_id"])] = products[int(row["other_id"])] = int(row["product_id"])
    return products


def _read(path: Path) -> pa.Table:
    try:
        return pq.read_table(path)
    except FileNotFoundError:
        raise ResultsError("There is no such file.", code="results.missing", file=str(path)) from None
    except (pa.ArrowInvalid, OSError) as problem:
        raise ResultsError(
            f"This is no Parquet table ({problem}).", code="results.unreadable", file=str(path)
        ) from None
