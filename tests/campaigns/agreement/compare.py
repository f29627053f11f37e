"""Compares facts: where outputs contradict each other, and what an output leaves out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from tests.campaigns.agreement.facts import Fact, Facts, Subject, Value
from tests.campaigns.agreement.names import (
    CONDITIONS,
    DOUBTS,
    FLAGS,
    LEFT_OUT,
    MADE,
    MARK,
    MISSING,
    MU,
    MU_MEASURED,
    STATUS,
    U_COMPOUND,
    U_THIS,
    VALID,
    VALUES,
    WITH_CARE,
)
from tests.campaigns.agreement.record import Record

_ROUNDING = 1e-9
"""Relative difference between decimal and binary numbers."""
Key = tuple[Subject, str]
Grouped = Mapping[Key, Sequence[Fact]]


@dataclass(frozen=True, slots=True)
class Disagreement:
    """Outputs that contradict one another about a quantity of a subject."""

    subject: Subject
    quantity: str
    facts: tuple[Fact, ...]
    why: str = ""

    @property
    def key(self) -> Key:
        """Return its subject."""
        return self.subject, self.quantity

    def __str__(self) -> str:
        """Return a readable line."""
        which = " ".join(map(str, self.subject))
        return f"{which}: {self.quantity}: {self.why or '; '.join(map(str, self.facts))}"


@dataclass(frozen=True, slots=True)
class Comparison:
    """The result of a comparison. ``compared``: facts that another output also states; ``alone``: the others."""

    disagreements: tuple[Disagreement, ...]
    compared: int
    alone: Mapping[str, int]


def grouped(read: Iterable[Facts]) -> Grouped:
    """Return all facts by subject and quantity."""
    groups: dict[Key, list[Fact]] = {}
    for facts in read:
        for fact in facts.collected:
            groups.setdefault((fact.subject, fact.quantity), []).append(fact)
    return groups


def compare(read: Sequence[Facts], records: Sequence[Record]) -> Comparison:
    """Compare the facts of all outputs of some runs with each other, and with what follows from them."""
    stated = grouped(read)
    groups = grouped([*read, worked_out(stated), *(counted(stated, record) for record in records)])
    found = [
        Disagreement((one.output,), "what is printed", (), strange) for one in read for strange in one.strange
    ]
    compared, alone = 0, dict[str, int]()
    ok = {subject for (subject, quantity), facts in groups.items() if quantity == STATUS and facts[0].value == "ok"}
    for (subject, quantity), facts in groups.items():
        outputs = {fact.output for fact in facts}
        if len(outputs) == 1:
            alone[quantity] = alone.get(quantity, 0) + 1
        else:
            compared += len(facts)
        if subject[0] == "nearest":
            continue
        valued = subject in ok or subject[0] not in ("condition", "row")
        found += contradictions(subject, quantity, facts, valued=valued)
    found += _nearest(groups)
    found += [*incomplete(groups), *sums(groups)]
    return Comparison(tuple(found), compared, alone)


def contradictions(
    subject: Subject, quantity: str, facts: Sequence[Fact], *, valued: bool
) -> Iterator[Disagreement]:
    """Yield what contradicts the most precise statement of a quantity.

    ``valued``: a dash beside a number counts. An output may omit the number of a condition without a valid value.
    """
    numbers = [fact for fact in facts if isinstance(fact.value, float | int)]
    empty = [fact for fact in facts if fact.value is None]
    words = [fact for fact in facts if isinstance(fact.value, str | frozenset)]
    if numbers:
        best = min(numbers, key=lambda fact: fact.half)
        off = [fact for fact in numbers if not agrees(fact, best)]
        if off:
            yield Disagreement(subject, quantity, (best, *off))
    if numbers and empty and valued:
        yield Disagreement(subject, quantity, (numbers[0], *empty))
    texts = {fact.value for fact in words}
    if len(texts) > 1 or (words and numbers):
        yield Disagreement(subject, quantity, tuple(words))


def agrees(one: Fact, best: Fact) -> bool:
    """Return whether a number is the rounded most precise one."""
    assert isinstance(one.value, float | int)
    assert isinstance(best.value, float | int)
    return abs(one.value - best.value) <= one.half + best.half + _ROUNDING * abs(best.value)


def _nearest(groups: Grouped) -> Iterator[Disagreement]:
    """Yield points that match no coefficient of the candidate rows."""
    for (subject, quantity), facts in groups.items():
        if subject[0] != "nearest":
            continue
        name = subject[1]
        candidates = [
            fact
            for row in subject[2:]
            for (other, kind), those in groups.items()
            if kind == quantity and other[:2] in (("condition", name), ("row", name))
            for fact in those
            if _is_row(other, row) and isinstance(fact.value, float | int)
        ]
        for fact in facts:
            if isinstance(fact.value, float | int) and not any(agrees(fact, other) for other in candidates):
                yield Disagreement(subject, quantity, (fact,), f"{fact} is no value of these rows")


def _is_row(subject: Subject, row: str | int) -> bool:
    return subject[0] == "condition" or subject[2] == row


# -- what follows from facts -------------------------------------------------------------------------------------------


def worked_out(groups: Grouped) -> Facts:
    """Return what follows from the most precise facts: shares in per cent, doubts and marks from flags."""
    from tester.analysis.flags import FLAGS as LIST

    facts = Facts("worked out")
    best = {key: _best(found) for key, found in groups.items()}
    doubts = {word for word, flag in LIST.items() if flag.doubt}
    for (subject, quantity), fact in best.items():
        if fact is None:
            continue
        if quantity == FLAGS and isinstance(fact.value, frozenset):
            facts.add(subject, DOUBTS, frozenset(word for word in fact.value if word in doubts))
        if quantity in _SHARES:
            mu = best.get((subject, MU))
            part = best.get((subject, _SHARES[quantity]))
            if mu is not None and part is not None and _number(mu) and _number(part) is not None:
                share = 100.0 * (_number(part) or 0.0) / abs(_number(mu) or 1.0)
                facts.add(subject, quantity, share, abs(share) * 1e-6)
        if quantity.endswith(": u mu %") or (quantity.endswith(" %") and ": share" in quantity):
            _term_share(facts, best, subject, quantity)
    return facts


def counted(groups: Grouped, record: Record) -> Facts:
    """Return the counts of a run that follow from what is stated of its conditions and repeats."""
    from tester.analysis.flags import FLAGS as LIST

    facts = Facts("worked out")
    rows = [record.of_row(row) for row in record.rows if not record.is_reference(row)]
    valued = [row for row in rows if _value(groups, row, STATUS) == "ok"]
    carried = [{LIST[word].doubt for word in _words(_value(groups, row, FLAGS)) if word in LIST} for row in valued]
    out = [subject for subject, quantity in groups if subject[:2] == ("repeat", record.name) and
           quantity == "repeat in mean" and _value(groups, subject, quantity) == 0.0]  # fmt: skip
    facts.count(record.run, CONDITIONS, len(rows))
    facts.count(record.run, VALUES, len(valued))
    facts.count(record.run, MISSING, len([*record.rows]) - sum(
        _value(groups, record.of_row(row), STATUS) == "ok" for row in record.rows
    ))  # fmt: skip
    facts.count(record.run, WITH_CARE, sum(True in found for found in carried))
    facts.count(record.run, "noted", sum(False in found for found in carried))
    facts.count(record.run, LEFT_OUT, len(out))
    return facts


def _value(groups: Grouped, subject: Subject, quantity: str) -> Value:
    fact = _best(groups.get((subject, quantity), ()))
    return fact.value if fact is not None else None


def _words(value: Value) -> frozenset[str]:
    return value if isinstance(value, frozenset) else frozenset()


_SHARES = {"U this piece %": U_THIS, "U compound %": U_COMPOUND, "s %": "s"}


def _term_share(
    facts: Facts, best: Mapping[Key, Fact | None], subject: Subject, quantity: str
) -> None:
    part, mu = best.get((subject, quantity.removesuffix(" %"))), best.get((subject, MU))
    if part is None or _number(part) is None:
        return
    value = 100.0 * (_number(part) or 0.0)
    if quantity.endswith("u mu %"):
        if mu is None or not _number(mu):
            return
        value /= abs(_number(mu) or 1.0)
    facts.add(subject, quantity, value, abs(value) * 1e-6)


def _best(facts: Sequence[Fact]) -> Fact | None:
    stated = [fact for fact in facts if fact.value is not None]
    return min(stated, key=lambda fact: fact.half) if stated else None


def _number(fact: Fact) -> float | None:
    return float(fact.value) if isinstance(fact.value, float | int) else None


# -- what an output leaves out -----------------------------------------------------------------------------------------

REQUIRED: Mapping[str, tuple[str, ...]] = {
    "end of the run": (MU, U_THIS, VALID, FLAGS, MARK),
    "show": (MU, U_THIS, U_COMPOUND, VALID, FLAGS, MARK),
    "show --json": (MU, MU_MEASURED, U_THIS, U_COMPOUND, VALID, MADE, FLAGS, MARK),
    "show --budget": (MU, U_THIS, U_COMPOUND),
    "export conditions": (MU, MU_MEASURED, U_THIS, U_COMPOUND, VALID, MADE, FLAGS),
    "export appendix": (MU,),
    "report": (MU, MU_MEASURED, U_THIS, U_COMPOUND, VALID, FLAGS, MARK),
    "screen Results": (MU, VALID, FLAGS, MARK),
}
"""What an output must state for every row with a value."""


def incomplete(groups: Grouped) -> Iterator[Disagreement]:
    """Yield what an output leaves out of a row for which others give a value."""
    stated: dict[tuple[str, Subject], set[str]] = {}
    rows: set[Subject] = set()
    for (subject, quantity), facts in groups.items():
        for fact in facts:
            stated.setdefault((fact.output, subject), set()).add(quantity)
            if fact.output == "export appendix" and quantity == MU:
                rows.add(subject)
    for output, quantities in REQUIRED.items():
        for subject in rows:
            missing = [one for one in quantities if one not in stated.get((output, subject), set())]
            if missing and _covers(output, subject, stated):
                yield Disagreement(subject, ", ".join(missing), (), f"not in {output}")
    yield from _repeats(stated)


def _repeats(stated: Mapping[tuple[str, Subject], set[str]]) -> Iterator[Disagreement]:
    """Yield the repeats of the table of repeats that an output leaves out."""
    listed = {subject for output, subject in stated if output == "export repeats" and subject[0] == "repeat"}
    for output in ("show --json", "screen repeats"):
        if any(other == output for other, _ in stated):
            for subject in listed:
                if f"repeat {MU_MEASURED}" not in stated.get((output, subject), set()):
                    yield Disagreement(subject, f"repeat {MU_MEASURED}", (), f"not in {output}")


def _covers(output: str, subject: Subject, stated: Mapping[tuple[str, Subject], set[str]]) -> bool:
    """Return whether an output was read and lists such subjects: some list conditions, some the recipe's rows."""
    listed = {other[0] for kind, other in stated if kind == output and other[1] == subject[1]}
    return subject[0] in listed if subject[0] == "row" else bool(listed)


def sums(groups: Grouped) -> Iterator[Disagreement]:
    """Yield counts that do not add up: each repeat made is either valid or left out."""
    for subject in {subject for subject, _ in groups}:
        made, valid, out = (_best(groups.get((subject, one), ())) for one in (MADE, VALID, LEFT_OUT))
        if subject[0] != "run" and made is not None and valid is not None and out is not None:
            counts = [_number(one) or 0.0 for one in (made, valid, out)]
            if counts[0] != counts[1] + counts[2]:
                why = f"{made}, {valid} valid, {out} left out do not add up"
                yield Disagreement(subject, "counts", (made, valid, out), why)


