"""Constants of the estimate: how long the executor's moves take. Calibrate here, against simulated runs.

`python -m tests.campaigns.seeds.steps RUN ...` shows what they take, step by step.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EstimateConstants:
    """Durations (s) and other figures of the executor's moves, as simulated runs show them. All [A]."""

    person_s: float = 600.0
    """A person mounts a wheel or does what a prompt asks; a simulated rig takes no time for it."""
    install_s: float = 18.5
    """Standstill, drives off and on, tare 2.1; first contact 16.4 with the way to the wheel. Also after a question."""
    pre_grind_moves_s: float = 10.0
    """Turn, load, bring slip in, take it out, lift."""
    repeat_moves_s: float = 4.8
    """Lift, settle and tare 2, touch and load to within 2 % for 1 s 2.3, commit and lift 0.5."""
    burst_edge_s: float = 0.45
    """Sliding before the first sample of a pulse counts: belt ramp, speed and slip gates; and the ramp out."""
    split_turns: float = 0.0
    """Revolutions lost in a pulse that ends within one."""
    half_rise_k: float = 0.25
    """A pulse that warms by this much ends at half the window, any other at a whole one."""
    yawed_moves_s: float = 7.7
    """With sideslip or camber, per burst, in place of a repeat's moves: lift, yaw, touch, load; and back; without the
    time of yawing, and of sliding."""
    yaw_deg_s: float = 20.0
    yawed_slide_s: float = 1.8
    """With sideslip: sliding at full load that does not count, per burst, while load and friction settle."""
    surplus: float = 1.01
    """Collected a repeat, of what it asks for: revolutions that are cut off at its beginning come on top."""
    alone: float = 1.8
    """Windows collected by a repeat that is judged alone, up to its ``extend_to``."""
    cooling_per_j: float = 1.8
    """Waiting between pulses, s per J of friction heat in the rubber (beyond ``carried_w``)."""
    carried_w: float = 0.5
    """Friction heat that costs no waiting: rolling loses as much, and the jacket gives less."""
    near_k: float = 12.0
    near_shift_k: float = 2.0
    """Near ambient cooling is slow: by the factor 1 + near_k / (kelvin above ambient + near_shift_k)."""
    near_carried_wk: float = 1.1
    """What more is carried near ambient while the wheel's body still warms: W K, over kelvin above ambient."""
    hot_w: float = 4.8
    hot_share: float = 0.5
    """Beyond this much heat pulses start below the band: the rest costs this share of the waiting."""
    sink_from_w: float = 3.6
    sink_s_w: float = 50.0
    """The hub has to cool before there is room for more heat than this: seconds per W, once a condition."""
    few_turns: float = 4.0
    below_band_k: float = 1.5
    """A pulse with fewer turns than this starts lower, at most this far below the band."""
    bursts_tried: int = 8
    """Pulses after which a temperature that cannot be held is given up; the condition ends with it."""
    heat_s: float = 180.0
    """From hub to surface, heat takes minutes to pass 8 mm of rubber."""
    heat_per_k_s: float = 6.4
    """Per kelvin of surface."""
    heat_level_s: float = 1.7
    """Per kelvin above ambient at which heating begins: the hub's 200 W also feed the losses."""
    heat_near_s: float = 30.0
    """Rolling to a temperature that is nearly there."""
    settle_k: tuple[float, ...] = (0.0, 2.0, 7.0, 12.0, 17.0, 32.0, 37.0, 47.0, 57.0, 67.0)
    settle_s: tuple[float, ...] = (20.0, 37.0, 280.0, 600.0, 590.0, 540.0, 370.0, 200.0, 90.0, 20.0)
    """Equilibrium in contact after heating up from ambient by so many kelvin: the hub leads, and has to come down."""
    settle_from: float = 0.45
    """Rise over kelvin above ambient from which on the surface overshoots; 1: from ambient."""
    settled_share: float = 1.35
    settled_s: float = 500.0
    """The first condition after heating waits this share of its usual time, less the settling over ``settled_s``."""
    rolling_settle: float = 0.5
    """Without slip the surface has to stand within 0.4 K of the setpoint itself: share of the settling."""
    roll_at_most_s: float = 200.0
    """From rolling at the temperature to pulses that begin below it, at most."""
    rolling_after_s: float = 60.0
    """From pulses to rolling: until what they left in the rubber has gone."""
    after_hotter: float = 0.6
    """Share of the waiting after a condition with more friction heat: it leaves the hub colder."""
    sunk_from_w: float = 5.5
    sunk_s_w: float = 40.0
    sunk_most_s: float = 700.0
    """After one with more heat than this the hub is too cold, and has to come up again: seconds per W."""
    roll_check_s: float = 5.1
    """Lift, turn, settle and tare 2, touch and load to within 2 % for 1 s; without the turns that are averaged."""
    next_condition_s: float = 3.0
    """Rolling into the soak of the next condition."""
    waits_least: float = 0.45
    waits_most: float = 2.1
    """Range of what waits for temperatures, 95 % of runs, over what is expected: a thermometer off by +-1 K."""
    unknown_mu: float = 1.0
    """Coefficient of a compound without a friction model."""


CONSTANTS = EstimateConstants()
