"""Words of the tree that a native engineer would not say aloud: phrases and names that are never right, and others.

``house`` prints the counts; ``tests/test_prose.py`` requires that ``NEVER`` and ``NO_NAMES`` do not occur. Prose is
every page below ``docs``, the README, the changelog, and the comments and strings (docstrings, messages, help) of the
packages. The words of ``COUNTED`` are right in some sentences, so they are only counted.

    python -m tests.campaigns.prose SEED      # twenty docstrings and the names of five pages, drawn for a reader
"""

from __future__ import annotations

import ast
import io
import random
import re
import sys
import tokenize
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PACKAGES = ("tester", "drivers", "sim", "recipes")
PAGES = ("README.md", "CHANGELOG.md", "docs/**/*.md")
NEVER = ("is told", "are told", "was told", "is heard", "are heard", "goes on with", "go on with", "nobody minds")
"""Write "receives", "reports", "prints"; "resumes", "continues with"; "ignores"."""
NO_NAMES = ("told", "said", "heard", "nobody_minds")
"""Names of parameters and locals that do not describe their contents."""
COUNTED = (
    "goes on",
    "go on",
    "nobody",
    "somebody",
    "whoever",
    "stands",
    "says",
    "of which",
    "by which",
    "Tell whether",
)
_NO_PROSE = {tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT}


class Place(NamedTuple):
    """Where a word is: a file below the root, its line, and the word."""

    file: str
    line: int
    word: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.word}"


def prose_of(source: str) -> Iterator[tuple[int, str]]:
    """Yield comments and strings of a module with their first lines; adjacent ones are one text."""
    first, parts = 0, list[str]()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type in (tokenize.COMMENT, tokenize.STRING):
            first = first if parts else token.start[0]
            parts.append(token.string.strip("#rfb\"' "))
        elif token.type not in _NO_PROSE and parts:
            yield first, " ".join(parts)
            parts = []
    if parts:
        yield first, " ".join(parts)


def phrases(line: int, text: str, words: tuple[str, ...]) -> Iterator[tuple[int, str]]:
    """Yield each of the words that a text holds, wherever its lines break, with its line."""
    pattern = "|".join(r"\s+".join(map(re.escape, word.split())) for word in words)
    for match in re.finditer(rf"\b(?:{pattern})\b", text):
        yield line + text.count("\n", 0, match.start()), " ".join(match.group().split())


def names(source: str, words: tuple[str, ...]) -> Iterator[tuple[int, str]]:
    """Yield the parameters, locals, functions and attributes of a module that have one of these names."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name) | ast.FunctionDef(name=name):
                if name in words:
                    yield node.lineno, name
            case ast.Attribute(attr=name, ctx=ast.Store()) if name in words:
                yield node.lineno, name
            case _:
                pass


def wrong_phrases(words: tuple[str, ...], root: Path = ROOT) -> list[Place]:
    """Return where pages and packages hold one of the words."""
    places: list[Place] = []
    for path in (path for pattern in PAGES for path in sorted(root.glob(pattern))):
        text = path.read_text(encoding="utf-8")
        places += [Place(path.relative_to(root).as_posix(), *found) for found in phrases(1, text, words)]
    for path, source in _modules(root):
        for line, text in prose_of(source):
            places += [Place(path, *found) for found in phrases(line, text, words)]
    return places


def wrong_names(words: tuple[str, ...] = NO_NAMES, root: Path = ROOT) -> list[Place]:
    """Return where the packages give something one of these names."""
    return [Place(path, *found) for path, source in _modules(root) for found in names(source, words)]


def _modules(root: Path) -> Iterator[tuple[str, str]]:
    for path in sorted(path for package in PACKAGES for path in (root / package).rglob("*.py")):
        yield path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")


def drawn(seed: int, root: Path = ROOT) -> tuple[list[str], list[str]]:
    """Return twenty docstrings with their places and the names of five pages, drawn by a seed."""
    texts: list[str] = []
    for path, source in _modules(root):
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.Module)) and (text := ast.get_docstring(node)):
                name = getattr(node, "name", "")
                texts.append(f"{path}: {name}\n{text}\n")
    pages = [path.relative_to(root).as_posix() for pattern in PAGES for path in sorted(root.glob(pattern))]
    chance = random.Random(seed)
    return chance.sample(texts, 20), chance.sample(pages, 5)


if __name__ == "__main__":
    if len(sys.argv) != 2 or not sys.argv[1].isdigit():
        sys.exit("python -m tests.campaigns.prose SEED")
    print("\n".join(line for lines in drawn(int(sys.argv[1])) for line in lines))
