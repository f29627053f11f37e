"""Which commissioning steps the record shows as done."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tester.inputs.rig import Rig
from tester.machine.commission.record import BEGUN, DONE, CommissionRecord, RecordEntry
from tester.machine.commission.step import CommissionStep, sections_sha256


@dataclass(frozen=True, slots=True)
class StepStanding:
    """One step: its valid entry, None if it is not done; its newest entry, None without any."""

    step: CommissionStep
    stands: RecordEntry | None
    last: RecordEntry | None

    @property
    def words(self) -> str:
        """Return the state for people."""
        if self.stands is not None:
            return f"done on {self.stands.at[:10]}, {self.stands.by}: {self.stands.text}"
        if self.last is None:
            return "to be done"
        why = {BEGUN: "was cut off", DONE: "the rig file has changed under it"}.get(self.last.what, self.last.what)
        text = f": {self.last.text}" if self.last.text else ""
        return f"to be done again ({why}, {self.last.at[:10]}){text}"


def standing_of(record: CommissionRecord, steps: Sequence[CommissionStep], rig: Rig) -> tuple[StepStanding, ...]:
    """Return the state of each step under a rig file."""
    return tuple(
        StepStanding(step, record.standing(step.name, sections_sha256(rig, step.sections)), record.last(step.name))
        for step in steps
    )
