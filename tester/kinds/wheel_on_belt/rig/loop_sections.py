"""The sections of the loops of load and heat, and of the gates that decide which samples count."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Final

from tester.base.config_reader import Range
from tester.inputs.rig.key_classes import HIGHER, LOWER, Bounded, Free, Held

HUB: Final = Bounded(
    LOWER, "140 degC", "a hub sensor that drifts hides up to 15 K; harm begins at 155 degC"
)
_POSITIVE: Final = Range(gt=0.0)
_NOT_NEGATIVE: Final = Range(ge=0.0)
_SHARE: Final = Range(gt=0.0, le=1.0)


@dataclass(frozen=True, slots=True)
class LoadLoopConfig:
    """Press control: approach, touch, hold (tester.kinds.wheel_on_belt.control.loops)."""

    bandwidth_hz: Annotated[
        float, "Hz", _POSITIVE,
        Bounded(LOWER, "1.5 Hz", "with 60 ms of delay a quicker loop swings", own=True),
    ]  # fmt: skip
    rolling_bandwidth_hz: Annotated[
        float, "Hz", _POSITIVE,
        Bounded(LOWER, "1 Hz", "the press follows the runout, 2.8 Hz", own=True),
    ]  # fmt: skip
    """Bandwidth while holding in band: too slow to follow the wheel's runout."""
    error_filter_s: Annotated[float, "s", _POSITIVE, Free("it chooses between the two bandwidths")]
    """Averaging time of the load error that decides between the two bandwidths."""
    stiffness_n_per_mm: Annotated[
        float, "N/mm", _POSITIVE, Held("the press's travel for the load in each contact", within=0.5)
    ]
    """Tangent stiffness of the contact at 200 N."""
    integral_s: Annotated[float, "s", _POSITIVE, Bounded(HIGHER, "1 s", "at 1 Hz a shorter one swings", own=True)]
    touch_load_n: Annotated[
        float, "N", _POSITIVE,
        Bounded(LOWER, "20 N", "a wrong direction or scale of wheel or belt shows at 20 N or less"),
    ]  # fmt: skip
    open_share: Annotated[float, "1", _SHARE, Free("it decides which touches count as the first")]
    """Share of the touching force below which the contact was open: only then is the next touch a first touch."""
    follow_rate_n_s: Annotated[
        float, "N/s", _POSITIVE,
        Bounded(HIGHER, "50 N/s", "until then the load is watched against the one before: 450 N to none take 9 s"),
    ]  # fmt: skip
    """Least expected rate of following a change of load: the interlocks' limits of the load move at it."""
    touch_speed_mm_s: Annotated[
        float, "mm/s", _POSITIVE,
        Bounded(LOWER, "15 mm/s", "the press comes 0.75 mm in the 50 ms until contact is seen"),
    ]  # fmt: skip
    loading_speed_mm_s: Annotated[
        float, "mm/s", _POSITIVE, Bounded(LOWER, "4 mm/s", "at 172 N/mm the load rises by 34 N in 50 ms")
    ]
    lift_speed_mm_s: Annotated[
        float, "mm/s", _POSITIVE, Bounded(HIGHER, "5 mm/s", "lifting 2.5 mm takes 0.5 s, half of what it may")
    ]
    acceleration_mm_s2: Annotated[
        float, "mm/s2", _POSITIVE,
        Bounded(LOWER, "200 mm/s2", "at 100 a load of 15 N overshoots: at twice that by a few newtons [A]", own=True),
    ]  # fmt: skip
    """Acceleration of profiles to a position: at most ``axes.press.acceleration``, which a lift uses."""
    clearance_mm: Annotated[float, "mm", _POSITIVE, Bounded(HIGHER, "1 mm", "twenty times the runout of the tread")]
    """Distance of the lifted position from the last contact."""


_SETPOINT: Final = Free("the hub's setpoint ends at hub_min and hub_max")


@dataclass(frozen=True, slots=True)
class HeatLoopConfig:
    """Outer heat loop: surface error to hub setpoint (tester.kinds.wheel_on_belt.control.loops)."""

    outer_gain: Annotated[float, "1", _NOT_NEGATIVE, _SETPOINT]
    """Kelvin of hub setpoint per kelvin of surface error."""
    outer_integral_s: Annotated[float, "s", _POSITIVE, _SETPOINT]
    integral_band_k: Annotated[float, "K", _POSITIVE, _SETPOINT]
    """The integral changes only within this error."""
    integral_limit_k: Annotated[float, "K", _NOT_NEGATIVE, _SETPOINT]
    hub_min_c: Annotated[
        float, "degC", Bounded(LOWER, "40 degC", "a wheel that waits is as warm as a hand bears [A]", own=True)
    ]
    hub_max_c: Annotated[float, "degC", HUB]
    period_s: Annotated[float, "s", _POSITIVE, _SETPOINT]
    rolling_offset_k: Annotated[float, "K", _NOT_NEGATIVE, _SETPOINT]
    """Distance of the target below the setpoint while rolling between slip pulses."""


@dataclass(frozen=True, slots=True)
class LoopsConfig:
    """Gains and times of the loops."""

    load: LoadLoopConfig
    heat: HeatLoopConfig


_OFF: Final = Bounded(LOWER, "5 %", "a sample off its setpoint counts", own=True)
_AVERAGED: Final = Bounded(LOWER, "2 s", "a short burst is averaged away", own=True)


@dataclass(frozen=True, slots=True)
class GatesConfig:
    """When a sample counts (tester.kinds.wheel_on_belt.procedures.gates)."""

    load_percent: Annotated[float, "%", _POSITIVE, _OFF]
    load_filter_s: Annotated[float, "s", _POSITIVE, _AVERAGED]
    speed_percent: Annotated[float, "%", _POSITIVE, _OFF]
    slip_percent: Annotated[float, "%", _POSITIVE, _OFF]
    slip_floor_mm_s: Annotated[float, "mm/s", _NOT_NEGATIVE, Bounded(LOWER, "5 mm/s", "a tenth of 50 mm/s", own=True)]
    slip_filter_s: Annotated[float, "s", _POSITIVE, _AVERAGED]
    ir_lag_s: Annotated[float, "s", _NOT_NEGATIVE, Bounded(LOWER, "1 s", "at 1 K/s a temperature is 1 K off", own=True)]
    contact_transient_s: Annotated[
        float, "s", _NOT_NEGATIVE, Bounded(HIGHER, "0.5 s", "1 % of the friction is missing then", own=True)
    ]
