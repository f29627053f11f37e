"""The table of conditions: every column of it, once.

``mu`` is the coefficient at the nominal temperature (``tester.analysis.repeats``), as are U and all its other figures
except ``mu_as_measured`` and the scatter between repeats, ``s``. Counts are those of ``tester.analysis.left_out``. A
new column is an entry here; its ``views`` name the outputs that show it to people.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import isfinite
from typing import Final

from tester.analysis.flags import flags_in
from tester.analysis.left_out import Counts
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import NAN, SoakCheck, mark_of
from tester.analysis.wear_rate import ConditionWear
from tester.base.axes import Axis
from tester.results.columns import Column, Output, Table, mean_column, setting_columns
from tester.results.run_results import RunResults
from tester.results.table_rows import Measured, TableRow
from tester.store.records import ConditionInfo

CONDITION: Final = "condition"
COMBINED: Final = "combined"


@dataclass(frozen=True, slots=True)
class ConditionRow:
    """A condition, or (``measured`` None) the mean over its replicates."""

    row: TableRow
    result: ConditionResult
    measured: Measured | None
    wear: ConditionWear | None
    reference: bool

    @property
    def info(self) -> ConditionInfo:
        """Return the setpoints."""
        return self.measured.info if self.measured is not None else self.row.info

    @property
    def counts(self) -> Counts:
        """Return how many repeats, pairs or replicates were requested, made and valid."""
        return self.result.counts

    @property
    def soak(self) -> SoakCheck | None:
        """Return the thermometer's check after the soak; None for replicates, and without a check."""
        return self.measured and self.measured.soak

    @property
    def whole(self) -> bool:
        """Return whether this is a row of the recipe's table: the mean over replicates, or the only one."""
        return self.measured is None or len(self.row.replicates) == 1

    @property
    def mark(self) -> str:
        """Return the mark of its coefficient; "" where it is trusted, and where there is none."""
        return mark_of(self.result.status, self.result.flags) if isfinite(self.result.mu) else ""

    @property
    def remarks(self) -> tuple[str, ...]:
        """Return its status where it has no value, and its flags."""
        return (*([] if self.result.ok else [self.result.status.value]), *flags_in(self.result.flags))


def conditions_table(results: RunResults) -> Table[ConditionRow]:
    """Return the table of all conditions, replicates one after the other and then their mean, references last."""
    return Table(columns_of(results), tuple(_rows(results)))


def recipe_rows(table: Table[ConditionRow]) -> Table[ConditionRow]:
    """Return the rows of the recipe's table: one for each condition, none for references."""
    return table.of(row for row in table.rows if row.whole and not row.reference)


def value_words(table: Table[ConditionRow], row: ConditionRow) -> str:
    """Return a condition's mu with its mark, and U of what is mounted, as every table prints them: 0.707 ± 0.029.

    Without a coefficient it is the condition's status. ``table`` has the columns.
    """
    if not isfinite(row.result.mu):
        return row.result.status.value
    return f"{table['mu'].text(row)} ± {table['u_expanded'].text(row)}"


def axis_keys(axes: Iterable[Axis]) -> tuple[str, ...]:
    """Return the keys of the columns that identify a row's condition: compound and some axes."""
    return ("compound", *(axis.column for axis in axes))


def columns_of(results: RunResults) -> tuple[Column[ConditionRow], ...]:
    """Return the columns of a run's table, in the order of its CSV file."""
    further = {channel.name for channel in results.quantities.further}
    return (
        *_WHICH,
        *setting_columns(
            results.axes, lambda row: row.info, lambda row: row.measured and row.info.replicate,
            results.run.info.metadata, _PEOPLE,
        ),
        *_fixed(results.worn),
        *(
            mean_column(channel, lambda row: row.result.measured, _FURTHER if channel.name in further else frozenset())
            for channel in results.quantities.averaged
        ),
        _REMARKS,
    )


def sweep_columns() -> tuple[Column[ConditionRow], ...]:
    """Return the columns of a sweep's table of conditions, which are the same for every run."""
    return tuple(column for column in _fixed("piece") if Output.SWEEP in column.views)


def _fixed(worn: str) -> tuple[Column[ConditionRow], ...]:
    """Return the columns that every kind of rig has; ``worn``: the kind's word for a piece."""
    return (*_FOUND, *_uncertainties(worn), *_MORE, *_WEAR)


def _rows(results: RunResults) -> Iterator[ConditionRow]:
    references = {id(row) for row in results.references}
    for row in results.all_rows():
        watches = id(row) in references
        for replicate in row.replicates:
            wear = results.condition_wear(replicate.info.condition)
            yield ConditionRow(row, replicate.result, replicate, wear, watches)
        if len(row.replicates) > 1:
            yield ConditionRow(row, row.result, None, None, watches)


def _percent(u: float, row: ConditionRow) -> float:
    mu = abs(row.result.mu)
    return 100.0 * u / mu if mu else NAN


_PEOPLE = frozenset({Output.END, Output.SHOW, Output.COVER, Output.REPORT, Output.SCREEN})
_FULL = frozenset({Output.SHOW, Output.REPORT})
_REPEATS = frozenset({Output.REPEATS})
_SWEEP = frozenset({Output.SWEEP})
_FURTHER = frozenset({Output.SHOW, Output.REPORT, Output.SCREEN})
"""Outputs that show the means of further sensors."""

_WHICH: tuple[Column[ConditionRow], ...] = (
    Column("level", "level", lambda row: COMBINED if row.measured is None else CONDITION),
    Column("condition", "no.", lambda row: row.info.condition if row.measured is not None else None,
           views=_REPEATS),
)  # fmt: skip

