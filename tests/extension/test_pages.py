"""The how-to pages quote the examples word for word."""

from __future__ import annotations

import re

import pytest
import yaml

from tester.kinds import load_rig
from tests.extension.counts import EXAMPLES, ROOT, files_of
from tests.extension.test_law import LAW

FILE = re.compile(r"<!-- file (?P<name>\S+) -->\n```\w+\n(?P<text>.*?)```", re.DOTALL)
PART = re.compile(r"<!-- part of the rig file -->\n```yaml\n(?P<text>.*?)```", re.DOTALL)


def page(name: str) -> str:
    return (ROOT / "docs" / "how-to" / f"{name}.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "example"),
    [
        ("add-a-format", "format"),
        ("add-a-law", "law"),
        ("add-an-axis", "axis"),
        ("add-an-interlock", "interlock"),
        ("add-a-kind-of-rig", "kind"),
    ],
)
def test_a_page_has_every_file_of_its_example(name: str, example: str) -> None:
    said = {found["name"]: found["text"] for found in FILE.finditer(page(name))}
    files = {path.relative_to(example).as_posix(): EXAMPLES / path for path in files_of(example)}
    assert said == {key: path.read_text(encoding="utf-8") for key, path in files.items()}


@pytest.mark.parametrize(
    ("name", "example"), [("a-profile-for-your-load-cell", "sensor"), ("choose-a-drive", "drive")]
)
def test_the_package_of_a_profile_is_that_of_the_example(name: str, example: str) -> None:
    said = {found["name"]: found["text"] for found in FILE.finditer(page(name))}
    assert said["pyproject.toml"] == (EXAMPLES / example / "pyproject.toml").read_text(encoding="utf-8")


def test_the_part_of_the_rig_file_matches_the_example() -> None:
    part = PART.search(page("add-a-law"))
    assert part is not None
    law = yaml.safe_load(part["text"])["sim"]["friction_model"]
    assert f"sim.friction_model={law}" == LAW and load_rig().sim.friction_model != law
