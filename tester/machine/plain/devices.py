"""The devices of a plain machine: a drive for each axis of the rig file, a sensor for each profile."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, nan

from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.devices import DeviceList
from tester.machine.image import NEVER
from tester.machine.plain.image import PlainReadings, PlainSetpoints
from tester.machine.proof import STANDING_SHARE
from tester.machine.rig_drivers import RigDrivers
from tester.machine.rig_ports import Ports


class PlainDevices(DeviceList):
    """Drivers by their names in the rig file. ``own``: the machine's own sensors (``Rig.own``)."""

    def __init__(self, rig: PlainRig, ports: Ports) -> None:
        """Build drivers on these wires; nothing is sent."""
        drivers = RigDrivers(rig, ports)
        self.named = drivers.drives
        sensors = {name: drivers.sensor(name) for name in rig.own}
        self.own = {name: sensor for name, sensor in sensors.items() if sensor is not None}
        super().__init__(drivers, (next(iter(self.own.values())).link,))
        self._unknown: dict[str, Sequence[float]] = {
            name: [nan] * len(sensor.channels) for name, sensor in self.own.items()
        }

    def fill(self, r: PlainReadings, now: float) -> None:
        """Update the readings, the kind's own channels last (``PlainReadings.update``)."""
        dt = now - r.now_s
        r.now_s = now
        at_s, standing = inf, True
        for name, drive in self.named.items():
            r.drives[name] = drive.actual
            at_s = drive.stamp_s if drive.stamp_s < at_s else at_s
            standing = standing and abs(drive.actual) <= STANDING_SHARE * drive.config.max_speed
        r.drives_at_s, r.standing = at_s, standing
        self.fill_common(r, now)
        at_s = inf
        for name, sensor in self.own.items():
            r.sensors[name] = sensor.values if sensor.fresh(now) else self._unknown[name]
            at_s = min(at_s, sensor.stamp_s if sensor.valid else NEVER)
        r.sensors_at_s = at_s
        r.update(dt if dt <= 1.0 else 0.0)

    def apply(self, out: PlainSetpoints) -> None:
        """Pass the setpoints to the drives; ``transmit`` sends the frames."""
        self.apply_common(out)
        for name, speed in out.speeds.items():
            drive = self.named[name]
            if speed != drive.aimed:
                drive.aim(speed)