_FOUND: tuple[Column[ConditionRow], ...] = (
    Column("status", "status", lambda row: row.result.status.value, views=_SWEEP),
    Column("reason", "reason", lambda row: row.result.reason, views=_SWEEP),
    Column("flags", "flags", lambda row: tuple(flags_in(row.result.flags)), views=_SWEEP),
    Column("mark", "mark", lambda row: row.mark, views=_SWEEP),
    Column("mu", "mu", lambda row: row.result.mu, "", 3, _PEOPLE | _SWEEP, lambda row: row.mark),
    Column("mu_longitudinal", "mu along", lambda row: row.result.longitudinal, "", 3),
    Column("mu_lateral", "mu across", lambda row: row.result.lateral, "", 3),
    Column("mu_as_measured", "mu as measured", lambda row: row.result.mu_resultant, "", 3, _FULL),
    Column("mu_without_flagged", "mu without outliers", lambda row: row.result.without_flagged, "", 3),
)


def _uncertainties(worn: str) -> tuple[Column[ConditionRow], ...]:
    """Return U and its companions, of the mounted piece and of the compound."""
    return (
        Column("u_standard", f"u this {worn}", lambda row: row.result.budget.standard, "", 3, _SWEEP),
        Column("u_expanded", f"U this {worn}", lambda row: row.result.budget.expanded, "", 3, _PEOPLE),
        Column("u_expanded_percent", f"U this {worn}", lambda row: _percent(row.result.budget.expanded, row), "%", 1),
        Column("coverage_factor", "k", lambda row: row.result.budget.coverage, "", 2),
        Column("u_standard_compound", "u compound", lambda row: row.result.compound_budget.standard, "", 3),
        Column("u_expanded_compound", "U compound", lambda row: row.result.compound_budget.expanded, "", 3,
               _PEOPLE - {Output.END}),
        Column("u_expanded_compound_percent", "U compound",
               lambda row: _percent(row.result.compound_budget.expanded, row), "%", 1, frozenset({Output.REPORT})),
        Column("coverage_factor_compound", "k", lambda row: row.result.compound_budget.coverage, "", 2),
    )  # fmt: skip


_MORE: tuple[Column[ConditionRow], ...] = (
    Column("s", "s", lambda row: row.result.s if row.result.n_valid > 1 else NAN, "", 4,
           frozenset({Output.SHOW, Output.REPORT, Output.SCREEN, Output.SWEEP})),
    Column("interval_95", "t interval", lambda row: row.result.interval, "", 4),
    Column("u_type_a", "u of repeats", lambda row: row.result.type_a, "", 4),
    Column("valid_of", "valid", lambda row: row.counts.words, views=_PEOPLE, stored=False),
    Column("counted", "counted", lambda row: row.counts.of, views=_REPEATS),
    Column("asked", "asked for", lambda row: row.counts.asked, "", 0, _REPEATS),
    Column("made", "made", lambda row: row.counts.made, "", 0, _REPEATS),
    Column("valid", "valid", lambda row: row.counts.valid, "", 0, frozenset({Output.REPEATS, Output.SWEEP})),
    Column("left_out", "left out", lambda row: row.counts.left_out, "", 0, _REPEATS),
    Column("make_ups", "make-ups", lambda row: row.counts.made_up, "", 0, _REPEATS),
    Column("drift_percent", "drift", lambda row: row.result.drift_percent, "%", 2, _REPEATS),
    Column("drift_bound_percent", "drift bound", lambda row: row.result.drift_bound_percent, "%", 2, _REPEATS),
    Column("trend_percent", "trend", lambda row: row.result.trend_percent, "%", 2, _REPEATS),
    Column("change_percent", "change at once", lambda row: row.result.change_percent, "%", 2, _REPEATS),
    Column("swing_percent", "swing", lambda row: row.result.swing_percent, "%", 1, _REPEATS),
    Column("swing_hz", "swing at", lambda row: row.result.swing_hz, "Hz", 1, _REPEATS),
    Column("thermometer_off_k", "thermometer off", lambda row: row.soak and row.soak.off_k, "K", 1, _REPEATS),
    Column("thermometer_allowed_k", "allowed", lambda row: row.soak and row.soak.allowed_k, "K", 1, _REPEATS),
    Column("warming_k_s", "warming", lambda row: row.measured and row.measured.condition.warming_k_s, "K/s", 2),
    Column("holdable_band_k", "band that can be held",
           lambda row: row.measured and row.measured.condition.holdable_band_k, "K", 2),
)  # fmt: skip

_WEAR: tuple[Column[ConditionRow], ...] = (
    Column("diameter_before_mm", "diameter before", lambda row: row.wear and row.wear.before_mm, "mm", 3),
    Column("diameter_after_mm", "diameter after", lambda row: row.wear and row.wear.after_mm, "mm", 3),
    Column("u_worn_mm", "u of the difference", lambda row: row.wear and row.wear.u_mm, "mm", 4),
    Column("wear_mm3_n_m", "wear", lambda row: row.wear and row.wear.rate.rate, "mm3/(N m)", 4),
    Column("wear_u_expanded", "U wear", lambda row: row.wear and row.wear.rate.expanded, "mm3/(N m)", 4),
)

_REMARKS: Column[ConditionRow] = Column(
    "remarks", "flags", lambda row: row.remarks, views=_PEOPLE | _REPEATS, stored=False
)
