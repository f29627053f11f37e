"""Connects a rig: listens, configures the drives, waits for every device, lifts, homes, and proves its safety
functions.

Nothing moves before every device has answered. Until the kind has shown that nothing is loaded, only the lift moves.
"""

from __future__ import annotations

from enum import Enum
from math import inf, nan
from typing import Any, Generic, TypeVar

from drivers.cia402 import Goal, State
from drivers.joined_cell import Transmitter
from drivers.ports import BusLost
from tester.inputs.rig import Rig
from tester.machine import line_speed
from tester.machine.devices import INPUT_GUARD, INPUT_SAFETY_CHAIN, DeviceList
from tester.machine.proof import WatchdogProof
from tester.machine.safety_inputs import InputStates
from tester.machine.wires import CAN_SILENT, SILENT_CAN_HEARTBEATS, STALE_INPUTS_S

CONNECT_S = 0.01
"""Period of the ticks while connecting, s: an SDO exchange takes half a millisecond on the wire."""
TIMEOUT_S = 90.0
"""Time limit for the connection; the homing of a slow axis takes most of it [A]."""
_TINY_S = 1e-9
RAMP_S = 0.5
"""Time for every axis to stop after a failure: the ramp takes 25 ms from creep speed, 0.2 s from homing speed [A]."""
RELEASE_S = 3.0
"""Time limit for releasing configured drives after a failure [A]."""


class Stage(Enum):
    """Stage of the connection."""

    LISTEN = "listen for another master"
    CONFIGURE = "configure drives"
    HEAR = "hear every device"
    LIFT = "lift and ask the load cell"
    HOME = "home position axes"
    PROVE = "try out the drives' watchdogs"
    RELEASE = "release the drives"
    READY = "ready"
    FAILED = "failed"


_HEARD = frozenset({Stage.LIFT, Stage.HOME, Stage.PROVE})
_MOVING = _HEARD | {Stage.HEAR}
"""Stages in which every drive is configured, and axes move or are about to: slowly, unloaded and cold."""
_SCANNING = _MOVING | {Stage.RELEASE}


_POWERED = (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE, State.FAULT_REACTION)
"""States in which a drive applies torque; a drive that ignores commands never leaves its quick stop by itself."""


class Lifting:
    """Proves that nothing is loaded, one call of ``step`` a scan, and keeps watching that this stays so.

    By default it is done at once: the machine lifts nothing, and no load can arise.
    """

    done: bool = True
    """Whether the proof is over, successful or not."""
    failure: str = ""
    """Why the proof failed; "" if it has not failed."""

    def step(self, now: float) -> None:
        """Advance by one scan at ``now`` s."""

    def stop(self) -> None:
        """Bring every axis that the proof moved to standstill, power off."""

    def trouble(self, now: float) -> str:
        """Return why a rig that was proven unloaded may no longer be; "" if it still is."""
        return ""


DevicesT = TypeVar("DevicesT", bound=DeviceList)
RigT = TypeVar("RigT", bound=Rig)


class Arming(Generic[DevicesT, RigT]):
    """Checks and proofs before a run may begin. A kind implements the proof of its drives, and a lift if it has one."""

    def __init__(self, devices: DevicesT, rig: RigT) -> None:
        """Send nothing."""
        self.devices = devices
        self.rig = rig
        self._stale_s = rig.values()[STALE_INPUTS_S]
        self._inputs = InputStates(rig)

    def reported(self) -> bool:
        """Return whether every device and the safety inputs have reported."""
        return self.devices.answering() and self.devices.io.inputs_stamp_s > -inf

    def renew(self) -> None:
        """Renew the leases of devices that an earlier program left on the rig; they stay off."""

    def unfit(self, now: float, configured_s: float) -> str:
        """Return why no axis may move, "" if all may. Drives have sent cyclic data since ``configured_s``."""
        io = self.devices.io
        if not io.inputs & INPUT_SAFETY_CHAIN:
            return "safety chain"
        if not io.inputs & INPUT_GUARD:
            return "guard open"
        if not now - max(io.inputs_stamp_s, configured_s) <= self._stale_s:
            return f"inputs stale: the {io.config.name} drive sends none"
        if self._inputs.size:
            channels = [nan] * self._inputs.size
            self.devices.fill_channels(channels, now)
            return ", ".join(name for name, closed in self._inputs.closed(channels).items() if not closed)
        return ""

    def at_rest(self) -> str:
        """Return why a rig with the present readings, at rest and not connected, may not be armed; "" if it may.

        Called for each new reading.
        """
        return ""

    def silent(self) -> str:
        """Return the explanation to show when no drive responds."""
        return f"{CAN_SILENT.name}: {CAN_SILENT.cause}"

    def lift(self) -> Lifting:
        """Return the proof that nothing is loaded; it begins with its first step."""
        return Lifting()

    def prove(self) -> WatchdogProof:
        """Return the proof that the drives follow commands and stop; it begins with its first step."""
        raise NotImplementedError


