"""The steps of this machine's commissioning, in their order: data."""

from __future__ import annotations

from typing import Any, Final

from tester.commission.part import CommissionPart
from tester.commission.person import Dialogue
from tester.commission.step import Notes, Step
from tester.kinds.wheel_on_belt.commission import identify, jog
from tester.kinds.wheel_on_belt.commission.quiet import QuietSeat
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.ports import Ports

_BUS: Final = ("can", "lines", "devices")


def _quiet(rig: Any, ports: Ports, hands: Any) -> QuietSeat:
    return QuietSeat(RigConfig.of(rig), ports, hands, jog.SPEEDS)


def _jog(axis: jog.Axis) -> Step:
    def procedure(seat: QuietSeat, notes: Notes) -> Dialogue:
        return jog.jog_axis(axis, seat, notes)

    return Step(
        f"jog {axis.name}",
        f"direction and scale of the {axis.name} axis",
        (f"axes.{axis.name}", *(("geometry",) if axis.name == "press" else ())),
        ("identify",),
        _quiet,
        procedure,
    )


STEPS: Final = (
    Step("identify", "who is on the wires", (*_BUS, "axes"), (), _quiet, identify.identify),
    *(_jog(axis) for axis in jog.AXES),
)
"""In the order in which each stands on what the ones before it have shown."""

COMMISSIONS: Final = CommissionPart(STEPS, TwinPerson)
