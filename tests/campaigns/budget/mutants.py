"""Budgets with a wrong term: does a test of the analysis notice?

Each mutant is put into a copy of the source tree, never into the tree itself, and the tests of the analysis are run
there. The unchanged copy must pass.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.kinds.wheel_on_belt.budget import TERMS

ROOT = Path(__file__).resolve().parents[3]
COPIED = ("tester", "drivers", "sim", "recipes", "tests", "pyproject.toml")
TESTS = tuple(f"tests/tester/analysis/test_{name}.py"
              for name in ("terms", "kelvin", "measurand", "reference", "uncertainty", "difference"))  # fmt: skip
_TERMS = "tester/store/older.py"
_MEASURAND, _KELVIN = "tester/analysis/measurand.py", "tester/analysis/kelvin.py"
_REFERENCE = "tester/analysis/reference.py"
_SIZES = (("removed", "0.0"), ("halved", "0.5"), ("doubled", "2.0"))


@dataclass(frozen=True, slots=True)
class Mutant:
    """One wrong term: a text in a file, replaced by another."""

    name: str
    path: str
    old: str
    new: str


def of_terms() -> Iterator[Mutant]:
    """Yield each term of the machine, removed, halved and doubled."""
    text = (ROOT / _TERMS).read_text(encoding="utf-8")
    for one in TERMS:
        head = re.search(rf'Term\("{re.escape(one.name)}", Acts\.\w+, ', text)
        if head is None:
            raise LookupError(f"no term {one.name} in {_TERMS}")
        for name, factor in _SIZES:
            yield Mutant(f"{one.name} {name}", _TERMS, head.group(), f"{head.group()}{factor} * ")


_BY_HAND = (
    ("repeatability", _MEASURAND, "contribution(REPEATABILITY, s, mu * share, df=float(pool.df)",
     "contribution(REPEATABILITY, {} * s, mu * share, df=float(pool.df)"),
    ("repeatability of its own", _MEASURAND, "contribution(REPEATABILITY, own, mu * share",
     "contribution(REPEATABILITY, {} * own, mu * share"),
    ("drift", _MEASURAND, '("drift", unsteady.drift_percent,', '("drift", {} * unsteady.drift_percent,'),
    ("carry-over", _MEASURAND, '("carry-over", unsteady.carry_over_percent,',
     '("carry-over", {} * unsteady.carry_over_percent,'),
    ("between replicates", _MEASURAND, "contribution(BETWEEN, s, mu", "contribution(BETWEEN, {} * s, mu"),
    ("repeatability of replicates", _MEASURAND, "own = Contribution(REPEATABILITY, repeats.standard / n",
     "own = Contribution(REPEATABILITY, {} * repeats.standard / n"),
    ("temperature sensitivity", _KELVIN, "self.slope.u_per_kelvin, mu * over_k",
     "{} * self.slope.u_per_kelvin, mu * over_k"),
    ("counterface", _REFERENCE, "rate = hypot(self.per_m, self.standard)",
     "rate = {} * hypot(self.per_m, self.standard)"),
    ("piece to piece in the counterface's drift", _REFERENCE, "(between * float(np.linalg.norm(",
     "({} * between * float(np.linalg.norm("),
    ("sliding of the piece in the counterface's drift", _REFERENCE, "abs(float(taken[-1])) * PIECE_PER_M",
     "{} * abs(float(taken[-1])) * PIECE_PER_M"),
    ("correction of temperature", _KELVIN, "exp(-self.slope.per_kelvin", "exp(-{} * self.slope.per_kelvin"),
)  # fmt: skip

OTHERS = (
    Mutant("common errors stay in a difference", "tester/analysis/difference.py",
           "abs(_error(one) - _error(other))", "abs(_error(one)) + abs(_error(other))"),
    Mutant("own errors of the second drop out", "tester/analysis/difference.py",
           "for found in budgets for one in found if not", "for found in budgets[:1] for one in found if not"),
    Mutant("degrees of freedom are forgotten", "tester/analysis/uncertainty.py",
           "return standard**4 / limited if limited > 0.0 else inf", "return inf"),
    Mutant("the wheel is in both measurands", _MEASURAND, "budget=budget(this)", "budget=budget([*this, *between])"),
    Mutant("the wheel is in neither", _MEASURAND, "budget([*this, *between, *by.counterface(mu)])",
           "budget(this)"),
    Mutant("the counterface is in no measurand", _MEASURAND,
           "budget([*this, *between, *by.counterface(mu)])", "budget([*this, *between])"),
    Mutant("the counterface is not in replicates", _MEASURAND,
           "budget([*found, *between, *by.counterface(mu)])", "budget([*found, *between])"),
    Mutant("the lag is not corrected", _KELVIN, "self.shown_c + lag_s * self.rate_k_s", "self.shown_c"),
)  # fmt: skip


def mutants() -> list[Mutant]:
    """Return all of them."""
    by_hand = (Mutant(f"{name} {size}", path, old, new.format(factor))
               for name, path, old, new in _BY_HAND for size, factor in _SIZES)  # fmt: skip
    return [*of_terms(), *by_hand, *OTHERS]


def survivors(hunted: list[Mutant]) -> list[str]:
    """Return the mutants that no test notices; raises RuntimeError where the unchanged copy does not pass."""
    with TemporaryDirectory() as name:
        copy = Path(name)
        for part in COPIED:
            source = ROOT / part
            if source.is_dir():
                shutil.copytree(source, copy / part, ignore=shutil.ignore_patterns("__pycache__"))
            else:
                shutil.copy(source, copy / part)
        if not _passes(copy):
            raise RuntimeError("the unchanged copy does not pass its tests")
        return [one.name for one in hunted if _lives(one, copy)]


def _lives(mutant: Mutant, copy: Path) -> bool:
    path = copy / mutant.path
    text = path.read_text(encoding="utf-8")
    if text.count(mutant.old) != 1:
        raise LookupError(f"{mutant.name}: {mutant.old!r} stands {text.count(mutant.old)} times in {mutant.path}")
    path.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
    try:
        return _passes(copy)
    finally:
        path.write_text(text, encoding="utf-8")


def _passes(copy: Path) -> bool:
    command = [sys.executable, "-B", "-m", "pytest", "-n", "0", "-q", "-x", "-p", "no:cacheprovider", *TESTS]
    done = subprocess.run(command, cwd=copy, capture_output=True, check=False,
                          env=os.environ | {"PYTHONPATH": str(copy)})  # fmt: skip
    if done.returncode not in (0, 1):
        raise RuntimeError(f"pytest ended with {done.returncode}: {done.stdout.decode()[-500:]}")
    return done.returncode == 0
