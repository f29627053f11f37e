"""One deliberate mistake in the code, and whether a test detects it.

Each mutant goes into a copy of the source tree, never into the tree itself, and the tests that should detect it run
there. The unchanged copy must pass them.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[3]
COPIED = ("tester", "drivers", "sim", "recipes", "tests", "pyproject.toml")
SIZES = (("removed", "0.0"), ("halved", "0.5"), ("doubled", "2.0"))
"""Replacements of a factor; ``SIGNED`` if the sign matters."""
SIGNED = (*SIZES, ("with the other sign", "-1.0"))


@dataclass(frozen=True, slots=True)
class Mutant:
    """A text in a file, replaced by another; ``tests``: the files that should detect it."""

    name: str
    path: str
    old: str
    new: str
    tests: tuple[str, ...]


def scaled(
    path: str, tests: Sequence[str], rows: Iterable[tuple[str, str, str]], by: Sequence[tuple[str, str]] = SIZES
) -> Iterator[Mutant]:
    """Yield mutants of a name, a text, and that text with {} where a factor goes."""
    for name, old, new in rows:
        for words, factor in by:
            yield Mutant(f"{name} {words}", path, old, new.format(factor), tuple(tests))


def tests_of(*names: str) -> tuple[str, ...]:
    """Return the files of tests of ``tests/tester`` by their names, such as analysis/terms."""
    return tuple(f"tests/tester/{folder}/test_{name}.py" for folder, _, name in (one.rpartition("/") for one in names))


def survivors(hunted: Sequence[Mutant]) -> Iterator[tuple[Mutant, bool]]:
    """Yield each mutant and whether it survives; raises RuntimeError if the unchanged copy does not pass."""
    with TemporaryDirectory() as name:
        copy = Path(name)
        for part in COPIED:
            source = ROOT / part
            if source.is_dir():
                shutil.copytree(source, copy / part, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy(source, copy / part)
        # Compiled once, by the hash of each source: a mutant is read again even if size and second stay the same.
        compiled = [sys.executable, "-m", "compileall", "-q", "--invalidation-mode", "checked-hash"]
        subprocess.run([*compiled, *COPIED[:4]], cwd=copy, check=True)
        every = tuple(dict.fromkeys(file for one in hunted for file in one.tests))
        if every and not _passes(copy, every):
            raise RuntimeError("the unchanged copy does not pass its tests")
        for one in hunted:
            yield one, _lives(one, copy)


def _lives(mutant: Mutant, copy: Path) -> bool:
    path = copy / mutant.path
    text = path.read_text(encoding="utf-8")
    if text.count(mutant.old) != 1:
        raise LookupError(f"{mutant.name}: {mutant.old!r} stands {text.count(mutant.old)} times in {mutant.path}")
    path.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
    try:
        return _passes(copy, mutant.tests)
    finally:
        path.write_text(text, encoding="utf-8")


def _passes(copy: Path, tests: Sequence[str]) -> bool:
    command = [sys.executable, "-B", "-m", "pytest", "-o", "addopts=", "-q", "-x", "-p", "no:cacheprovider", *tests]
    plain = {"PYTHONPATH": str(copy), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # do not wait for plugins' imports
    done = subprocess.run(command, cwd=copy, capture_output=True, check=False, env=os.environ | plain)
    if done.returncode not in (0, 1, 2):  # 2: the mutant breaks the import of modules
        raise RuntimeError(f"pytest ended with {done.returncode}: {done.stdout.decode()[-500:]}")
    return done.returncode == 0
