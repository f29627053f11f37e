"""The view of one run between two ticks, and the behaviour of its drives without a program that controls them."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from tester.base.screen import Check, Gate, SoakView
from tester.inputs.rig import Rig
from tester.machine.engine import Engine
from tester.machine.line_speed import age_limit
from tester.machine.safety_inputs import InputStates
from tester.machine.state import Mode
from tester.machine.wires import STALE_CAN_S


@dataclass(frozen=True, slots=True)
class News:
    """State of a device's data: time of the newest (s by ``Engine.wires_s``, -inf if never), whether valid, and the age
    from which it is stale, s.
    """

    at_s: float
    valid: bool
    stale_s: float


@dataclass(frozen=True, slots=True)
class Wanted:
    """The setpoint of a value in the unit for people, and half the width of its gate; None if it has none."""

    setpoint: float | None
    band: float | None = None


class RunPanel:
    """What clients see of a run, read between two ticks. A kind adds setpoints and checks."""

    def __init__(self, engine: Engine) -> None:
        """Read the engine only; change nothing."""
        self.engine = engine
        self._stale_can_s = engine.ctx.rig.values()[STALE_CAN_S]
        self._limits = engine.ctx.rig.stale_limits()
        self._inputs = InputStates(engine.ctx.rig)

    def news(self) -> dict[str, News]:
        """Return the news of the devices that the table of channels names.

        "can": the drives, with the oldest data of one; the kind's own devices by their names in the rig file; further
        sensors by their places there.
        """
        devices, own = self.engine.devices, self.engine.ctx.rig.own
        news = {f"can.nodes.{node.name}": News(node.stamp_s, node.online, node.stale_s) for node in devices.nodes}
        for device in devices.modbus:
            _, stale_s = age_limit(device, self._limits)
            key = device.name if device.name in own else f"devices.{device.name}"
            news[key] = News(device.driver.stamp_s, device.driver.valid, stale_s or inf)
        oldest_s = min(drive.stamp_s for drive in devices.drives)
        return news | {"can": News(oldest_s, not self.engine.ctx.readings.drive_fault, self._stale_can_s)}

    def wanted(self) -> dict[str, Wanted]:
        """Return the setpoints of the values, by their keys; values without a setpoint may be left out."""
        return {}

    def gates(self) -> tuple[Gate, ...]:
        """Return the gates as of the last scan; none outside RUN, where they are not evaluated."""
        if self.engine.control.state.mode is not Mode.RUN:
            return ()
        ctx = self.engine.ctx
        return tuple(Gate(key, not ctx.gate & bit) for key, bit in ctx.gate_bits.items())

    def soak(self, now: float) -> SoakView | None:
        """Return the soak under way at ``now`` (rig s); None if there is none."""
        return None

    def checks(self) -> tuple[Check, ...]:
        """Return the connected rig's own checks before a start: by default those of the safety inputs."""
        r = self.engine.ctx.readings
        return (
            Check("safety chain", r.safety_chain, "closed" if r.safety_chain else "open"),
            Check("guard closed", r.guard_closed, "" if r.guard_closed else "the guard is open"),
            *(
                Check(name, closed, "closed" if closed else "open, or not known")
                for name, closed in self._inputs.closed(r.channels).items()
            ),
        )

    def mounted(self) -> tuple[int, str]:
        """Return number and compound of the specimen on the rig; (0, "") if there is none."""
        mounted = self.engine.ctx.mounted
        return mounted.specimen, mounted.compound


def drives_alone(rig: Rig, *also: str) -> str:
    """Return what drives do without a master, and when: as the first of a drive's two watchdogs expires.

    ``also``: what the kind's other devices do, in sentences.
    """
    if rig.can.interface == "sim":
        return "The simulated rig was part of the service and is gone with it."
    by_ms: dict[int, list[str]] = {}
    for name, axis in rig.drives().items():
        waits = [wait for wait in (axis.consumer_heartbeat_s, axis.rpdo_deadline_s) if wait > 0.0]
        by_ms.setdefault(round(1e3 * min(waits)), []).append(name)
    stops = "; ".join(f"{', '.join(names)}: {ms} ms" for ms, names in sorted(by_ms.items()))
    return " ".join((f"Without heartbeat and setpoints each drive makes a quick stop by itself ({stops}).", *also))
