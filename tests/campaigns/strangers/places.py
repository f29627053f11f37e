"""The places of both kinds of machine that can fail: wires, drives and physics."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from drivers.canopen import objects as o
from sim.faults import can
from sim.faults.cabinet import guard_open, stalled
from sim.faults.modbus import Impaired
from sim.faults.scene import Effect, Scene
from sim.nodes.drive_power import ENERGISED
from tests.campaigns.strangers.defect import Apply, Place, Reading

FORCE = {"fx": 0, "fy": 1, "fz": 2}
_FEW = 1e-6


def _reading(device: str, what: str, channel: str = "fz") -> Callable[[Scene], Apply]:
    """Return an effect that spoils a device's reading: ``what`` is "gain", "offset" or "holds"."""

    def make(scene: Scene) -> Apply:
        slave: Any = scene.rig.devices[device]
        floor = 0.0 if "cell" in device else scene.rig.ambient_c
        slave.source = reading = Reading(slave.source, FORCE[channel], floor)

        def apply(scene: Scene, size: float) -> None:
            setattr(reading, what, size != 0.0 if what == "holds" else size)

        return apply

    return make


def _switch(effect: Callable[[], Effect]) -> Callable[[Scene], Apply]:
    """Return a function that begins an effect at any size and ends it at 0."""

    def make(scene: Scene) -> Apply:
        running: list[Effect] = []

        def apply(scene: Scene, size: float) -> None:
            if size != 0.0 and not running:
                running.append(effect())
                running[0].begin(scene, scene.rig.now_s)
            elif size == 0.0 and running:
                running.pop().end(scene, scene.rig.now_s)

        return apply

    return make


def _on_axis(axis: str, act: Callable[[Any, float], None]) -> Callable[[Scene], Apply]:
    """Return a function that applies each size to a drive."""
    return lambda scene: lambda scene, size: act(scene.rig.axes[axis], size)


def _drifts(drive: Any, speed: float) -> None:
    """Move an axis at another speed than its command, while its power stage is on."""
    if speed != 0.0 and drive.state in ENERGISED:
        drive.axis.aim(drive.axis.target * (1.0 + speed))


def _runs(drive: Any, speed: float) -> None:
    """Move an axis at a speed of its own, while its power stage is on."""
    if speed != 0.0 and drive.state in ENERGISED:
        drive.axis.aim(speed)


def _brakes(axis: str) -> Callable[[Scene], Apply]:
    """Return an effect that makes an axis brake less than its drive's ramp, by a share."""

    def make(scene: Scene) -> Apply:
        drive: Any = scene.rig.axes[axis]
        sound = drive.axis.deceleration

        def apply(scene: Scene, size: float) -> None:
            if size != 0.0:
                limit = max((1.0 - size) * drive.config.deceleration, _FEW)
                drive.axis.deceleration = min(drive.axis.deceleration, limit)
            else:
                drive.axis.deceleration = sound

        return apply

    return make


def _misreads(drive: Any, size: float) -> None:
    """Measure the torque, and limit it, with an error of gain."""
    drive.misread_torque(1.0 + size, 0.0)


def _held(drive: Any, size: float) -> None:
    if drive.axis.blocked != (size != 0.0):
        drive.block(size != 0.0)


def _scale(sensor: str) -> Callable[[Scene], Apply]:
    """Return an effect that makes a shaft turn slower than its drive shows, by a share."""

    def make(scene: Scene) -> Apply:
        shown: Any = getattr(scene.rig.plant, sensor)
        sound = [1.0]

        def apply(scene: Scene, size: float) -> None:
            shown.factor *= (1.0 + size) / sound[0]
            sound[0] = 1.0 + size

        return apply

    return make


def _torque(shaft: str) -> Callable[[Scene], Apply]:
    """Return an effect that makes a drive show a wrong torque, by a share."""

    def make(scene: Scene) -> Apply:
        shown: Any = getattr(scene.rig, shaft)
        sound = shown._gain

        def apply(scene: Scene, size: float) -> None:
            shown._gain = sound * (1.0 + size)

        return apply

    return make


def _plant(act: Callable[[Any, float], None]) -> Callable[[Scene], Apply]:
    """Return a function that applies each size to the plant."""
    return lambda scene: lambda scene, size: act(scene.rig.plant, size)


