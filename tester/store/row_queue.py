"""Rows of a record from its classes, as statements in a queue."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from tester.store.chain import Cell
from tester.store.record_schema import TIMES
from tester.store.sql import Batch, Statement, Ticket, columns_in, insert, update

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


def no_utc() -> str:
    """Return the wall-clock text of a recorder without a clock: ""."""
    return ""


class RowQueue:
    """Makes the rows of a record and queues their statements. Subclasses decide what happens to them."""

    def __init__(self, utc: Callable[[], str] = no_utc) -> None:
        """Number repeats, events, prompts and trips from 1; ``utc`` returns the wall clock as ISO 8601 text."""
        self._utc = utc
        self._repeats: int = 0
        self._events: int = 0
        self._prompts: int = 0
        self._trips: int = 0

    origin_s: float = 0.0
    """Offset of every recorded rig time: a resumed run counts from its interruption. It may change only while the queue
    is empty.
    """
    failed: str | None = None
    """Why nothing more can be written, None while writing works; then the run must end in a controlled stop."""
    overruns: int = 0
    """Samples dropped because the queue was full."""
    on_event: Callable[[float, str, str, str], None] | None = None
    """Called with every recorded event: rig time in s, kind, text, severity."""

    def sample(self, row: tuple[float, ...]) -> None:
        """Record one sample: an exact tuple with a value for each recorded channel. In every scan: below 1 us."""
        raise TypeError("a recorder defines what happens to samples")

    def _put(self, batch: Batch) -> None:
        raise TypeError("a recorder defines what happens to statements")

    def _write(self, *statements: Statement, urgent: bool = False) -> Ticket:
        ticket = Ticket()
        self._put(Batch(statements, ticket, urgent))
        return ticket

    def _row(self, table: str, record: DataclassInstance | None = None, /, **values: Cell) -> Statement:
        """Return the INSERT of a row from values by column and a record's fields; rig times count from the origin."""
        columns = columns_in(record) if record is not None else {}
        return insert(table, self._from_origin(table, {**values, **columns, **values}))

    def _change(self, table: str, values: Mapping[str, Cell], **where: Cell) -> Statement:
        """Return the UPDATE of the rows that match ``where``; rig times count from the origin."""
        return update(table, self._from_origin(table, values), where)

    def _from_origin(self, table: str, values: Mapping[str, Cell]) -> dict[str, Cell]:
        times = TIMES.get(table, ())
        return {
            name: value + self.origin_s if name in times and isinstance(value, int | float) else value
            for name, value in values.items()
        }
