"""Everything the project cites exists in the project: pages, files, modules and their names."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

from tester.kinds import load_rig
from tests.tester.inputs.recipe.texts import rig

ROOT = Path(__file__).parents[1]
SOURCES = ("tester", "drivers", "sim", "recipes", "bench", "compiling", "docs", "tests")
ENDINGS = {".py", ".md", ".yaml", ".toml"}
PATHS = re.compile(r"(?<![\w./-])docs/[\w./-]*\w")
PAGES = re.compile(r"(?<![\w./*{}-])[\w-]+\.md\b")
DECISION = re.compile(r"docs/decisions/(\d{4})$")
CODE = r"(?:tester|drivers|sim|recipes|compiling|bench|tests)"
FILES = re.compile(rf"(?<![\w./:@-]){CODE}/[\w./*<>-]*[\w*>]")
"""A file or folder below the root; ``<kind>`` and ``*`` stand for any."""
MODULES = re.compile(rf"(?<![\w./-]){CODE}(?:\.\w+)+(?![\w/-])")
BARE = re.compile(r"(?<=`)(?!tester/|drivers/|sim/|tests/)[\w/]+\.py\b")
"""A file below a folder that the page has named before: ``process.py``, ``control/step.py``."""


def files() -> list[Path]:
    """Return the texts for readers: source, pages, recipes."""
    found = [path for folder in SOURCES for path in (ROOT / folder).rglob("*") if path.suffix in ENDINGS]
    return [*found, *ROOT.glob("*.md"), *ROOT.glob("*.toml")]


def is_there(cited: str) -> bool:
    """Return whether a path below the root exists, or is the number of a decision: the heading of a section."""
    numbered = DECISION.search(cited)
    return (ROOT / cited).exists() or (numbered is not None and int(numbered[1]) in decisions())


@cache
def decisions() -> list[int]:
    """Return the numbers of all decisions, by the headings of their pages."""
    pages = [path.read_text(encoding="utf-8") for path in (ROOT / "docs/decisions").glob("*.md")]
    return sorted(int(number) for text in pages for number in re.findall(r"^## (\d+)\. ", text, re.MULTILINE))


def test_every_decision_has_one_section_and_is_in_the_list_of_all() -> None:
    listed = re.findall(r"^(\d+)\. \[", (ROOT / "docs/decisions/README.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert decisions() == list(map(int, listed)) == list(range(1, len(listed) + 1))


def cited_wrongly(text: str) -> list[str]:
    """Return the paths of documents, and the names of pages, in a text that do not exist in the project."""
    names = {path.name for path in (*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"))}
    return sorted(
        {path for path in PATHS.findall(text) if not is_there(path)}
        | {page for page in PAGES.findall(text) if page not in names}
    )


def test_every_page_that_is_cited_is_in_the_project() -> None:
    wrong = {
        str(path.relative_to(ROOT)): found
        for path in files()
        if path != Path(__file__) and (found := cited_wrongly(path.read_text(encoding="utf-8")))
    }

    assert not wrong


@pytest.mark.parametrize("text", ["docs/absent.md", "docs/decisions/9999", "see absent.md, 5"])
def test_a_citation_of_nothing_is_found(text: str) -> None:
    assert cited_wrongly(text)


@pytest.mark.parametrize("text", ["docs/safety.md", "docs/decisions/0020", "README.md"])
def test_a_citation_of_a_page_is_none_of_those(text: str) -> None:
    assert not cited_wrongly(text)


def is_named(dotted: str) -> bool:
    """Return whether a dotted name is a module, a name in one, or a key of the packaged rig."""
    parts = dotted.split(".")
    for length in range(len(parts), 0, -1):
        place = ROOT.joinpath(*parts[:length])
        module = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
        if module.is_file() or (place.is_dir() and length == len(parts)):
            text = module.read_text(encoding="utf-8") if module.is_file() else ""
            if all(re.search(rf"\b{name}\b", text) for name in parts[length:]):
                return True
    return is_key(parts)


def is_key(parts: list[str]) -> bool:
    """Return whether a name is a key of a packaged rig file, such as ``sim.growth``."""
    return any(_is_key_of(place, parts) for place in (rig(), load_rig("grosch")))


def _is_key_of(place: object, parts: list[str]) -> bool:
    for part in parts:
        if not hasattr(place, part):
            return False
        place = getattr(place, part)
    return True


def led_nowhere(text: str) -> list[str]:
    """Return the missing files, folders, modules and names of code in a text."""
    known = ["/" + path.relative_to(ROOT).as_posix() for path in files()]
    return sorted(
        {path for path in FILES.findall(text) if not any(ROOT.glob(re.sub(r"<[^>]*>", "*", path)))}
        | {name for name in MODULES.findall(text) if not is_named(name)}
        | {name for name in BARE.findall(text) if not any(path.endswith("/" + name) for path in known)}
    )


@pytest.mark.parametrize(
    "page", sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]), ids=lambda page: str(page.relative_to(ROOT))
)
def test_code_that_a_page_names_is_there(page: Path) -> None:
    assert led_nowhere(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("text", ["`tester/gone/step.py`", "tester.machine.gone", "tests.faults", "`no_such.py`"])
def test_code_that_is_not_there_is_found(text: str) -> None:
    assert led_nowhere(text)


@pytest.mark.parametrize(
    "text",
    ["`sim/machines/<kind>`", "tester.base.plugins", "tester.kinds.kind.Kind", "tests.campaigns.faults", "`kind.py`"],
)
def test_code_that_is_there_is_not(text: str) -> None:
    assert not led_nowhere(text)