def _touch(scene: Scene) -> Apply:
    """Return an effect that moves the wheel towards the belt, unseen by the press's encoder, mm."""
    sound = [0.0]

    def apply(scene: Scene, size: float) -> None:
        scene.rig.plant._touch_mm -= size - sound[0]
        sound[0] = size

    return apply


def _stiffness(scene: Scene) -> Apply:
    """Return an effect that makes the rubber stiffer, by a share, from the next change of its temperature."""
    plant: Any = scene.rig.plant
    sound = plant._cold_factor

    def apply(scene: Scene, size: float) -> None:
        plant._cold_factor = sound * (1.0 + size)

    return apply


def _belt_slip(scene: Scene) -> Apply:
    """Return an effect that makes the belt slower than its roller, by a share."""
    rig: Any = scene.rig
    scale = _scale("belt_speed")(scene)

    def apply(scene: Scene, size: float) -> None:
        rig.belt_slip = size
        scale(scene, 1.0 / (1.0 - size) - 1.0)

    return apply


def _element(device: str) -> Callable[[Scene], Apply]:
    """Return an effect that fixes the power of a controller's heater, percent (0: that of its output)."""

    def make(scene: Scene) -> Apply:
        slave: Any = scene.rig.devices[device]

        def apply(scene: Scene, size: float) -> None:
            slave.stuck_element = size if size != 0.0 else None

        return apply

    return make


def _output(device: str) -> Callable[[Scene], Apply]:
    """Return an effect that freezes a controller's output, percent."""

    def make(scene: Scene) -> Apply:
        slave: Any = scene.rig.devices[device]

        def apply(scene: Scene, size: float) -> None:
            slave.stuck_output = size if size != 0.0 else None

        return apply

    return make


def _welded(scene: Scene, size: float) -> None:
    for drive in scene.rig.axes.values():
        if drive.io is not None and drive.io.welded != (size != 0.0):
            if size != 0.0:
                drive.io.welded = True
            else:
                drive.io.release(scene.rig.now_s)
            drive.reschedule()


def _chain(scene: Scene, size: float) -> None:
    for drive in scene.rig.axes.values():
        drive.set_safety_chain(size == 0.0)
        if drive.io is not None:
            drive.reschedule()


def _late(scene: Scene) -> Apply:
    """Return an effect that stops the computer for some seconds, each time the size rises."""
    was = [0.0]

    def apply(scene: Scene, size: float) -> None:
        if size > 0.0 and was[0] == 0.0:
            stalled(size).begin(scene, scene.rig.now_s)
        was[0] = size

    return apply


def _readings(device: str, *, gain: float, offset: float, unit: str, channel: str = "fz", slow: bool = False,
              floor: float = -1.0) -> list[Place]:  # fmt: skip
    """Return the places of a reading: its gain, its offset, and its freezing."""
    name = f"{device} {channel}" if channel != "fz" else device
    return [
        Place(f"{name} gain", "", max(-gain, floor), gain, _reading(device, "gain", channel), slow),
        Place(f"{name} offset", unit, -offset, offset, _reading(device, "offset", channel), slow),
        Place(f"{name} held", "", 1.0, 1.0, _reading(device, "holds", channel), slow, whole=True),
    ]


def _drive(axis: str, runs: float, unit: str) -> list[Place]:
    """Return the places of a drive that turns: motion, braking, data."""
    return [
        Place(f"{axis} faster than commanded", "", -0.6, 0.6, _on_axis(axis, _drifts)),
        Place(f"{axis} runs by itself", unit, -runs, runs, _on_axis(axis, _runs)),
        Place(f"{axis} brakes less", "", 0.3, 0.98, _brakes(axis)),
        Place(f"{axis} held", "", 1.0, 1.0, _on_axis(axis, _held), whole=True),
        *_data(axis),
    ]


def _data(axis: str) -> list[Place]:
    """Return the places of a drive's frames."""
    return [
        Place(f"{axis} status frames lost", "", 1.0, 1.0, _switch(lambda: can.frames_lost(axis, o.TPDO1_BASE)),
              whole=True),
        Place(f"{axis} data frozen", "", 1.0, 1.0, _switch(lambda: can.data_frozen(axis)), whole=True),
        Place(f"{axis} commands lost", "", 1.0, 1.0, _switch(lambda: can.frames_lost(axis, o.RPDO1_BASE)),
              whole=True),
        Place(f"{axis} off the bus", "", 1.0, 1.0, _switch(lambda: can.node_cut(axis)), whole=True),
    ]  # fmt: skip


