"""What a plain machine asks of its devices, and shows, before a run may begin: every drive's watchdog is tried out.

CiA 301 starts watching a heartbeat only with the first one it hears, and a wrong parameter shows only when it is
needed. The drives are enabled for that and stand: nothing has to be lifted, and nothing moves.
"""

from __future__ import annotations

from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.connect import Arming
from tester.machine.plain.devices import STANDING_SHARE, PlainDevices
from tester.machine.proof import WatchdogProof


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


class PlainArming(Arming[PlainDevices, PlainRig]):
    """Tries out the drives' watchdogs; nothing is lifted."""

    def lift(self) -> NothingToLift:
        """Lift nothing."""
        return NothingToLift()

    def prove(self) -> StandingProof:
        """Try out the drives' watchdogs."""
        arming = self.rig.arming
        return StandingProof(self.devices, follow=False, watchdog=arming.watchdog_proof, withhold_s=arming.withhold_s)
