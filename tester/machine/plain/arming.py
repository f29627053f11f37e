"""The proof of a plain machine before a run may begin: it tests the watchdog of every drive.

A drive watches a heartbeat only from the first one it receives (CiA 301), so a wrong parameter would show only when the
watchdog is needed. The proof enables the drives at standstill: nothing is lifted, and nothing moves.
"""

from __future__ import annotations

from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.connect import Arming
from tester.machine.plain.devices import STANDING_SHARE, PlainDevices
from tester.machine.proof import WatchdogProof


class NothingToLift:
    """The lift of a machine that lifts nothing: done at once."""

    done = True
    failure = ""

    def step(self, now: float) -> None:
        """Do nothing."""

    def stop(self) -> None:
        """Do nothing: nothing has been moved."""

    def trouble(self, now: float) -> str:
        """Return "": no load can arise."""
        return ""


class StandingProof(WatchdogProof):
    """Tests the watchdogs with the drives enabled at standstill."""

    def begin(self, now: float) -> None:
        """Do nothing: no drive moves in this proof."""

    def move(self, now: float, elapsed: float) -> bool:
        """Return True: nothing has to move."""
        return True

    def stand(self) -> None:
        """Command zero to every drive."""
        for drive in self.devices.drives:
            drive.target = 0.0

    def still(self) -> bool:
        """Return whether every drive is at rest."""
        return all(abs(drive.actual) <= STANDING_SHARE * drive.config.max_speed for drive in self.devices.drives)


class PlainArming(Arming[PlainDevices, PlainRig]):
    """Tests the drives' watchdogs; lifts nothing."""

    def lift(self) -> NothingToLift:
        """Lift nothing."""
        return NothingToLift()

    def prove(self) -> StandingProof:
        """Begin to test the drives' watchdogs."""
        arming = self.rig.arming
        return StandingProof(self.devices, follow=False, watchdog=arming.watchdog_proof, withhold_s=arming.withhold_s)
