"""Bring the rig up: listen, configure the drives, hear every device, lift, home, show what must hold.

Nothing moves before every device is heard, and nothing but the press before the load cell has said that it is unloaded.
"""

from __future__ import annotations

from enum import Enum
from math import inf

from drivers.cia402 import Goal, State
from drivers.ports import BusLost
from tester.engine.arming import Proof
from tester.engine.devices import INPUT_GUARD, INPUT_SAFETY_CHAIN, Devices
from tester.engine.unloaded import Unloaded
from tester.interlocks.wires import CAN_SILENT
from tester.rig import RigConfig

CONNECT_S = 0.01
"""Period of the ticks while connecting, s: an SDO exchange takes half a millisecond on the wire."""
TIMEOUT_S = 90.0
"""Everything must be up by then; homing of a slow axis takes the most [A]."""
RAMP_S = 0.5
"""After a failure every axis stands by then: the ramp from creep speed takes 25 ms, that of homing 0.2 s [A]."""
RELEASE_S = 3.0
"""After a failure, drives that were configured are released by then [A]."""


class Stage(Enum):
    """How far the connection is."""

    LISTEN = "listen for another master"
    CONFIGURE = "configure drives"
    HEAR = "hear every device"
    LIFT = "lift the press and ask the load cell"
    HOME = "home position axes"
    PROVE = "try out the drives' watchdogs"
    RELEASE = "release the drives"
    READY = "ready"
    FAILED = "failed"


_HEARD = frozenset({Stage.LIFT, Stage.HOME, Stage.PROVE})
_MOVING = _HEARD | {Stage.HEAR}
"""Every drive is configured, and axes move or are about to: slowly, unloaded and cold."""
_SCANNING = _MOVING | {Stage.RELEASE}


