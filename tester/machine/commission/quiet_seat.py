"""A rig with untested scales: connected, with every drive off except the drive that a person jogs.

This comes before arming, and so before the interlock table: most of its rows depend on scales. The checks are those of
the connection before every run (tester.machine.connect), and the load cell must stay constant. Two bounds need no
scale: a jog lasts at most ``jogging.PRESS_S`` for each key press, and the drive has only a share of its torque.
"""

from __future__ import annotations

from math import inf
from typing import Any

from drivers.joined_cell import LoadCell
from tester.inputs.rig import Rig
from tester.machine.commission.jogging import Jogging, Moving
from tester.machine.connect import Arming, Connector, Lifting, Stage
from tester.machine.devices import INPUT_GUARD, INPUT_SAFETY_CHAIN, DeviceList
from tester.machine.proof import WatchdogProof


class QuietArming(Arming[Any, Any]):
    """A kind's arming, but without power the guard may be open, so that a person can read a ruler."""

    def __init__(self, arming: Arming[Any, Any], moving: Moving) -> None:
        """``moving``: jogs or trials, in place of a run's lift."""
        super().__init__(arming.devices, arming.rig)
        self._arming = arming
        self.moving = moving
        self.renews = True
        """Leases are renewed, unless one is being tried."""

    def reported(self) -> bool:
        return self._arming.reported()

    def unfit(self, now: float, configured_s: float) -> str:
        reason = self._arming.unfit(now, configured_s)
        if reason == "safety chain" and self.moving.chain_may_open:
            return ""
        return reason if self.moving.powered or reason not in ("safety chain", "guard open") else ""

    def silent(self) -> str:
        return self._arming.silent()

    def renew(self) -> None:
        if self.renews:
            self._arming.renew()

    def lift(self) -> Lifting:
        return self.moving

    def prove(self) -> WatchdogProof:
        return self._arming.prove()


class QuietConnector(Connector):
    """Connects, waits for the devices, and stays there: no homing, no proof."""

    def __init__(self, devices: DeviceList, rig: Rig, arming: QuietArming, listen_s: float) -> None:
        """Send nothing."""
        super().__init__(devices, rig, arming, listen_s)
        self._moving = arming.moving

    @property
    def watches_drives(self) -> bool:
        return super().watches_drives and not (self._moving.provokes or self._moving.chain_may_open)

    def _lift(self, lifting: Any, now: float) -> None:
        self.timeout_s = inf  # every device answers: a person takes the time that he or she needs
        lifting.step(now)
        if lifting.failure:
            self._fail(lifting.failure)


class QuietSeat:
    """The rig during the first steps (tester.machine.commission.commission_step.Seat)."""

    def __init__(
        self, believed: Rig, cell: LoadCell, arming: Arming[Any, Any], moving: Moving, listen_s: float
    ) -> None:
        """Connect. ``believed``: the rig file's rig; ``arming``: the kind's, of the rig with the drives' bounds."""
        self.cell, self.moving = cell, moving
        self.believed: Any = believed
        self.devices: Any = arming.devices
        self.rig: Any = arming.rig
        self.arming = QuietArming(arming, moving)
        self.connector = QuietConnector(self.devices, self.rig, self.arming, listen_s)

    @property
    def ready(self) -> bool:
        """Whether every device is connected and answers."""
        return self.connector.stage is Stage.LIFT

    @property
    def finished(self) -> bool:
        """Whether everything is released."""
        return self.connector.finished

    @property
    def reason(self) -> str:
        """Reason for an unrequested end; "" after ``stop``."""
        return self.connector.failure

    def guarded(self) -> bool:
        """Return whether guard and safety chain are closed."""
        closed = INPUT_GUARD | INPUT_SAFETY_CHAIN
        return self.devices.io.inputs & closed == closed

    def tick(self, now: float) -> float:
        """Advance the rig by one tick."""
        return self.connector.tick(now)

    def stop(self, why: str, *, fast: bool = False) -> None:
        """Stop, and release the drives."""
        self.connector.abort("")

    def abandon(self) -> None:
        """Send zero and power off once."""
        self.moving.stop()
        self.devices.transmit(self.moving.stepped_s, scan=True)


class JogSeat(QuietSeat):
    """The rig while a person jogs its axes, one at a time, with the drives bounded (``slowed``)."""

    def __init__(self, believed: Rig, arming: Arming[Any, Any], jogging: Jogging, listen_s: float) -> None:
        """Connect."""
        self.jogging = jogging
        super().__init__(believed, jogging.watch.cell, arming, jogging, listen_s)
