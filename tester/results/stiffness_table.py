"""How stiff the rubber is in each condition, and what temperature and time do to it: from the samples of its contacts.

Only for a machine with a channel of the depth (``Roles.depth``). Softening and relaxation belong to the compound: every
one of its conditions repeats them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from tester.analysis.contacts import ContactFinder, PressedContact
from tester.analysis.deformation import LEAST_CONTACTS, Deformation, RubberStiffness, by_condition, stiffness_of
from tester.results.columns import Column, Table, axis_column
from tester.results.run_results import RunResults
from tester.results.table_rows import Measured
from tester.store.records import ConditionInfo
from tester.store.run_reader import RunReader


@dataclass(frozen=True, slots=True)
class StiffnessRow:
    """The deformation in a condition, and what all contacts with its compound show."""

    measured: Measured
    here: Deformation
    rubber: RubberStiffness


def shows_stiffness(results: RunResults) -> bool:
    """Return whether a run's samples have the depth, and its repeats are enough contacts for a fit."""
    roles = results.quantities.roles
    repeats = sum(len(condition.repeats) for condition in results.conditions())
    return bool(roles.depth and roles.core) and repeats >= LEAST_CONTACTS


def stiffness_table(results: RunResults, reader: RunReader) -> Table[StiffnessRow]:
    """Return a row for each condition of a compound with enough contacts; raises StoreError."""
    axes = tuple(axis_column(axis, _info) for axis in results.axes)
    rows = stiffness_rows(results, reader) if shows_stiffness(results) else ()
    return Table[StiffnessRow]((*_WHICH, *axes, *_FOUND), tuple(rows))


def stiffness_rows(results: RunResults, reader: RunReader) -> list[StiffnessRow]:
    """Return those rows, in the order of the table of conditions."""
    finder = ContactFinder(results.quantities.roles, (piece.installed_s for piece in results.pieces))
    for block in reader.sample_blocks():
        finder.add(block.columns)
    attempts = reader.repeats(attempts=True)
    condition_of = {repeat.key: repeat.condition for repeat in attempts}
    piece_of = {repeat.key: repeat.piece for repeat in attempts}
    compound_of = {piece.piece: piece.compound for piece in results.pieces}
    contacts: dict[str, list[PressedContact]] = {}
    for contact in finder.ended():
        compound = compound_of.get(piece_of.get(contact.repeat_key, 0), "")
        if compound:
            contacts.setdefault(compound, []).append(contact)
    found: dict[int, tuple[Deformation, RubberStiffness]] = {}
    for listed in contacts.values():
        rubber = stiffness_of(listed)
        if rubber is not None:
            inside = by_condition(listed, condition_of)
            found |= {condition: (rubber.at(averages), rubber) for condition, averages in inside.items()}
    measured = {condition.info.condition: condition for condition in results.conditions()}
    return [StiffnessRow(one, *found[number]) for number, one in measured.items() if number in found]


def _info(row: StiffnessRow) -> ConditionInfo:
    return row.measured.info


_WHICH: Final[tuple[Column[StiffnessRow], ...]] = (
    Column("condition", "condition", lambda row: row.measured.info.condition),
    Column("compound", "compound", lambda row: row.measured.info.compound),
)

_FOUND: Final[tuple[Column[StiffnessRow], ...]] = (
    Column("contacts", "contacts", lambda row: row.here.contacts, "", 0),
    Column("measured_load_n", "load", lambda row: row.here.load_n, "N", 1),
    Column("body_c", "mean temperature of the rubber", lambda row: row.here.body_c, "°C", 1),
    Column("deformation_mm", "deformation", lambda row: row.here.depth_mm.value, "mm", 3),
    Column("deformation_u_expanded_mm", "U deformation", lambda row: row.here.depth_mm.expanded, "mm", 3),
    Column("stiffness_n_mm", "stiffness", lambda row: row.here.stiffness_n_mm.value, "N/mm", 1),
    Column("stiffness_u_expanded_n_mm", "U stiffness", lambda row: row.here.stiffness_n_mm.expanded, "N/mm", 1),
    Column("softening_percent_k", "softening", lambda row: 100.0 * row.rubber.softening_per_k.value, "%/K", 3),
    Column("softening_u_expanded_percent_k", "U softening", lambda row: 100.0 * row.rubber.softening_per_k.expanded,
           "%/K", 3),
    Column("relaxation_percent_decade", "relaxation", lambda row: 100.0 * row.rubber.relaxation.value, "%/decade", 2),
    Column("relaxation_u_expanded_percent_decade", "U relaxation",
           lambda row: 100.0 * row.rubber.relaxation.expanded, "%/decade", 2),
    Column("load_exponent", "exponent of the load", lambda row: row.rubber.exponent.value, "", 3),
    Column("load_exponent_u_expanded", "U exponent", lambda row: row.rubber.exponent.expanded, "", 3),
)  # fmt: skip
"""``stiffness`` is load over deformation; ``softening`` and ``relaxation`` are shares of the load at a held depth."""
