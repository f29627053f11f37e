"""The two rigs of this kind that are packaged, as wiring and parameters. Every number is [A] unless it names a source.

``grosch``: a rubber block under dead weights on a linear track in a climate chamber, 1e-6 to 1e-2 m/s, -50 to 100 degC
(after Grosch 1963). ``pin-on-disc``: a specimen on a turning disc in the room's air, 0.05 to 2 m/s.
"""

from __future__ import annotations

from typing import Final

from drivers.axis import AxisConfig
from drivers.profiles import load_profile
from sim.physics.track import TrackParameters
from sim.rig import DeviceSpec, LineSpec, RigSpec

BITRATE: Final = 500_000
"""bit/s."""
SLOWEST_M_S: Final = {"grosch": 1e-6, "pin-on-disc": 0.05}


def _linear_track() -> AxisConfig:
    return AxisConfig(
        name="track", node_id=1, mode="velocity", unit="mm/s",
        velocity_increments=1e6,        # counts per mm/s: 1 nm/s
        position_increments=1e6,        # counts per mm: 1 nm; 300 mm are 3e8, of the 2.1e9 of 32 bits
        feedback="position",            # speed from position
        rated_torque_nm=10.0,
        max_speed=10.5,                 # mm/s
        acceleration=20.0,              # mm/s2
        deceleration=20.0,
        quick_stop_deceleration=100.0,  # from 10 mm/s within 0.5 mm
        rpdo_deadline_s=0.2,
        digital_io=True,                # safety chain with the end switches, guard
    )  # fmt: skip


def _disc() -> AxisConfig:
    return AxisConfig(
        name="track", node_id=1, mode="velocity", unit="m/s",
        velocity_increments=1e5,        # counts per m/s at the track's radius
        position_increments=1e5,        # counts per m
        feedback="velocity",
        rated_torque_nm=10.0,
        max_speed=2.1,                  # m/s
        acceleration=2.0,               # m/s2
        deceleration=2.0,
        quick_stop_deceleration=10.0,
        rpdo_deadline_s=0.2,
        digital_io=True,
    )  # fmt: skip


def _lift() -> AxisConfig:
    return AxisConfig(
        name="lift", node_id=2, mode="position", unit="mm/s",
        velocity_increments=1000.0,     # counts per mm/s
        position_increments=1000.0,     # counts per mm
        feedback="position",
        rated_torque_nm=2.0,
        max_speed=10.0,                 # mm/s
        acceleration=50.0,              # mm/s2
        deceleration=50.0,
        quick_stop_deceleration=200.0,
        software_limits=(-0.5, 10.5),   # mm: 0 lowered, 10 raised
        home_offset=-10.0,              # the zero is this far from the home switch, at the raised end
        homing_speed=2.0,
        homing_zero_speed=0.5,
        position_window=0.02,
    )  # fmt: skip


def wiring(variant: str) -> RigSpec:
    """Return what is connected to what. Raises ValueError for another variant."""
    cell = DeviceSpec(load_profile("one_axis_transmitter"), "load_cell", 1)
    lines = {"load_cell": LineSpec(115200), "heat": LineSpec(38400)}
    if variant == "grosch":
        chamber = DeviceSpec(load_profile("climate_chamber"), "heat", 3)
        return RigSpec(BITRATE, {"track": _linear_track(), "lift": _lift()}, lines,
                       {"load_cell": cell, "chamber": chamber})  # fmt: skip
    if variant == "pin-on-disc":
        thermometer = load_profile("calex_pyrominibus")
        return RigSpec(BITRATE, {"track": _disc()}, {**lines, "height": LineSpec(38400)}, {
            "load_cell": cell,
            "pyrometer": DeviceSpec(thermometer, "heat", 1),
            "thermometer": DeviceSpec(thermometer, "heat", 2),
            "height_sensor": DeviceSpec(load_profile("displacement_transmitter"), "height", 1),
        })  # fmt: skip
    raise ValueError(f"no variant {variant!r}; there are grosch, pin-on-disc")


def parameters(variant: str, **changes: object) -> TrackParameters:
    """Return a variant's plant, with fields of TrackParameters changed. Raises ValueError."""
    if variant not in SLOWEST_M_S:
        raise ValueError(f"no variant {variant!r}; there are {', '.join(SLOWEST_M_S)}")
    disc: dict[str, object] = {"motion": "disc", "enclosed": False}
    own = disc if variant == "pin-on-disc" else {"law": "two_bells"}
    return TrackParameters(**{**own, **changes})  # type: ignore[arg-type]
