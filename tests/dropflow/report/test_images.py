"""Figures as files to print."""

import sys
from pathlib import Path

import pytest

from dropflow import figures
from dropflow.errors import DropflowError
from dropflow.physics.material_files import find_material
from dropflow.report.images import ImageFormat, write_images


def test_figures_are_written_as_files_to_print(tmp_path: Path) -> None:
    material = find_material("water-isobutoxyethanol-illustrative")
    (path,) = write_images({"phase-diagram": figures.phase_diagram(material)}, tmp_path / "new", ImageFormat.SVG)
    assert path.name == "phase-diagram.svg"
    assert "temperature T" in path.read_text()


def test_without_kaleido_files_to_print_are_refused_with_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "kaleido", None)
    with pytest.raises(DropflowError, match="figures"):
        write_images({}, tmp_path, ImageFormat.PNG)
