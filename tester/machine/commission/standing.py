"""How the steps of a commissioning stand by the record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tester.inputs.rig import Rig
from tester.machine.commission.record import BEGUN, DONE, CommissionRecord, RecordEntry
from tester.machine.commission.step import CommissionStep, sections_sha256


@dataclass(frozen=True, slots=True)
class StepStanding:
    """One step: the entry by which it stands, None where it is to be done; the newest entry of it, None without any."""

    step: CommissionStep
    stands: RecordEntry | None
    last: RecordEntry | None

    @property
    def words(self) -> str:
        """Return it for people."""
        if self.stands is not None:
            return f"stands since {self.stands.at[:10]}, {self.stands.by}: {self.stands.text}"
        if self.last is None:
            return "to be done"
        why = {BEGUN: "was cut off", DONE: "the rig file has changed under it"}.get(self.last.what, self.last.what)
        told = f": {self.last.text}" if self.last.text else ""
        return f"to be done again ({why}, {self.last.at[:10]}){told}"


def standing_of(record: CommissionRecord, steps: Sequence[CommissionStep], rig: Rig) -> tuple[StepStanding, ...]:
    """Return how each step stands under a rig file."""
    return tuple(
        StepStanding(step, record.standing(step.name, sections_sha256(rig, step.sections)), record.last(step.name))
        for step in steps
    )
