"""The sections of this kind's rig file, and their consistency checks."""

from __future__ import annotations

from tester.kinds.wheel_on_belt.rig.sections import (
    ArmingConfig,
    AxesConfig,
    CertificatesConfig,
    GatesConfig,
    GeometryConfig,
    HeatLoopConfig,
    InterlocksConfig,
    LimitsConfig,
    LoadLoopConfig,
    LoopsConfig,
    ObserverConfig,
    WearConfig,
    interlock_values,
)
from tester.kinds.wheel_on_belt.rig.wheel_rig import RigConfig

__all__ = [
    "ArmingConfig",
    "AxesConfig",
    "CertificatesConfig",
    "GatesConfig",
    "GeometryConfig",
    "HeatLoopConfig",
    "InterlocksConfig",
    "LimitsConfig",
    "LoadLoopConfig",
    "LoopsConfig",
    "ObserverConfig",
    "RigConfig",
    "WearConfig",
    "interlock_values",
]
