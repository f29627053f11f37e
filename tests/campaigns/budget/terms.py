"""Mutants of every term of both machines' measuring chains, and of the way each acts."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from tester.analysis.terms import Term
from tester.kinds.specimen_on_track.budget import TERMS as TRACK
from tester.kinds.wheel_on_belt.budget import TERMS as WHEEL
from tests.campaigns.budget.mutant import ROOT, SIGNED, SIZES, Mutant, scaled, tests_of

_WHEEL_TESTS = tests_of("analysis/terms", "analysis/kelvin")
_TRACK_TESTS = tests_of("kinds/specimen_on_track/track_budget")
KINDS: Final = (
    ("wheel", "tester/kinds/wheel_on_belt/budget.py", WHEEL, _WHEEL_TESTS),
    ("track", "tester/kinds/specimen_on_track/budget.py", TRACK, _TRACK_TESTS),
)
"""Each kind's name, the file of its terms, the terms, and the tests that should detect a mutant."""
OTHER_WAY: Final = {
    "FRICTION": "NORMAL", "NORMAL": "FRICTION", "ROTATION": "COEFFICIENT", "CROSSTALK": "COEFFICIENT",
    "TEMPERATURE": "COEFFICIENT", "LAG": "TEMPERATURE", "SLIDING": "COEFFICIENT", "SIZE": "SLIDING", "LOSS": "SIZE",
    "PIECE": "FRICTION",
}  # fmt: skip
"""A wrong way of acting for each."""
_FORMULAS: Final = (
    ("friction force", "plain = 1.0 / load", "plain = {} * 1.0 / load"),
    ("normal force", "plain = mu / load", "plain = {} * mu / load"),
    ("rotation", "plain = (1.0 + mu * mu) * pi / 180.0", "plain = {} * (1.0 + mu * mu) * pi / 180.0"),
    ("rotation's own part", "(1.0 + mu * mu)", "(1.0 + {} * 1.5 * mu * mu)"),
    ("crosstalk", "plain = hypot(1.0, mu * mu)", "plain = {} * hypot(1.0, mu * mu)"),
    ("crosstalk of friction on load", "hypot(1.0, mu * mu)", "hypot(1.0, {} * 1.5 * mu * mu)"),
    ("temperature", "plain = mu * at.per_kelvin", "plain = {} * mu * at.per_kelvin"),
    ("lag", "return mu * at.per_kelvin * at.rate_k_s", "return {} * mu * at.per_kelvin * at.rate_k_s"),
    ("sliding", "plain = mu / sliding", "plain = {} * mu / sliding"),
    ("size", "plain = mu * at.speed(term.channel)", "plain = {} * mu * at.speed(term.channel)"),
    ("coefficient", "            plain = mu\n", "            plain = {} * mu\n"),
    ("a term's factor", "return term.factor * plain", "return {} * term.factor * plain"),
    ("what both directions leave of a rotation", "return mu * radians(term.bound)",
     "return {} * mu * radians(term.bound)"),
    ("what both directions leave of crosstalk", "return mu * term.bound", "return {} * mu * term.bound"),
    ("what two tares leave", "return sqrt(0.5) if independent", "return {} * sqrt(0.5) if independent"),
    ("a channel's mean", "standard *= abs(at.means.get(term.channel, NAN))",
     "standard *= {} * abs(at.means.get(term.channel, NAN))"),
    ("the speed that a diameter makes", "standard *= at.speed(term.channel) if term.channel else 1.0",
     "standard *= {} * at.speed(term.channel) if term.channel else 1.0"),
    ("the loss", "standard *= abs(at.size.loss_mm)", "standard *= {} * abs(at.size.loss_mm)"),
    ("the loss by a check", "source, distribution = at.size.checked_u_mm, at",
     "source, distribution = {} * at.size.checked_u_mm, at"),
)  # fmt: skip
_SPREADS: Final = (
    ("a rectangle's spread", '"rectangular": 1.0 / sqrt(3.0)', '"rectangular": {} * 1.0 / sqrt(3.0)'),
    ("a U's spread", '"U-shaped": 1.0 / sqrt(2.0)', '"U-shaped": {} * 1.0 / sqrt(2.0)'),
    ("a normal one's spread", '"normal": 1.0}', '"normal": {} * 1.0}}'),
)


def of_terms() -> Iterator[Mutant]:
    """Yield each term of both kinds: removed, halved, doubled, of another distribution, acting and shared otherwise."""
    for kind, path, terms, tests in KINDS:
        written = _written(path)
        for one in terms:
            text = written[one.name]
            for words, new in _wrong(one, text):
                yield Mutant(f"{kind}: {one.name} {words}", path, text, new, tests)


def of_formulas() -> Iterator[Mutant]:
    """Yield each way in which an error reaches the coefficient, by a wrong factor or sign, and each distribution."""
    path, tests = "tester/analysis/terms.py", (*_WHEEL_TESTS, *_TRACK_TESTS)
    # The sign of a sensitivity is a convention; a sensitivity of either sign must keep its sign.
    of_either = {"temperature", "lag"}
    yield from scaled(path, tests, [one for one in _FORMULAS if one[0] in of_either], SIGNED)
    yield from scaled(path, tests, [one for one in _FORMULAS if one[0] not in of_either])
    yield from scaled(path, tests, _SPREADS, [one for one in SIZES if one[0] != "removed"])
    yield Mutant("what both directions leave is forgotten", path, "if at.turning is not None else 1.0)",
                 "if at.turning is None else 1.0)", tests)  # fmt: skip
    yield Mutant("a check is not believed", path, "if at.size.checked:", "if not at.size.checked:", tests)
    yield Mutant("the slowest sliding", path, "SLOWEST_M_S: Final = 0.1", "SLOWEST_M_S: Final = 0.2", tests)


def _wrong(one: Term, text: str) -> Iterator[tuple[str, str]]:
    head = f'Term("{one.name}", Acts.{one.acts.name}, '
    for words, factor in SIZES:
        yield words, text.replace(head, f"{head}{factor} * ")
    other = "rectangular" if one.distribution != "rectangular" else "normal"
    yield f"as if {other}", text.replace(f'"{one.distribution}"', f'"{other}"')
    yield "acting otherwise", text.replace(f"Acts.{one.acts.name}", f"Acts.{OTHER_WAY[one.acts.name]}")
    common = 'common=""' if one.common else 'common="rig"'
    plain = text.replace(f'common="{one.common}"', common)
    yield "shared otherwise", plain if plain != text else f"{text[:-1]}, {common})"
    if one.factor != 1.0:
        yield "without its factor", text.replace(f"factor={one.factor:g}", "factor=1.0")


def _written(path: str) -> dict[str, str]:
    """Return the text of each ``Term(...)`` of a file, by the term's name."""
    source = (ROOT / path).read_text(encoding="utf-8")
    found: dict[str, str] = {}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Term" and node.args:
            name = node.args[0]
            if isinstance(name, ast.Constant):
                found[str(name.value)] = ast.get_source_segment(source, node) or ""
    return found
