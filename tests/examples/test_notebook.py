"""The notebook, executed against a running service."""

import os
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from tests.services import ROOT, RunningService

NOTEBOOK = ROOT / "examples" / "server.ipynb"


def test_it_is_committed_without_what_somebody_s_machine_said() -> None:
    for cell in nbformat.read(NOTEBOOK, as_version=4).cells:
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::ResourceWarning")  # of the kernel's sockets
def test_it_goes_from_a_folder_to_the_figures(
    service: RunningService, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DROPFLOW_SERVER", service.url)
    monkeypatch.setenv("DROPFLOW_CONFIG", str(tmp_path / "servers.yaml"))
    monkeypatch.setenv("PATH", f"{ROOT / '.venv' / 'bin'}{os.pathsep}{os.environ['PATH']}")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    NotebookClient(notebook, timeout=240, kernel_name="python3", resources={"metadata": {"path": tmp_path}}).execute()
    shown = [list(output.get("data", {})) for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("application/vnd.plotly.v1+json" in kinds for kinds in shown) == 3
    assert sum("text/html" in kinds for kinds in shown) >= 2  # the table and the dataset
    assert (tmp_path / "results" / "trajectories.parquet").is_file()
