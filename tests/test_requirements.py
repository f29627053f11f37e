"""docs/requirements-tested.txt: every package that pyproject.toml asks for, within its range, with hashes."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
TEXT = (ROOT / "docs" / "requirements-tested.txt").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
WANTED = [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["test"]]
ENTRIES = [
    entry for entry in re.sub(r"\\\n", " ", re.sub(r"^#.*\n", "", TEXT, flags=re.MULTILINE)).splitlines() if entry
]
COMMANDS = (
    "pip install --require-hashes -r docs/requirements-tested.txt",
    "pip install --no-deps --no-build-isolation .",
)


def pinned() -> dict[str, str]:
    """Return the version of every package in the file, by its canonical name."""
    found: dict[str, str] = {}
    for entry in ENTRIES:
        (specifier,) = Requirement(entry.partition(" --hash")[0]).specifier
        assert specifier.operator == "=="
        found[canonicalize_name(Requirement(entry.partition(" --hash")[0]).name)] = specifier.version
    return found


@pytest.mark.parametrize("text", WANTED)
def test_every_required_package_is_there_within_its_range(text: str) -> None:
    wanted = Requirement(text)
    version = pinned().get(canonicalize_name(wanted.name))
    assert version is not None, f"{wanted.name} is missing: make the file anew, as its head says"
    assert wanted.specifier.contains(version), f"{wanted.name} {version} is not {wanted.specifier}"


def test_every_package_has_its_hashes() -> None:
    for entry in ENTRIES:
        hashes = entry.partition(" --hash")[1:]
        assert re.fullmatch(r"( *--hash=sha256:[0-9a-f]{64})+ *", "".join(hashes)), entry[:60]


def test_no_registry_is_named() -> None:
    assert "://" not in TEXT and "index" not in "".join(ENTRIES)


def test_the_file_and_the_readme_state_both_commands() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert all(command in TEXT and command in readme for command in COMMANDS)