def _device(name: str) -> list[Place]:
    """Return the places of a device's line."""
    return [
        Place(f"{name} silent", "", 1.0, 1.0, _switch(lambda: Impaired(name, "silence")), whole=True),
        Place(f"{name} late", "", 1.0, 1.0, _switch(lambda: Impaired(name, "late", delay_s=0.03)), whole=True),
    ]


_CABINET = [
    Place("guard open", "", 1.0, 1.0, _switch(guard_open), whole=True),
    Place("safety chain open", "", 1.0, 1.0, lambda scene: _chain, whole=True),
    Place("computer late", "s", 0.02, 0.5, _late),
]

WHEEL: tuple[Place, ...] = (
    *_readings("load cell", gain=0.5, offset=250.0, unit="N"),
    *_readings("load cell", gain=1.0, offset=150.0, unit="N", channel="fx"),
    *_readings("thermometer", gain=0.5, offset=40.0, unit="K", slow=True),
    *_readings("jacket", gain=0.5, offset=60.0, unit="K", slow=True),
    *_drive("wheel", 25.0, "rad/s"), *_drive("belt", 1.0, "m/s"), *_drive("press", 8.0, "mm/s"),
    *_data("sideslip"),
    Place("sideslip held", "", 1.0, 1.0, _on_axis("sideslip", _held), whole=True),
    *_device("load cell"), *_device("thermometer"), *_device("jacket"), *_CABINET,
    Place("wheel slower than shown", "", -0.4, 0.6, _scale("wheel_speed")),
    Place("belt slower than shown", "", -0.4, 0.6, _scale("belt_speed")),
    Place("wheel torque shown", "", -0.8, 0.8, _torque("wheel_shaft")),
    Place("belt torque shown", "", -0.8, 0.8, _torque("belt_shaft")),
    Place("press torque measured", "", -0.5, 1.0, _on_axis("press", _misreads)),
    Place("friction", "", -0.9, 1.0, _plant(lambda plant, size: plant.set_grip(1.0 + size))),
    Place("belt slips on its roller", "", 0.0, 0.6, _belt_slip),
    Place("wheel towards the belt", "mm", -2.0, 2.0, _touch),
    Place("rubber stiffer", "", -0.4, 0.8, _stiffness, rises_s=30.0),
    Place("runout", "mm", 0.0, 1.0,
          _plant(lambda plant, size: plant.set_runout(plant.parameters.contact.runout + size))),
    Place("rubber relaxes", "", 0.0, 0.15, _plant(lambda plant, size: plant.set_relaxation(size))),
    Place("heat of its own", "%", 5.0, 100.0, _element("jacket"), slow=True),
    Place("jacket output", "%", 5.0, 100.0, _output("jacket"), slow=True),
    Place("contactor welded", "", 1.0, 1.0, lambda scene: _welded, whole=True),
)  # fmt: skip
"""Places of a wheel on a belt."""

TRACK: tuple[Place, ...] = (
    *_readings("load cell", gain=1.0, offset=150.0, unit="N", channel="fx"),
    *_readings("chamber", gain=0.9, offset=80.0, unit="K", slow=True),
    Place("track faster than commanded", "", -0.6, 0.6, _on_axis("track", _drifts)),
    Place("track brakes less", "", 0.3, 0.98, _brakes("track")),
    Place("track held", "", 1.0, 1.0, _on_axis("track", _held), whole=True),
    *_data("track"), *_data("lift"),
    Place("lift held", "", 1.0, 1.0, _on_axis("lift", _held), whole=True),
    *_device("load cell"), *_device("chamber"), *_CABINET,
    Place("friction", "", -0.9, 1.5, _plant(lambda plant, size: setattr(plant, "grip", 1.0 + size))),
    Place("chamber output", "%", -100.0, 100.0, _output("chamber"), slow=True),
)
"""Places of a specimen on a track."""


def track_runs(most: float, unit: str) -> Place:
    """Return the place of a track that runs by itself, at up to ``most`` in its own unit."""
    return Place("track runs by itself", unit, -most, most, _on_axis("track", _runs))


def of(rig: str) -> tuple[Place, ...]:
    """Return the places of a packaged rig."""
    if rig == "sim":
        return WHEEL
    if rig == "grosch":
        return (*TRACK, track_runs(10.0, "mm/s"))
    return (*(place for place in TRACK if not place.name.startswith(("lift", "chamber"))), track_runs(1.0, "m/s"))
