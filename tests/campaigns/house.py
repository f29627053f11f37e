"""How learnable the tree is, in figures: code lines, small files, names, circles of imports, long functions, words.

    python -m tests.campaigns.house           # tester, drivers and sim; a second
    python -m tests.campaigns.house --list    # and what each figure counts

A line of code is neither blank, comment nor docstring. A small file has at most ``SMALL_LINES`` lines; ``__init__.py``,
which describes its folder, does not count. A name repeats where two folders hold a file of that name, unless one kind
mirrors another: the same path below ``tester/kinds/<kind>`` or ``sim/machines/<kind>``. Lines of code, and words that
are right in some sentences, have no limit: they are printed for comparison. Every figure is printed; the exit code is 1
if one misses its limit.
"""

from __future__ import annotations

import argparse
import ast
import io
import sys
import tokenize
from collections import defaultdict
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from tests.campaigns.prose import COUNTED, NEVER, NO_NAMES, wrong_names, wrong_phrases

ROOT = Path(__file__).parents[2]
PACKAGES = ("tester", "drivers", "sim")
SMALL_LINES, SMALL_FILES = 60, 60
REPEATED_NAMES = 25
FILE_LINES = 350
FUNCTION_LINES = 45
KINDS = (("tester", "kinds"), ("sim", "machines"))
"""Folders whose folders are kinds."""
_NO_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENCODING,
    tokenize.ENDMARKER,
}


@dataclass(frozen=True)
class Figure:
    """A count with its limit (None: printed only) and what was counted."""

    title: str
    count: int
    limit: int | None
    items: tuple[str, ...] = ()

    @property
    def misses(self) -> bool:
        """Return whether the count is above its limit."""
        return self.limit is not None and self.count > self.limit

    def __str__(self) -> str:
        asked = "" if self.limit is None else f"   at most {self.limit}: {'MISSES' if self.misses else 'holds'}"
        return f"{self.title:<44}{self.count:>8,}{asked}"


def _texts(tree: ast.AST) -> set[int]:
    """Return the lines of docstrings, also those behind a constant."""
    lines: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            lines.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return lines


def code_lines(source: str) -> int:
    """Return how many lines of a module are neither blank, comment nor docstring."""
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in _NO_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    return len(lines - _texts(ast.parse(source)))


def functions(source: str) -> Iterator[tuple[str, int]]:
    """Yield each function's name with its length in lines, from ``def`` to its end."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield node.name, (node.end_lineno or node.lineno) - node.lineno + 1


def place(path: Path) -> Path:
    """Return a path with ``*`` for its kind: files of one place mirror each other."""
    parts = path.parts
    return Path(*parts[:2], "*", *parts[3:]) if parts[:2] in KINDS and len(parts) > 3 else path


def repeated(paths: Iterable[Path]) -> dict[str, list[Path]]:
    """Return the files of each name that more than one place holds."""
    places: defaultdict[str, set[Path]] = defaultdict(set)
    files: defaultdict[str, list[Path]] = defaultdict(list)
    for path in paths:
        places[path.name].add(place(path))
        files[path.name].append(path)
    return {name: sorted(files[name]) for name in sorted(places) if len(places[name]) > 1}


def in_circles(sources: Mapping[Path, str]) -> list[Path]:
    """Return the modules that import each other in a circle, including imports in functions and for types, and the
    modules between two circles."""
    paths = {".".join(path.with_suffix("").parts).removesuffix(".__init__"): path for path in sources}
    above = {name: set(_imported(sources[path], paths)) - {name} for name, path in paths.items()}
    below = {name: {importer for importer in above if name in above[importer]} for name in above}
    # A module without imports, or without importers, is in no circle.
    while free := {name for name in above if not above[name] or not below[name]}:
        above = {name: names - free for name, names in above.items() if name not in free}
        below = {name: names - free for name, names in below.items() if name not in free}
    return sorted(paths[name] for name in above)


def _imported(source: str, known: Container[str]) -> Iterator[str]:
    """Yield the known modules that a module imports; a package only if a name comes from its ``__init__``."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                name = f"{node.module}.{alias.name}"
                if name in known or node.module in known:
                    yield name if name in known else node.module


def figures(sources: Mapping[Path, str]) -> tuple[Figure, ...]:
    """Return every figure of modules by their paths below the root."""
    lines = {path: len(source.splitlines()) for path, source in sources.items()}
    modules = sorted(path for path in sources if path.name != "__init__.py")
    small = [path for path in modules if lines[path] <= SMALL_LINES]
    names = repeated(modules)
    circles = in_circles(sources)
    long_files = [path for path in sorted(lines) if lines[path] > FILE_LINES]
    long_functions = [
        f"{path}: {name} has {length}"
        for path in sorted(sources)
        for name, length in functions(sources[path])
        if length > FUNCTION_LINES
    ]
    return (
        Figure("lines of code", sum(code_lines(source) for source in sources.values()), None),
        Figure("lines in all", sum(lines.values()), None),
        Figure("files", len(sources), None),
        Figure(f"files of at most {SMALL_LINES} lines", len(small), SMALL_FILES, _with_lines(small, lines)),
        Figure("file names that repeat and mirror no kind", len(names), REPEATED_NAMES, tuple(_in_words(names))),
        Figure("files in circles of imports", len(circles), 0, tuple(path.as_posix() for path in circles)),
        Figure(f"files above {FILE_LINES} lines", len(long_files), 0, _with_lines(long_files, lines)),
        Figure(f"functions above {FUNCTION_LINES} lines", len(long_functions), 0, tuple(long_functions)),
    )


def _with_lines(paths: Iterable[Path], lines: Mapping[Path, int]) -> tuple[str, ...]:
    return tuple(f"{path.as_posix()} has {lines[path]}" for path in paths)


def _in_words(names: Mapping[str, list[Path]]) -> Iterator[str]:
    for name, paths in names.items():
        yield f"{name}: {', '.join(path.parent.as_posix() for path in paths)}"


def modules() -> dict[Path, str]:
    """Return the text of every module of the three packages by its path below the root."""
    paths = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    return {path.relative_to(ROOT): path.read_text(encoding="utf-8") for path in paths}


def words() -> tuple[Figure, ...]:
    """Return how often pages, texts and names hold the words of ``tests.campaigns.prose``."""
    never = [*wrong_phrases(NEVER), *wrong_names(NO_NAMES)]
    counted = wrong_phrases(COUNTED)
    by_word = {word: [place for place in counted if place.word == word] for word in COUNTED}
    return (
        Figure("phrases and names that are never right", len(never), 0, tuple(map(str, never))),
        *(Figure(f'"{word}"', len(places), None, tuple(map(str, places))) for word, places in by_word.items()),
    )


def main() -> int:
    """Print the figures; return 1 if one misses."""
    parser = argparse.ArgumentParser(description="How learnable the tree is, in figures.")
    parser.add_argument("--list", action="store_true", help="print what each figure counts")
    listed = parser.parse_args().list
    counted = (*figures(modules()), *words())
    for figure in counted:
        print(figure)
        for item in figure.items if listed else ():
            print(f"    {item}")
    return int(any(figure.misses for figure in counted))


if __name__ == "__main__":
    sys.exit(main())
