"""Counts a run's conditions with a value, and their flags, in the words that every output prints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tester.analysis.flags import FLAGS, Flag, flags_in
from tester.base.words import counted
from tester.results.run_results import RunResults
from tester.results.table_rows import TableRow


@dataclass(frozen=True, slots=True)
class Tally:
    """Counts of the recipe's conditions, without references. Doubts and notes are those of conditions with a value."""

    conditions: int
    valued: int
    doubted: int
    noted: int
    doubts: tuple[str, ...]
    """Words of the doubts raised."""
    notes: tuple[str, ...]
    """Words of the other flags."""

    @property
    def missing(self) -> int:
        """Return how many conditions have no trustworthy value."""
        return self.conditions - self.valued

    @property
    def sentence(self) -> str:
        """Return the counts in words: values, then doubts, then notes."""
        if not self.conditions:
            return "No condition was asked for."
        all_of = "The condition has" if self.conditions == 1 else f"All {self.conditions} conditions have"
        some = f"{self.valued} of {counted(self.conditions, 'condition')} {_verb(self.valued, 'has', 'have')}"
        values = f"{some} a value" if self.missing else f"{all_of} a value"
        if not self.valued:
            return f"{values}."
        if not (self.doubted or self.noted):
            return f"{values}; none carries a flag."
        return f"{values}; {_carried(self.doubted, 'doubt', self.doubts)}, {_carried(self.noted, 'note', self.notes)}."


def tally_of(results: RunResults) -> Tally:
    """Return the counts of a run."""
    valued = [row for row in results.rows if row.result.ok]
    doubts, notes = ([_carries(row, doubt=doubt) for row in valued] for doubt in (True, False))
    return Tally(
        len(results.rows), len(valued), sum(map(bool, doubts)), sum(map(bool, notes)), _words(doubts), _words(notes)
    )


def flag_lines(results: RunResults) -> Iterator[str]:
    """Yield meaning and remedy of each flag that a condition, or a reference, carries."""
    carried = {word for row in results.all_rows() for word in flags_in(row.result.flags)}
    for flag in FLAGS.values():
        if flag.word in carried:
            yield flag_words(flag)


def flag_words(flag: Flag) -> str:
    """Return a flag with its weight, meaning and remedy."""
    weight = "doubt" if flag.doubt else "note"
    remedy = f" What helps: {flag.remedy}." if flag.remedy else ""
    return f"{flag.word} ({weight}): {flag.meaning}{remedy}"


def _carries(row: TableRow, *, doubt: bool) -> list[str]:
    return [word for word in flags_in(row.result.flags) if (word in FLAGS and FLAGS[word].doubt) is doubt]


def _words(carried: Sequence[Sequence[str]]) -> tuple[str, ...]:
    return tuple(sorted({word for words in carried for word in words}))


def _carried(n: int, what: str, words: Sequence[str]) -> str:
    return f"{n} {_verb(n, 'carries', 'carry')} a {what} ({', '.join(words)})" if n else f"none carries a {what}"


def _verb(n: int, singular: str, plural: str) -> str:
    return singular if n == 1 else plural
