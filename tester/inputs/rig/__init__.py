"""The part of the rig file that is common to all kinds: sections, reader, checks, safety keys, missing keys.

A kind adds its sections (tester.kinds.*.rig); ``tester.kinds.load_rig`` determines the kind of a file.
"""

from __future__ import annotations

from drivers.axis import AxisConfig
from tester.inputs.rig.config import (
    CalibrationConfig,
    CanConfig,
    DeviceConfig,
    LineConfig,
    Rig,
    ScanConfig,
    WrongKindError,
)

__all__ = [
    "AxisConfig",
    "CalibrationConfig",
    "CanConfig",
    "DeviceConfig",
    "LineConfig",
    "Rig",
    "ScanConfig",
    "WrongKindError",
]
