"""A page that the project cites is in the project, so that a reader can look it up."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = ("tester", "drivers", "sim", "recipes", "bench", "compiling", "docs", "tests")
ENDINGS = {".py", ".md", ".yaml", ".toml"}
PATHS = re.compile(r"(?<![\w./-])docs/[\w./-]*\w")
PAGES = re.compile(r"(?<![\w./*{}-])[\w-]+\.md\b")
DECISION = re.compile(r"docs/decisions/(\d{4})$")


def files() -> list[Path]:
    """Return what people read: source, pages, recipes."""
    found = [path for folder in SOURCES for path in (ROOT / folder).rglob("*") if path.suffix in ENDINGS]
    return [*found, *ROOT.glob("*.md"), *ROOT.glob("*.toml")]


def is_there(cited: str) -> bool:
    """Tell whether a path below the root exists; a decision may be cited by its number alone."""
    numbered = DECISION.search(cited)
    return (ROOT / cited).exists() or (numbered is not None and any((ROOT / "docs/decisions").glob(f"{numbered[1]}-*")))


def cited_wrongly(text: str) -> list[str]:
    """Return the paths of documents, and the names of pages, in a text that nothing in the project answers to."""
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
