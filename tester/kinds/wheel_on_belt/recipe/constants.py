"""Constants of the estimate: durations of the executor's moves. Calibrate them here, against simulated runs.

`python -m tests.campaigns.seeds.steps RUN ...` shows the durations in runs, step by step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

LIFT_TO_COOL_S: Final = 180.0
"""If rolling has not brought the temperature back after this time, the wheel is lifted to cool, s [A]."""
COOL_LIFTED_S: Final = 360.0
"""Longest cooling lifted before rolling is tried again, s [A]."""


@dataclass(frozen=True, slots=True)
class EstimateConstants:
    """Durations (s) and other figures of the executor's moves, from simulated runs. All [A]."""

    person_s: float = 600.0
    """A person's time to mount a wheel or follow a prompt; a simulated rig takes none."""
    install_s: float = 18.5
    """Standstill, drives off and on, tare: 2.1; first contact with the approach: 16.4. Also after a question."""
    pre_grind_moves_s: float = 10.0
    """Turn, load, bring slip in, take slip out, lift."""
    repeat_moves_s: float = 4.8
    """Lift, settle and tare: 2; touch and load to within 2 % for 1 s: 2.3; commit and lift: 0.5."""
    burst_edge_s: float = 0.45
    """Sliding in a pulse that does not count: belt ramp, speed and slip gates at the start, and the ramp out."""
    split_turns: float = 0.0
    """Revolutions lost in a pulse that ends within one."""
    half_rise_k: float = 0.25
    """A pulse that warms by this much ends at half the window, any other at a whole window."""
    yawed_moves_s: float = 7.7
    """With sideslip or camber, per burst, in place of a repeat's moves: lift, yaw, touch, load, and back. The time of
    yawing and of sliding is extra."""
    yaw_deg_s: float = 20.0
    yawed_slide_s: float = 1.8
    """With sideslip: sliding at full load that does not count, per burst, while load and friction settle."""
    surplus: float = 1.01
    """Revolutions collected per repeat, over the requested number: those cut off at its start are extra."""
    alone: float = 1.8
    """Windows collected by a single repeat, up to its ``extend_to``."""
    cooling_per_j: float = 1.8
    """Waiting between pulses, s per J of friction heat in the rubber (beyond ``carried_w``)."""
    carried_w: float = 0.5
    """Friction heat without waiting: rolling loses as much, and the jacket supplies less."""
    near_k: float = 12.0
    near_shift_k: float = 2.0
    """Cooling near ambient is slower by the factor 1 + near_k / (kelvin above ambient + near_shift_k)."""
    near_carried_wk: float = 1.1
    """Additional ``carried_w`` near ambient while the wheel's body still warms: W K, over kelvin above ambient."""
    hot_w: float = 4.8
    hot_share: float = 0.5
    """With more heat than ``hot_w`` pulses start below the band: the excess costs this share of the waiting."""
    sink_from_w: float = 3.6
    sink_s_w: float = 50.0
    """Heat beyond ``sink_from_w`` needs a cooler hub first: seconds per W, once per condition."""
    few_turns: float = 4.0
    below_band_k: float = 1.5
    """A pulse with fewer turns than ``few_turns`` starts lower, at most this far below the band."""
    bursts_tried: int = 8
    """Pulses after which a condition whose temperature cannot be held ends."""
    heat_s: float = 180.0
    """Delay from hub to surface: heat takes minutes to pass 8 mm of rubber."""
    heat_per_k_s: float = 6.4
    """Heating time per kelvin of surface."""
    heat_level_s: float = 1.7
    """Heating time per kelvin above ambient at the start: the hub's 200 W also feed the losses."""
    heat_near_s: float = 30.0
    """Rolling to a temperature that is nearly reached."""
    settle_k: tuple[float, ...] = (0.0, 2.0, 7.0, 12.0, 17.0, 32.0, 37.0, 47.0, 57.0, 67.0)
    settle_s: tuple[float, ...] = (20.0, 37.0, 280.0, 600.0, 590.0, 540.0, 370.0, 200.0, 90.0, 20.0)
    """Time to equilibrium in contact after heating from ambient by ``settle_k``: the hub leads, and has to cool."""
    settle_from: float = 0.45
    """Least rise, over kelvin above ambient, with which the surface overshoots; 1: a rise from ambient."""
    settled_share: float = 1.35
    settled_s: float = 500.0
    """The first condition after heating waits ``settled_share`` less settling / ``settled_s`` of its usual time."""
    rolling_settle: float = 0.5
    """Share of the settling without slip: the surface must be within 0.4 K of the setpoint itself."""
    roll_at_most_s: float = 200.0
    """Longest wait from rolling at the temperature to pulses that begin below it."""
    rolling_after_s: float = 60.0
    """Wait from pulses to rolling: their heat must leave the rubber."""
    after_hotter: float = 0.6
    """Share of the waiting after a condition with more friction heat, which leaves the hub colder."""
    sunk_from_w: float = 5.5
    sunk_s_w: float = 40.0
    sunk_most_s: float = 700.0
    """After a condition with more heat than ``sunk_from_w`` the cold hub must warm up: ``sunk_s_w`` per W, at most
    this."""
    roll_check_s: float = 5.1
    """Lift, turn, settle and tare: 2; touch and load to within 2 % for 1 s; the averaged turns are extra."""
    next_condition_s: float = 3.0
    """Rolling into the soak of the next condition."""
    waits_least: float = 0.45
    waits_most: float = 2.1
    """Range of the waits for temperatures over their expected time, in 95 % of runs: a thermometer off by +-1 K."""
    lift_s: float = LIFT_TO_COOL_S + COOL_LIFTED_S
    """One wait in contact and one cooling lifted: near ambient a thermometer that reads high makes this of a wait that
    is short in most runs."""
    unknown_mu: float = 1.0
    """Coefficient of a compound without a friction model."""


CONSTANTS = EstimateConstants()
