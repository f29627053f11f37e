"""Bounds of the section ``interlocks`` that belong to no row: for starts, holds, zero checks, the cool-down."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import ANY, NOT_NEGATIVE, SHARE, Direction, Parameter
from tester.machine.drive_rows import ACK_WAIT_S

MAX_SLIP_M_S: Final = Parameter(
    "max_slip_m_s", "m/s", "0.6 m/s", "no load is applied at a greater difference of the speeds [A]",
    hardest="0.8 m/s", because="0.8 m/s at 400 N and a coefficient of 1.1 are the 350 W of limits.slip_power",
)  # fmt: skip
TURNING_CONFIRMED_S: Final = Parameter(
    "turning_confirmed_s", "s", "300 ms", "heat is allowed once the wheel has been seen turning this long [A]",
    NOT_NEGATIVE, direction=Direction.HIGHER, hardest="200 ms",
    because="four scans at the 20 Hz of a rig that is not sliding",
)  # fmt: skip
START_K: Final = Parameter(
    "start_k", "K", "5 K", "arming with a cold hub: the thermometer must agree with the hub within this [A]",
    hardest="8 K", because="more than the thermal model's own bound would trip in the run",
)  # fmt: skip
COLD_K: Final = Parameter(
    "cold_k", "K", "3 K", "... cold is a hub this near to the air around it: its rubber is, too [A]",
    because="it decides when thermometer and stiffness are compared at arming; the rows of a run watch both",
)  # fmt: skip
HOLD_AT_MOST_S: Final = Parameter(
    "hold_at_most_s", "s", "60 min", "a hold ends in a controlled stop after this [A]",
    hardest="120 min", because="no operator attends a hot, turning wheel for longer than that",
)  # fmt: skip
ZERO_WARN_N: Final = Parameter(
    "zero_warn_n", "N", "5 N", "the unloaded cell is off its reference zero by this: a warning", because="a warning",
)  # fmt: skip
ZERO_STOP_N: Final = Parameter(
    "zero_stop_n", "N", "20 N", "... by this: the run stops",
    hardest="30 N", because="with 450 N, the greatest load, it is 480 N; harm begins at 500 N",
)  # fmt: skip
ZERO_CHECK_EVERY_S: Final = Parameter(
    "zero_check_every_s", "s", "10 min",
    "... checked after this long in contact, between steps; besides before each repeat",
    hardest="30 min",
    because="the cell warms within 10 min, by 0.1 N/K; the longest soak of the packaged recipes takes half an hour",
)  # fmt: skip
COOLDOWN_HUB_C: Final = Parameter(
    "cooldown_hub_c", "degC", "60 degC", "after a stop the wheel keeps turning, unloaded, while the hub is hotter", ANY,
    hardest="80 degC", because="the paper's tests heat turning rubber to 85 degC; a wheel at rest is baked on one side",
)  # fmt: skip
COOLDOWN_SPEED_M_S: Final = Parameter(
    "cooldown_speed_m_s", "m/s", "0.1 m/s", "... this slowly [A]",
    hardest="0.2 m/s",
    because="an unattended wheel creeps; at 0.2 m/s its rim turns three quarters of a turn a second",
)  # fmt: skip
COOLDOWN_AT_MOST_S: Final = Parameter(
    "cooldown_at_most_s", "s", "45 min", "... and this long at most [A]",
    because="the wheel turns unloaded and without heat for longer, or stands with less than cooldown_hub soon",
)  # fmt: skip

FIRST_CONTACT_LOAD_N: Final = Parameter(
    "first_contact_load_n", "N", "15 N",
    "load of a wheel's first contact: friction must turn round with the slip ... [A]",
    hardest="20 N", because="a shaft that turns the wrong way rubs at little load: 20 N counts as unloaded",
)  # fmt: skip
FIRST_CONTACT_SWEEP: Final = Parameter(
    "first_contact_sweep", "1", "3 %", "... while the belt's speed goes from this share above the wheel's to below ...",
    SHARE, hardest="5 %", because="a scale or a diameter that is off by 10 % must not be within the sweep",
)  # fmt: skip
FIRST_CONTACT_CREEP_M_S: Final = Parameter(
    "first_contact_creep_m_s", "m/s", "10 mm/s", "... and by this: rolling, rubber creeps by some mm/s [A]",
    NOT_NEGATIVE, hardest="15 mm/s", because="at 0.4 m/s 10 % are 40 mm/s: sweep, creep and this must stay below",
)  # fmt: skip
FIRST_CONTACT_SLOW_M_S: Final = Parameter(
    "first_contact_slow_m_s", "m/s", "0.1 m/s", "... at this speed: what turns the wrong way makes little slip [A] ...",
    hardest="0.2 m/s", because="0.4 m/s of slip is what the paper's wear tests slide at under full load",
)  # fmt: skip
FIRST_CONTACT_FAST_M_S: Final = Parameter(
    "first_contact_fast_m_s", "m/s", "0.4 m/s", "... and then at this one: 10 % are clearly more than the creep [A]",
    direction=Direction.HIGHER, hardest="0.3 m/s", because="at 0.3 m/s 10 % are 30 mm/s, sweep and creep 19 mm/s",
)  # fmt: skip
FIRST_CONTACT_PLACE_MM: Final = Parameter(
    "first_contact_place_mm", "mm", "0.3 mm",
    "where it touches is off by this and the sweep's share of the radius at most [A]",
    hardest="1 mm", because="10 % of the diameter are 4.5 mm, the sweep's 3 % are 1.35 mm",
)  # fmt: skip

PARAMETERS: Final[tuple[Parameter, ...]] = (
    MAX_SLIP_M_S, TURNING_CONFIRMED_S, START_K, COLD_K, HOLD_AT_MOST_S, ACK_WAIT_S, ZERO_WARN_N, ZERO_STOP_N,
    ZERO_CHECK_EVERY_S, COOLDOWN_HUB_C, COOLDOWN_SPEED_M_S, COOLDOWN_AT_MOST_S,
    FIRST_CONTACT_LOAD_N, FIRST_CONTACT_SWEEP, FIRST_CONTACT_CREEP_M_S, FIRST_CONTACT_SLOW_M_S, FIRST_CONTACT_FAST_M_S,
    FIRST_CONTACT_PLACE_MM,
)  # fmt: skip
ABOUT: Final = "what may begin, holds, zero checks, the cool-down, a wheel's first contact"
"""The purpose of these parameters."""
