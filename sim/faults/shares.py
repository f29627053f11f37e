"""Faults of what several members share: a supply, a ground, a line, an adapter, a clock, a temperature.

The members come from the rig file. Magnitudes are percent: of the reading for a gain, else of the member's span, so
that the members of one share go wrong alike.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from math import isfinite
from typing import Final, TypeAlias, cast

from drivers.profiles import DeviceProfile
from sim.faults import can
from sim.faults.kinds import Expected, Exposure, FaultKind
from sim.faults.modbus import Impaired
from sim.faults.scene import Effect, Scene
from sim.faults.sensors import SEED, SensorFault, SpoiledQuantity, spoiled
from sim.nodes.modbus_slave import ModbusSlave
from sim.nodes.sensor_slave import CellSlave, IrSlave, SensorSlave
from sim.noise import NormalStream
from sim.rig import RigSpec, title_of

FORCE_SPAN_N: Final = 500.0
"""Span of a load cell, N: where harm begins."""
TEMPERATURE_SPAN_K: Final = 100.0
"""Span of a temperature, K: 1 % is 1 K."""
PLAIN_SPAN: Final = 100.0
"""Span of a channel whose profile states no range, in its unit [A]."""
OF_READINGS: Final = frozenset(("supply", "ground", "temperature"))
"""What spoils the values of its members; the others spoil the way of the values to the computer."""
SLOW_KINDS: Final = frozenset(("jacket", "chamber", "ir_thermometer"))
"""Profiles of temperatures: their faults are watched for two minutes and more."""
_NOTE: Final = "python -m tests.campaigns.faults --magnitudes prints how much of it goes unnoticed, and its effect"
_READINGS: Final = (("gain", "%", 75.0), ("offset", "%", -10.0), ("drift", "%/min", -2.0), ("noise", "%", 5.0))
"""Kind of error, unit and usual value."""

Make: TypeAlias = Callable[[str, float], Effect]
"""Function that returns a member's fault from its kind and size."""


class Together(Effect):
    """Faults that begin and end together."""

    every_step = True

    def __init__(self, *effects: Effect) -> None:
        self._effects = effects
        self._renewed = tuple(effect for effect in effects if effect.every_step)

    def begin(self, scene: Scene, now: float) -> None:
        """Begin all of them."""
        for effect in self._effects:
            effect.begin(scene, now)

    def end(self, scene: Scene, now: float) -> None:
        """End all of them."""
        for effect in self._effects[::-1]:
            effect.end(scene, now)

    def renew(self, scene: Scene, now: float) -> None:
        """Renew those that need it."""
        for effect in self._renewed:
            effect.renew(scene, now)


class _OfDevice(SensorFault):
    """A fault of all readings of one Modbus device, by its name in the wiring."""

    def __init__(self, device: str, profile: DeviceProfile, kind: str, size: float) -> None:
        """``size``: in percent of the span (a gain: of the reading), a minute for a drift."""
        super().__init__(device, kind, size, force="")
        self._profile = profile
        self._sound: dict[str, object] = {}

    def slave(self, scene: Scene) -> ModbusSlave:
        """Return the device."""
        return scene.rig.wired[self.device]

    def begin(self, scene: Scene, now: float) -> None:
        """Spoil its readings from now on."""
        slave = self.slave(scene)
        if isinstance(slave, CellSlave):
            self.size = _size(self.kind, self.size, FORCE_SPAN_N)
        elif isinstance(slave, IrSlave) or not isinstance(slave, SensorSlave):
            self.size = _size(self.kind, self.size, TEMPERATURE_SPAN_K)
        elif self.kind != "frozen":
            self._spoil_channels(scene, slave, now)
            return
        super().begin(scene, now)

    def end(self, scene: Scene, now: float) -> None:
        """Show the true values again."""
        slave = self.slave(scene)
        for channel, source in self._sound.items():
            cast("SensorSlave", slave).show(channel, cast("float", source))
        super().end(scene, now)

    def _spoil_channels(self, scene: Scene, slave: SensorSlave, now: float) -> None:
        for signal in self._profile.blocks[0].signals:
            if signal.name != "status":
                span = signal.greatest - signal.least
                size = _size(self.kind, self.size, span if isfinite(span) else PLAIN_SPAN)
                wrong = SpoiledQuantity(self.kind, size, now, scene.rig, f"{self.device} {signal.name}")
                self._sound[signal.name] = wrong.source = slave.show(signal.name, wrong)


