"""The watchdogs of drives and jacket, triggered in front of a person: heartbeat, setpoints, and the lease of the heat.

Cold, lifted and unloaded, guard closed. Each watchdog is tried alone: only one signal is withheld, the rest continues.
The record has each device's deadline, as read back, and its report after the deadline.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from typing import Any, Final

from drivers.canopen import objects as o
from drivers.servo import ServoDrive
from drivers.temperature_controller import TemperatureController
from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.arming import Proof, WheelArming
from tester.kinds.wheel_on_belt.procedures.lift_check import Unloaded
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.rig.sections import VELOCITY_AXES
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, Waits, choose, press
from tester.machine.commission.jogging import Moving, has_power
from tester.machine.commission.lease import left_alone
from tester.machine.commission.quiet_seat import QuietSeat
from tester.machine.commission.stages import Stage, in_stages
from tester.machine.proof import WatchdogProof
from tester.machine.rig_ports import Ports

SETPOINT_LATE: Final = 0x8250
"""EMCY code of an RPDO that did not arrive in time (CiA 301, table 26)."""
MORE_S: Final = 0.15
"""Setpoints are withheld this much longer than the longest deadline, s [A]: the EMCY arrives, and the ramp from creep
ends."""
COOLER_K: Final = 20.0
"""The jacket's setpoint is this much below the hub's temperature, so that it runs without heating."""


class SetpointProof(Proof):
    """Lets wheel and belt creep while their setpoints are withheld; heartbeat and SYNC continue."""

    emergency = SETPOINT_LATE

    def __init__(self, devices: Devices, rig: RigConfig) -> None:
        """Move nothing before the first ``step``."""
        super().__init__(devices, rig)
        self.follow, self.watchdog = False, True
        self.withhold_s = max((deadline_s(drive) for drive in self.watched()), default=0.0) + MORE_S

    def withhold(self, withheld: bool) -> None:
        """Withhold the RPDOs, or send them again."""
        self.devices.master.withhold_setpoints = withheld

    def watched(self) -> list[ServoDrive]:
        """Return the drives that have a deadline for setpoints."""
        return [drive for drive in self.devices.drives if deadline_s(drive) > 0.0]

    def ran_on(self, name: str) -> str:
        """Return the failure text for a drive that did not stop."""
        return (
            f"the {name} drive did not stop with EMCY 0x8250 when its setpoints were missing"
            f" for {self.withhold_s * 1000:g} ms (0x1400:05, axes.{name}.rpdo_deadline)"
        )


def deadline_s(drive: ServoDrive) -> float:
    """Return a drive's deadline for setpoints, as read back, s; 0: none."""
    return 1e-3 * drive.parameters.get((o.RPDO_COMMUNICATION, 5), 0)


class Trials(Moving):
    """Lifts, and then steps the proof that a procedure supplies. The procedure reports a failed proof itself."""

    def __init__(self, devices: Devices, rig: RigConfig) -> None:
        """Move nothing before the first ``step``."""
        self.devices = devices
        self.unloaded = Unloaded(devices, rig)
        self.proof: WatchdogProof | None = None

    @property
    def trying(self) -> bool:
        """Whether a proof is under way."""
        return self.proof is not None and not self.proof.done

    @property
    def powered(self) -> bool:
        """Whether a drive has power, or is about to."""
        return self.trying or not self.unloaded.done or has_power(self.devices)

    @property
    def provokes(self) -> bool:
        """Whether a proof makes drives stop by themselves; such stops do not end the connection."""
        return self.proof is not None and self.trying and self.proof.provokes

    def step(self, now: float) -> None:
        """Advance by one tick at ``now`` s."""
        self.stepped_s = now
        if not self.unloaded.done:
            self.unloaded.step(now)
            self.failure = self.unloaded.failure
        elif self.proof is not None and not self.proof.done:
            self.proof.step(now)

    def trouble(self, now: float) -> str:
        """Return the reason why the rig may be loaded again, "" for none; a person may reach in between proofs."""
        return self.unloaded.trouble(now) if self.trying else ""

    def stop(self) -> None:
        """Bring everything to standstill."""
        self.unloaded.stop()
        if self.proof is not None:
            self.proof.stop()


