"""Commissions a rig from start to finish: its wires, record, locks and signals, and the recipes of its steps."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Any

from tester import kinds
from tester.base import clock
from tester.base.lock import ExclusiveUse, RigInUseError, user
from tester.base.processes import stopped_by_signals
from tester.base.source import InvalidSource, Problem
from tester.inputs.rig import Rig
from tester.machine.commission.person import CommissionPart, Person
from tester.machine.commission.record import FOLDER, CommissionRecord, record_path
from tester.machine.commission.step_engine import Commissioning, CommissionOutcome
from tester.machine.rig_ports import Ports
from tester.machine.tickers import TickedWorld
from tester.run.commission_run import run_recipe
from tester.run.endings import CannotStartError
from tester.run.preconditions import hold_rig
from tester.run.rig_wires import connect_ports
from tester.run.session_options import SessionOptions


@dataclass(frozen=True, slots=True)
class CommissionOptions(SessionOptions):
    """Options of the command line. ``lapse``: speed of the steps; recipes run as fast as possible."""

    compound: str = ""


def part_of(rig: Rig) -> CommissionPart:
    """Return the commissioning part of a rig's kind; raises InvalidSource if the kind has none."""
    part = kinds.find(rig.kind).commissions
    if part is None:
        text = f"kind: a rig of the kind {rig.kind} has no guided commissioning"
        raise InvalidSource([Problem(f"rig {rig.name}", 1, 1, text)])
    return part()


def commission(rig: Rig, options: CommissionOptions, person: Person) -> CommissionOutcome:
    """Guide a person through commissioning a rig.

    Raises CannotStartError, InvalidSource, RecordError, OSError.
    """
    path = record_path(options.out, rig.name)
    path.parent.mkdir(parents=True, exist_ok=True)
    with ExclusiveUse() as use:
        try:
            use.lock_file(f"the record {path.name}", path.with_suffix(".lock"), FOLDER, lasting=False)
        except RigInUseError as error:
            raise CannotStartError(str(error)) from error
        record = CommissionRecord(path, clock.utc_now, options.operator or user())
        session = replace(options, lapse=None)
        walk = Commissioning(
            part_of(rig).steps,
            rig,
            person,
            record,
            lambda: _connect(rig, options.seed, person),
            lambda name, text: run_recipe(session, path.parent, person, name, text),
            options.lapse,
            {"compound": options.compound} if options.compound else {},
        )
        with stopped_by_signals(walk.stop):
            return walk.run()


def _connect(rig: Rig, seed: int, person: Person) -> tuple[Ports, TickedWorld | None, Any]:
    """Open the wires of a rig and lock them until they are closed. Raises CannotStartError, BusLost."""
    with ExitStack() as opened:
        use = opened.enter_context(ExclusiveUse())
        hold_rig(use, rig, FOLDER)
        ports, world, hands = connect_ports(rig, seed, None)
        opened.callback(ports.close)
        person.at(hands)
        return Ports(ports.can, ports.lines, ports.pace, opened.pop_all()), world, hands