class _OfDrive(Effect):
    """A drive measures its torque wrongly; its limit of the torque (0x6072) is as wrong."""

    every_step = True

    def __init__(self, axis: str, kind: str, size: float) -> None:
        """``size``: as of a device; the span is the drive's limit."""
        self._axis, self._kind, self._percent = axis, kind, size
        self._since_s = 0.0
        self._noise = NormalStream(SEED, f"faulty torque of {axis}")

    def begin(self, scene: Scene, now: float) -> None:
        """Begin at ``now`` s."""
        self._since_s = now
        self.renew(scene, now)

    def end(self, scene: Scene, now: float) -> None:
        """Measure right again."""
        scene.rig.axes[self._axis].misread_torque(1.0, 0.0)

    def renew(self, scene: Scene, now: float) -> None:
        """Update the error of the reading for ``now`` s."""
        drive, kind = scene.rig.axes[self._axis], self._kind
        if kind == "gain":
            if drive.torque_gain == 1.0:
                drive.misread_torque(max(0.01 * self._percent, 0.01), 0.0)
            return
        # The limit is written at connect, and the fault may be older.
        span_nm = drive.torque_limit_nm * drive.torque_gain + drive.torque_offset_nm
        size = _size(kind, self._percent, span_nm)
        drive.misread_torque(1.0, spoiled(kind, 0.0, size, now - self._since_s, self._noise, 0.0))


def _size(kind: str, percent: float, span: float) -> float:
    """Return the size of an error in the member's unit (a drift: in a second); percent for a gain."""
    if kind == "gain":
        return percent
    return 0.01 * percent * span / (60.0 if kind == "drift" else 1.0)


def _makers(spec: RigSpec, member: str) -> Iterator[Make]:
    """Yield what makes the faults of a member: of each transmitter of a load cell with several."""
    for name, device in spec.devices.items():
        if member in (name, device.part_of):
            yield partial(_OfDevice, name, device.profile)
    if member in spec.axes:
        yield partial(_OfDrive, member)


def _spoil(spec: RigSpec, members: tuple[str, ...], kind: str, percent: float) -> Effect:
    return Together(*(make(kind, percent) for member in members for make in _makers(spec, member)))


def _freeze(spec: RigSpec, members: tuple[str, ...]) -> Effect:
    drives = [can.data_frozen(member) for member in members if member in spec.axes]
    devices = [make("frozen", 0.0) for member in members if member not in spec.axes for make in _makers(spec, member)]
    return Together(*drives, *devices)


def _silence(spec: RigSpec, members: tuple[str, ...]) -> Effect:
    drives = [can.node_cut(member) for member in members if member in spec.axes]
    devices = [
        Impaired(title_of(name), kind="silence") for name, device in spec.devices.items()
        if name in members or device.part_of in members
    ]  # fmt: skip
    return Together(*drives, *devices)


def share_rows(spec: RigSpec) -> Iterator[FaultKind]:
    """Yield the faults of a wiring's shares: "common NAME gain", and so on."""
    for name, share in spec.shares.items():
        members, words = share.members, f"common {title_of(name)}"
        slow = any(
            device.profile.kind in SLOW_KINDS for key, device in spec.devices.items() if key in members
        )
        row = partial(FaultKind, exposure=Exposure.ALWAYS, reaction=Expected.MAY, note=_NOTE)
        yield row(f"{words} frozen", partial(_freeze, spec, members))
        if share.shared in OF_READINGS:
            for kind, unit, value in _READINGS:
                make = partial(_spoil, spec, members, kind)
                yield row(f"{words} {kind}", make, unit=unit, value=value, slow=slow and kind != "noise")
        else:
            yield row(f"{words} silent", partial(_silence, spec, members))
