"""Faults of the drives and of the mechanics they move."""

from __future__ import annotations

from drivers.canopen import objects as o
from drivers.canopen.messages import encode_emergency
from sim.faults.scene import Effect, Scene
from sim.nodes.cia402_slave import Cia402Slave
from sim.nodes.drive_power import ENERGISED
from sim.nodes.motion import VelocityAxis

MOTOR_BLOCKED = 0x7121
BLOCKED_S = 0.5
"""A drive calls its motor blocked after this long at its torque limit, s [A]."""


class _OnAxis(Effect):
    """A fault of one axis."""

    __slots__ = ("axis",)

    def __init__(self, axis: str) -> None:
        """Of this axis."""
        self.axis = axis

    def drive(self, scene: Scene) -> Cia402Slave:
        """Return the axis' drive."""
        return scene.rig.axes[self.axis]


class DriveFault(_OnAxis):
    """The drive enters its fault reaction, and its cause stays."""

    __slots__ = ("code",)

    def __init__(self, axis: str, code: int) -> None:
        """With this emergency code."""
        super().__init__(axis)
        self.code = code

    def begin(self, scene: Scene, now: float) -> None:
        """Enter the fault reaction."""
        self.drive(scene).fault(self.code, persistent=True)

    def end(self, scene: Scene, now: float) -> None:
        """Remove the cause; the fault stays until it is reset."""
        self.drive(scene).clear_cause(self.code)


class EmcyReport(_OnAxis):
    """The drive reports an error and goes on."""

    __slots__ = ("code",)

    def __init__(self, axis: str, code: int) -> None:
        """With this emergency code."""
        super().__init__(axis)
        self.code = code

    def begin(self, scene: Scene, now: float) -> None:
        """Report it."""
        self.drive(scene).error(self.code, now)

    def end(self, scene: Scene, now: float) -> None:
        """Report that it has gone."""
        self.drive(scene).recovered(self.code, now)


class ShortEmergency(EmcyReport):
    """The drive reports an error in a frame that is too short."""

    __slots__ = ("length",)

    def __init__(self, axis: str, code: int, length: int) -> None:
        """With the first ``length`` bytes of the message for this emergency code."""
        super().__init__(axis, code)
        self.length = length

    def begin(self, scene: Scene, now: float) -> None:
        """Report it, once."""
        drive = self.drive(scene)
        drive.wire.transmit(o.EMERGENCY_BASE + drive.node_id, encode_emergency(self.code, 1)[: self.length], now, True)

    def end(self, scene: Scene, now: float) -> None:
        """Say nothing: the drive never took note of it."""


class HeartbeatLost(_OnAxis):
    """The drive's heartbeat is not sent; everything else is."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Send no heartbeat."""
        self.drive(scene).withhold_heartbeat(True)

    def end(self, scene: Scene, now: float) -> None:
        """Send it again."""
        self.drive(scene).withhold_heartbeat(False)


class Unpowered(_OnAxis):
    """The drive has lost its control supply; when it comes back the drive boots."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Switch it off."""
        self.drive(scene).power(False)

    def end(self, scene: Scene, now: float) -> None:
        """Switch it on."""
        self.drive(scene).power(True)


class Reboot(_OnAxis):
    """The drive restarts (a dip in its supply): one boot-up message in the middle of a run."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Restart."""
        drive = self.drive(scene)
        drive.power(False)
        drive.power(True)


class TorqueOff(_OnAxis):
    """The drive's safe-torque-off input opens: no supply for its power stage."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Open it."""
        self.drive(scene).set_torque_off(True)

    def end(self, scene: Scene, now: float) -> None:
        """Close it."""
        self.drive(scene).set_torque_off(False)


class Local(_OnAxis):
    """Somebody takes the drive over at its keypad: it stops by itself [A] and ignores the bus."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Take it over."""
        drive = self.drive(scene)
        drive.set_local(True)
        if isinstance(drive.axis, VelocityAxis):
            drive.axis.aim(0.0, deceleration=drive.config.deceleration)

    def end(self, scene: Scene, now: float) -> None:
        """Give it back."""
        self.drive(scene).set_local(False)


class WrongIdentity(_OnAxis):
    """Another product answers at the drive's address: seen at the next connection."""

    __slots__ = ("_product",)

    def __init__(self, axis: str) -> None:
        """At this axis."""
        super().__init__(axis)
        self._product = 0

    def begin(self, scene: Scene, now: float) -> None:
        """Show another product code."""
        values = self.drive(scene).store.values
        self._product = values[(o.IDENTITY, 2)]
        values[(o.IDENTITY, 2)] = self._product + 1

    def end(self, scene: Scene, now: float) -> None:
        """Show the own one."""
        self.drive(scene).store.values[(o.IDENTITY, 2)] = self._product


class Jammed(_OnAxis):
    """The shaft stands; the drive pushes, and calls its motor blocked after a while where it was moving."""

    __slots__ = ("_since_s",)

    every_step = True

    def __init__(self, axis: str) -> None:
        """Of this axis."""
        super().__init__(axis)
        self._since_s = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Hold the shaft."""
        self._since_s = now
        self.drive(scene).block(True)

    def end(self, scene: Scene, now: float) -> None:
        """Free the shaft."""
        self.drive(scene).block(False)

    def renew(self, scene: Scene, now: float) -> None:
        """Count how long the drive has pushed."""
        drive = self.drive(scene)
        pushing = drive.state in ENERGISED and abs(drive.axis.demand) > 0.02 * drive.config.max_speed
        if not (pushing and isinstance(drive.axis, VelocityAxis)):
            self._since_s = now
        elif now - self._since_s >= BLOCKED_S:
            drive.fault(MOTOR_BLOCKED)


class Runaway(_OnAxis):
    """The axis moves by itself whenever its power stage is on, whatever is commanded (a broken velocity loop)."""

    __slots__ = ("speed",)

    every_step = True

    def __init__(self, axis: str, speed: float) -> None:
        """At this speed (unit of the axis per s)."""
        super().__init__(axis)
        self.speed = speed

    def renew(self, scene: Scene, now: float) -> None:
        """Override what was commanded; without power the axis does what it does without power."""
        drive = self.drive(scene)
        if drive.state in ENERGISED and isinstance(drive.axis, VelocityAxis):
            drive.axis.aim(self.speed)