class Connector:
    """Runs the connection, tick by tick."""

    timeout_s: float = TIMEOUT_S
    """Time limit for the connection; inf while a person takes part in it."""

    def __init__(self, devices: DeviceList, rig: Rig, arming: Arming[Any, Any], listen_s: float) -> None:
        """Send nothing before the first ``tick``, and nothing on the CAN bus before the listening period is over."""
        self.devices = devices
        self.rig = rig
        self.listen_s = listen_s
        self._silent_s = rig.values()[SILENT_CAN_HEARTBEATS] * rig.can.drive_heartbeat_s
        self.arming = arming
        self.stage = Stage.LISTEN
        self.failure = ""
        self.shown = ""
        """The result of the proof as a line for the journal."""
        self._lifting: Lifting | None = None
        self._proof: WatchdogProof | None = None
        self._configured_s = -inf
        self._joined = any(isinstance(device.driver, Transmitter) for device in devices.modbus)
        self._scan_s = -inf
        """Time of the next scan, s."""
        self._started_s: float | None = None
        self._released_s: float | None = None

    @property
    def finished(self) -> bool:
        """Whether the connection is ready or has failed."""
        return self.stage in (Stage.READY, Stage.FAILED)

    @property
    def failed(self) -> bool:
        """Whether the connection has failed; drives may still be being released."""
        return self.stage in (Stage.RELEASE, Stage.FAILED)

    @property
    def watches_drives(self) -> bool:
        """Whether every drive is configured: from then on a drive that stops by itself ends the connection at once."""
        return self.stage in _MOVING and not (self._proof is not None and self._proof.provokes)

    def tick(self, now: float) -> float:
        """Do everything due at ``now``; return the time of the next call (s). Raises BusLost if the drives cannot be
        reached.
        """
        devices = self.devices
        if self._started_s is None:
            self._started_s = now
        devices.receive(now)
        if self.stage is Stage.RELEASE:
            self._release(now)
        else:
            self._advance(now, now - self._started_s)
        between = self._joined and now < self._scan_s - _TINY_S
        prompt_s = inf
        if self.stage is Stage.LISTEN or self.stage is Stage.FAILED:
            devices.transmit_lines(now)  # stay silent on the CAN bus until the listening has succeeded
        else:
            prompt_s = devices.transmit(now, scan=self.stage in _SCANNING and not between)
        if devices.lost and not devices.can_alive:
            raise BusLost(devices.lost)
        measuring = not self.finished and devices.real_lines() and not line_speed.measured(devices)
        if measuring:
            return now + line_speed.FINE_S
        if not between:
            self._scan_s = now + CONNECT_S
        # Between two scans only the parts of a load cell are read: as close together as the line allows, as in a run.
        return min(self._scan_s, max(prompt_s, now + line_speed.FINE_S)) if self._joined else self._scan_s

    def abort(self, why: str) -> None:
        """Give up: stop everything that moves, and release configured drives."""
        if not self.finished and self.stage is not Stage.RELEASE:
            self._fail(why)

    def _advance(self, now: float, elapsed: float) -> None:
        devices = self.devices
        # While other devices are still being configured, hold a refusal back, so that all refusals are reported
        # together.
        refused = "" if self.stage is Stage.CONFIGURE and devices.busy() else devices.refused()
        unfit = self._unfit(now) if self.stage in _MOVING else ""
        if self.stage in _HEARD:
            self.arming.renew()
        if devices.lost:
            self._fail(devices.lost)
        elif refused:
            self._fail(refused)
        elif devices.master.foreign_master:
            self._fail(f"another CANopen master is sending on this bus: {devices.master.foreign_frame}")
        elif unfit:
            self._fail(f"not armed: {unfit}")
        elif elapsed > self.timeout_s:
            self._fail(f"not up after {self.timeout_s:g} s: {self._missing()}")
        elif self.stage is Stage.LISTEN:
            self._listen(elapsed)
        elif not devices.busy():
            self._next(now)
        silent = self.arming.silent()
        missed = self.failed and not devices.lost and silent not in self.failure and not devices.refused_by_lines()
        if missed and devices.bus_silent(now, self._silent_s):
            # Where the whole bus is silent, the cable is the cause, and the drive that was missed first is not.
            self.failure = f"not armed: {silent} ({self.failure.removeprefix('not armed: ')})"

    def _listen(self, elapsed: float) -> None:
        if elapsed < self.listen_s:
            return
        devices = self.devices
        for drive in devices.drives:
            devices.master.start(drive, drive.connect(self.rig.can.node))
        for node in devices.nodes:
            devices.master.start(node, node.connect())
        self.stage = Stage.CONFIGURE

    def _next(self, now: float) -> None:
        """Enter the next stage; called while no exchange with a drive is under way."""
        devices = self.devices
        if self.stage is Stage.CONFIGURE:
            devices.master.sync = True
            self._configured_s = now
            self.stage = Stage.HEAR
        elif self.stage is Stage.HEAR and self.arming.reported() and line_speed.measured(devices):
            limits = self.rig.stale_limits()
            slow = line_speed.too_slow(devices, limits)
            if slow:
                self._fail(slow)
                return
            line_speed.allow_late(devices, limits)
            self._lifting = self.arming.lift()
            self.stage = Stage.LIFT
        elif self.stage is Stage.LIFT and self._lifting is not None:
            self._lift(self._lifting, now)
        elif self.stage is Stage.HOME:
            self._proof = self.arming.prove()
            self.stage = Stage.PROVE
        elif self.stage is Stage.PROVE and self._proof is not None:
            self._prove(self._proof, now)

    def _lift(self, lifting: Lifting, now: float) -> None:
        lifting.step(now)
        if lifting.failure:
            self._fail(f"not armed: {lifting.failure}")
        elif lifting.done:
            devices = self.devices
            for drive in devices.drives:
                if drive.config.mode == "position":
                    devices.master.start(drive, drive.home())
            self.stage = Stage.HOME

    def _prove(self, proof: WatchdogProof, now: float) -> None:
        if not proof.done:
            proof.step(now)
        if proof.failure:
            self._fail(f"not armed: {proof.failure}")
        elif proof.done:
            self.shown = proof.proven()
            self.stage = Stage.READY

    def _unfit(self, now: float) -> str:
        """Return why no axis may start or continue to move; "" if all may."""
        if all(drive.lost for drive in self.devices.drives):
            return self.arming.silent()
        for drive in self.devices.drives:
            name = f"{drive.config.name} drive"
            if drive.lost:
                return f"{name} rebooted" if drive.rebooted else f"{name}: heartbeat lost"
            if self.watches_drives and drive.state in (State.FAULT, State.FAULT_REACTION):
                return f"{name} in fault" + (f": {drive.emergency.text}" if drive.emergency is not None else "")
        unfit = self.arming.unfit(now, self._configured_s)
        if unfit or self._lifting is None:
            return unfit
        return self._lifting.trouble(now)

    # -- giving up ------------------------------------------------------------------------------------------

    def _fail(self, why: str) -> None:
        self.failure = why
        if self.stage is Stage.LISTEN:
            self.stage = Stage.FAILED
            return
        if self._lifting is not None:
            self._lifting.stop()
        if self._proof is not None:
            self._proof.stop()
        master = self.devices.master
        for node in master.nodes:
            master.cancel(node)
        self._released_s = None
        self.stage = Stage.RELEASE

    def _release(self, now: float) -> None:
        """Release every configured drive, so that none reports a fault when our heartbeat ends."""
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
                if drive.state in _POWERED:
                    drive.goal = Goal.FREE  # it does not come to rest: stop waiting for standstill

    def _missing(self) -> str:
        """Return the names of devices that have not answered."""
        return ", ".join(self.devices.missing()) or "unknown"
