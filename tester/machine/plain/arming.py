"""What a plain machine asks of its devices, and shows, before a run may begin: every drive's watchdog is tried out.

CiA 301 starts watching a heartbeat only with the first one it hears, and a wrong parameter shows only when it is
needed. The drives are enabled for that and stand: nothing has to be lifted, and nothing moves.
"""

from __future__ import annotations

from math import inf

from tester.inputs.rig.plain import PlainRig
from tester.machine.devices import INPUT_GUARD, INPUT_SAFETY_CHAIN
from tester.machine.plain.devices import STANDING_SHARE, PlainDevices
from tester.machine.proof import WatchdogProof
from tester.machine.wires import CAN_SILENT, STALE_INPUTS_S


class NothingToLift:
    """A machine on which nothing is lifted is ready to be shown as it is."""

    done = True
    failure = ""

    def step(self, now: float) -> None:
        """Do nothing."""

    def stop(self) -> None:
        """Do nothing: nothing has been moved."""

    def trouble(self, now: float) -> str:
        """Return that there is none."""
        return ""


class StandingProof(WatchdogProof):
    """Tries the watchdogs out with the drives enabled and standing."""

    def begin(self, now: float) -> None:
        """Begin nothing: the drives stand."""

    def move(self, now: float, elapsed: float) -> bool:
        """Go on at once."""
        return True

    def stand(self) -> None:
        """Command zero to every drive."""
        for drive in self.devices.drives:
            drive.target = 0.0

    def still(self) -> bool:
        """Tell whether everything stands."""
        return all(abs(drive.actual) <= STANDING_SHARE * drive.config.max_speed for drive in self.devices.drives)

    def proven(self) -> str:
        """Return a line for the journal."""
        shown: list[str] = []
        left_out: list[str] = []
        self.watchdogs(shown, left_out)
        text = f"shown: {', '.join(shown) or 'nothing'}"
        return f"{text}; NOT shown: {', '.join(left_out)}" if left_out else text


class PlainArming:
    """What is asked and shown (``tester.machine.connect.Arming``)."""

    def __init__(self, devices: PlainDevices, rig: PlainRig) -> None:
        """Nothing is sent."""
        self.devices = devices
        self.rig = rig
        self._stale_s = rig.values()[STALE_INPUTS_S]

    def heard(self) -> bool:
        """Tell whether every device and the safety inputs have been heard."""
        return self.devices.answering() and self.devices.io.inputs_stamp_s > -inf

    def renew(self) -> None:
        """Renew nothing: sensors have no leases."""

    def unfit(self, now: float, configured_s: float) -> str:
        """Return what the safety inputs say, or that they say nothing."""
        io = self.devices.io
        if not io.inputs & INPUT_SAFETY_CHAIN:
            return "safety chain"
        if not io.inputs & INPUT_GUARD:
            return "guard open"
        if not now - max(io.inputs_stamp_s, configured_s) <= self._stale_s:
            return f"inputs stale: the {io.config.name} drive sends none"
        return ""

    def silent(self) -> str:
        """Return the row that says so."""
        return f"{CAN_SILENT.name}: {CAN_SILENT.cause}"

    def lift(self) -> NothingToLift:
        """Lift nothing."""
        return NothingToLift()

    def prove(self) -> StandingProof:
        """Try out the drives' watchdogs."""
        arming = self.rig.arming
        return StandingProof(self.devices, follow=False, watchdog=arming.watchdog_proof, withhold_s=arming.withhold_s)