class TrialSeat(QuietSeat):
    """The rig lifted and unloaded, for trying watchdogs; drives have the torque of a run."""

    def __init__(self, rig: Rig, ports: Ports, hands: Any) -> None:
        """Connect."""
        believed = RigConfig.of(rig)
        devices = Devices(believed, ports)
        self.trials = Trials(devices, believed)
        super().__init__(
            believed, devices.cell, WheelArming(devices, believed), self.trials, believed.arming.listen_s
        )

    @property
    def ready(self) -> bool:
        """Whether every device has answered, the press is lifted, and nothing is loaded."""
        return super().ready and self.trials.unloaded.done and not self.trials.failure

    def prove(self, proof: WatchdogProof) -> Dialogue:
        """Yield until a proof is done; raises StepRefused if it failed."""
        self.trials.proof = proof
        yield lambda now_s: proof.done
        if proof.failure:
            raise StepRefused(f"watchdogs: {proof.failure}")


def watchdogs(seat: TrialSeat, notes: Notes) -> Dialogue:
    """Let each watchdog time out in front of a person; raises StepRefused for a watchdog without effect."""
    arming = seat.rig.arming
    if not (arming.bump_test and arming.watchdog_proof):
        raise StepRefused("watchdogs not shown: switched off in the rig file (arming.bump_test, arming.watchdog_proof)")
    drives = seat.devices.drives
    unproven = [drive.config.name for drive in drives if not drive.config.proves_watchdog]
    # Any other drive ends at its position: without setpoints these would keep moving.
    needing = [drive for drive in drives if drive.config.name in VELOCITY_AXES]
    without = [drive.config.name for drive in needing if not deadline_s(drive) > 0.0]
    if unproven:
        raise StepRefused(f"watchdogs not shown: the rig file leaves out axes.*.proves_watchdog: {', '.join(unproven)}")
    if without:
        raise StepRefused(f"no deadline for setpoints (axes.*.rpdo_deadline): {', '.join(without)}")
    motion = "hands off, guard closed; wheel, belt and press move a little, then wheel and belt creep"
    proofs: dict[str, tuple[type[WatchdogProof], str]] = {
        "heartbeat": (Proof, f"{motion}, without our heartbeat"),
        "setpoints": (SetpointProof, f"{motion}, without setpoints"),
    }

    def heat() -> Dialogue:
        ended = yield from _lease(seat, notes)
        notes.values["heat"] = ended
        watched = ", ".join(drive.config.name for drive in SetpointProof(seat.devices, seat.rig).watched())
        notes.text = f"each drive stops by itself without our heartbeat; {watched} without setpoints; heat: {ended}"

    stages: list[Stage] = []
    for name, (proof, text) in proofs.items():
        stages += [partial(_shown, seat, notes, name, proof, text), partial(_seen, name)]
    yield from in_stages(notes, *stages, heat)


def _shown(seat: TrialSeat, notes: Notes, name: str, kind: Any, text: str) -> Dialogue:
    """Try a watchdog at the person's command, and record every drive's deadline and report."""
    yield from press(f"watchdog {name}", text, seat.guarded)
    proof: WatchdogProof = kind(seat.devices, seat.rig)
    yield from seat.prove(proof)
    for drive in proof.watched():
        entry = (o.CONSUMER_HEARTBEAT, 1) if name == "heartbeat" else (o.RPDO_COMMUNICATION, 5)
        raw = drive.parameters.get(entry, 0)
        report = {
            "object": f"0x{entry[0]:04X}:{entry[1]:02d}", "read_back_ms": raw & 0xFFFF,
            "emergency": f"0x{proof.emergency:04X}", "after_ms": round(1e3 * proof.reported[drive.config.name]),
        }  # fmt: skip
        notes.read(f"{name}: {drive.config.name} stopped by itself", report)
        notes.values.setdefault(name, {})[drive.config.name] = report


def _seen(name: str) -> Dialogue:
    """Ask the person what they saw."""
    seen = yield from choose(f"watchdog {name} seen", "did wheel and belt stand still by themselves?", "yes", "no")
    if seen != "yes":
        raise StepRefused(f"watchdogs: a person saw wheel or belt run on without {name}, which their drives deny")


def _lease(seat: TrialSeat, notes: Notes) -> Generator[Waits, str, str]:
    """Run the jacket without heat, then send nothing until its lease, or its own setpoint, ends the run."""
    jacket: TemperatureController = seat.devices.jacket
    ends_s = jacket.ends_s
    if ends_s is None:
        how = seat.rig.devices["jacket"].heat_off or "nothing that the rig file names"
        notes.tell(f"  the jacket has no watchdog of its own: {how} ends its heat; try that out by hand")
        return f"ended by {how}, not tried out here"

    def renew(renews: bool) -> None:
        seat.arming.renews = renews

    return (yield from left_alone("jacket", jacket, ends_s, jacket.measured_c - COOLER_K, renew, notes))
