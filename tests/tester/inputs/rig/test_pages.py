"""The pages made from, or about, keys and assumptions are up to date."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

from tester.kinds import PACKAGED, find

DOCS = Path(__file__).parents[4] / "docs"


@pytest.mark.parametrize("name", PACKAGED)
def test_the_page_names_the_keys_that_a_file_may_lack(name: str) -> None:
    keys = ", ".join(f"`{key}`" for key in find(name).rig().may_lack)
    assert f"| {name} | {keys} |" in (DOCS / "rig-file.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("folder", ["tester", "drivers", "sim"])
def test_every_assumption_of_the_code_is_in_the_list(folder: str) -> None:
    sections = re.split(r"^## ", runpy.run_path(str(DOCS / "assumptions.py"))["page_text"](), flags=re.MULTILINE)
    listed = {name: text.count("\n| ") - 1 for name, _, text in (part.partition("\n") for part in sections)}
    for path in (DOCS.parent / folder).rglob("*.py"):
        marked = sum("[A]" in line for line in path.read_text(encoding="utf-8").splitlines())
        assert listed.get(path.relative_to(DOCS.parent).as_posix(), 0) == marked, path


def test_an_assumption_is_named_by_its_number() -> None:
    marked = runpy.run_path(str(DOCS / "assumptions.py"))["marked"]
    source = 'A_S = 0.5\n"""How long [A]."""\nB = 3  # so many [A]\n'
    assert list(marked(source)) == [("A_S", "0.5", "How long [A]."), ("B", "3", "so many [A]")]
