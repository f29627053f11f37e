"""The rig file: a machine's description, read once, frozen (sections: tester.rig.config)."""

from __future__ import annotations

from drivers.axis import AxisConfig
from tester.rig.config import (
    ArmingConfig,
    AxesConfig,
    CalibrationConfig,
    CanConfig,
    DeviceConfig,
    DevicesConfig,
    GatesConfig,
    GeometryConfig,
    HeatLoopConfig,
    InterlocksConfig,
    IrThermometerConfig,
    LimitsConfig,
    LineConfig,
    LoadLoopConfig,
    LoopsConfig,
    ObserverConfig,
    RigConfig,
    ScanConfig,
    WearConfig,
    interlock_values,
)
from tester.rig.load import load_rig

__all__ = [
    "ArmingConfig",
    "AxesConfig",
    "AxisConfig",
    "CalibrationConfig",
    "CanConfig",
    "DeviceConfig",
    "DevicesConfig",
    "GatesConfig",
    "GeometryConfig",
    "HeatLoopConfig",
    "InterlocksConfig",
    "IrThermometerConfig",
    "LimitsConfig",
    "LineConfig",
    "LoadLoopConfig",
    "LoopsConfig",
    "ObserverConfig",
    "RigConfig",
    "ScanConfig",
    "WearConfig",
    "interlock_values",
    "load_rig",
]
