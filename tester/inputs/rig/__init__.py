"""The rig file as far as it is the same for all kinds: sections, reader, checks, safety keys, missing keys.

A kind adds its sections (tester.kinds.*.rig); which kind a file is of, ``tester.kinds.load_rig`` finds out.
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