class Connector:
    """Drives the connection, tick by tick."""

    def __init__(self, devices: Devices, rig: RigConfig) -> None:
        """Nothing is sent before the first ``tick``, and on the CAN bus not before the listening is over."""
        self.devices = devices
        self.rig = rig
        self.stage = Stage.LISTEN
        self.failure = ""
        self.shown = ""
        """What the proof has shown; a line for the journal."""
        self._unloaded: Unloaded | None = None
        self._proof: Proof | None = None
        self._configured_s = -inf
        self._started_s: float | None = None
        self._released_s: float | None = None

    @property
    def finished(self) -> bool:
        """Ready or failed."""
        return self.stage in (Stage.READY, Stage.FAILED)

    @property
    def failed(self) -> bool:
        """Given up; drives may still be being released."""
        return self.stage in (Stage.RELEASE, Stage.FAILED)

    @property
    def watches_drives(self) -> bool:
        """Every drive is configured, and one that stops by itself ends the connection at once."""
        return self.stage in _MOVING and not (self._proof is not None and self._proof.provokes)

    def tick(self, now: float) -> float:
        """Do what is due at ``now``; return when to be called again (s). Raises BusLost: the drives hear no more."""
        devices = self.devices
        if self._started_s is None:
            self._started_s = now
        devices.receive(now)
        if self.stage is Stage.RELEASE:
            self._release(now)
        else:
            self._advance(now, now - self._started_s)
        if self.stage is Stage.LISTEN or self.stage is Stage.FAILED:
            devices.transmit_lines(now)  # who gave up while listening has not spoken on the CAN bus
        else:
            devices.transmit(now, scan=self.stage in _SCANNING)
        if devices.lost and not devices.can_alive():
            raise BusLost(devices.lost)
        return now + CONNECT_S

    def abort(self, why: str) -> None:
        """Give up: whatever moves stops, and drives that were configured are released."""
        if not self.finished and self.stage is not Stage.RELEASE:
            self._fail(why)

    def _advance(self, now: float, elapsed: float) -> None:
        devices = self.devices
        refused = devices.refused()
        unfit = self._unfit(now) if self.stage in _MOVING else ""
        if self.stage in _HEARD:
            # The lease of a jacket that a program before us left behind is renewed; it stays in standby.
            devices.jacket.set_setpoint(self.rig.loops.heat.hub_min_c)
        if devices.lost:
            self._fail(devices.lost)
        elif refused:
            self._fail(refused)
        elif devices.master.foreign_master:
            self._fail(f"another CANopen master is sending on this bus: {devices.master.foreign_frame}")
        elif unfit:
            self._fail(f"not armed: {unfit}")
        elif elapsed > TIMEOUT_S:
            self._fail(f"not up after {TIMEOUT_S:g} s: {self._missing()}")
        elif self.stage is Stage.LISTEN:
            self._listen(elapsed)
        elif not any(devices.master.busy(drive) for drive in devices.drives):
            self._next(now)

    def _listen(self, elapsed: float) -> None:
        if elapsed < self.rig.arming.listen_s:
            return
        devices = self.devices
        for drive in devices.drives:
            devices.master.start(drive, drive.connect(self.rig.can.node))
        self.stage = Stage.CONFIGURE

    def _next(self, now: float) -> None:
        """Go on: no conversation with a drive is under way."""
        devices = self.devices
        if self.stage is Stage.CONFIGURE:
            devices.master.sync = True
            self._configured_s = now
            self.stage = Stage.HEAR
        elif self.stage is Stage.HEAR and devices.answering() and devices.axes.press.inputs_stamp_s > -inf:
            self._unloaded = Unloaded(devices, self.rig)
            self.stage = Stage.LIFT
        elif self.stage is Stage.LIFT and self._unloaded is not None:
            self._lift(self._unloaded, now)
        elif self.stage is Stage.HOME:
            self._proof = Proof(devices, self.rig)
            self.stage = Stage.PROVE
        elif self.stage is Stage.PROVE and self._proof is not None:
            self._prove(self._proof, now)

    def _lift(self, unloaded: Unloaded, now: float) -> None:
        unloaded.step(now)
        if unloaded.failure:
            self._fail(f"not armed: {unloaded.failure}")
        elif unloaded.done:
            devices = self.devices
            for drive in devices.drives:
                if drive.config.mode == "position":
                    devices.master.start(drive, drive.home())
            self.stage = Stage.HOME

    def _prove(self, proof: Proof, now: float) -> None:
        if not proof.done:
            proof.step(now)
        if proof.failure:
            self._fail(f"not armed: {proof.failure}")
        elif proof.done:
            self.shown = proof.proven()
            self.stage = Stage.READY

    def _unfit(self, now: float) -> str:
        """Return why no axis may move, or go on moving; "" while all may."""
        if all(drive.lost for drive in self.devices.drives):
            return f"{CAN_SILENT.name}: {CAN_SILENT.cause}"
        for drive in self.devices.drives:
            name = f"{drive.config.name} drive"
            if drive.lost:
                return f"{name} rebooted" if drive.rebooted else f"{name}: heartbeat lost"
            if self.watches_drives and drive.state in (State.FAULT, State.FAULT_REACTION):
                return f"{name} in fault" + (f": {drive.emergency.text}" if drive.emergency is not None else "")
        press = self.devices.axes.press
        if not press.inputs & INPUT_SAFETY_CHAIN:
            return "safety chain"
        if not press.inputs & INPUT_GUARD:
            return "guard open"
        heard_s = max(press.inputs_stamp_s, self._configured_s)
        if not now - heard_s <= self.rig.interlocks.stale_inputs_s:
            return f"inputs stale: the {press.config.name} drive sends none"
        return self._unloaded.trouble(now) if self._unloaded is not None else ""

    # -- giving up ------------------------------------------------------------------------------------------

    def _fail(self, why: str) -> None:
        self.failure = why
        if self.stage is Stage.LISTEN:
            self.stage = Stage.FAILED
            return
        if self._unloaded is not None:
            self._unloaded.stop()
        if self._proof is not None:
            self._proof.stop()
        master = self.devices.master
        for drive in self.devices.drives:
            master.cancel(drive)
        self._released_s = None
        self.stage = Stage.RELEASE

    def _release(self, now: float) -> None:
        """Let go of every drive that was configured, so that none takes our end for a fault."""
        devices, master = self.devices, self.devices.master
        if self._released_s is None:
            self._released_s = now
            for drive in devices.drives:
                if drive.connected:
                    master.start(drive, drive.release())
        elif not any(master.busy(drive) for drive in devices.drives) or now - self._released_s > RELEASE_S:
            self.stage = Stage.FAILED
        elif now - self._released_s > RAMP_S:
            for drive in devices.drives:
                if drive.state is State.OPERATION_ENABLED:
                    drive.goal = Goal.FREE  # it does not come to its standstill

    def _missing(self) -> str:
        """Name what has not answered."""
        devices = self.devices
        names = [drive.config.name for drive in devices.drives if devices.master.busy(drive) or not drive.online]
        for name, device in (
            ("load cell", devices.cell),
            ("infrared thermometer", devices.thermometer),
            ("jacket controller", devices.jacket),
        ):
            if not device.valid:
                names.append(name)
        return ", ".join(names) or "unknown"
