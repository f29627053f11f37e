"""The sections of this kind's rig file, and their consistency checks."""

from __future__ import annotations

from tester.kinds.wheel_on_belt.rig.wheel_rig import RigConfig

__all__ = ["RigConfig"]
