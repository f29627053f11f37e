"""Where this machine's own faults act."""

from __future__ import annotations

from sim.faults.scene import Scene
from sim.machines.wheel_on_belt.rig import WheelRig


def wheel_rig(scene: Scene) -> WheelRig:
    """Return the rig of a scene. Raises TypeError where it is another kind of machine."""
    if not isinstance(scene.rig, WheelRig):
        raise TypeError(f"a fault of a wheel on a belt cannot act on {type(scene.rig).__name__}")
    return scene.rig
