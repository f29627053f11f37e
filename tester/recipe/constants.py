"""Constants of the estimate: how long the executor's moves take. Calibrate here, against simulated runs."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EstimateConstants:
    """Durations (s) and other figures of the executor's moves, as simulated runs show them. All [A]."""

    person_s: float = 600.0
    """A person mounts a wheel or does what a prompt asks; nobody waits on a simulated rig."""
    install_s: float = 5.0
    """Standstill, drives off and on, reference tare."""
    pre_grind_moves_s: float = 12.0
    """Turn, load, bring slip in, take it out, lift."""
    repeat_moves_s: float = 12.0
    """Lift 2, settle and tare 1.5, touch and load to within 2 % for 1 s 6, commit and lift 2.5."""
    burst_edge_s: float = 0.9
    """Sliding before the first sample of a pulse counts: belt ramp, speed and slip gates; and the ramp out."""
    split_turns: float = 0.5
    """Revolutions lost in a pulse that ends within one."""
    yawed_moves_s: float = 14.0
    """With sideslip or camber, per burst: lift, yaw, touch, load; lift, yaw back, touch, load; yaw time is extra."""
    yaw_deg_s: float = 20.0
    yawed_slide_s: float = 1.8
    """With sideslip: sliding at full load that does not count, per burst, while load and friction settle."""
    extension: float = 1.5 * 1.05
    """Windows collected per window asked for: some repeats go on until their drift is shown to be small."""
    cooling_ratio: float = 2.0
    """Rolling between pulses, at least: lengths of a pulse in which the heat of the surface spreads inward."""
    cooling_least_s: float = 5.0
    cooling_most_s: float = 180.0
    """Rolling between pulses: what a pulse brought in must leave, slowly near ambient; after this it is lifted."""
    cooling_floor_k: float = 0.7
    """Surface above ambient that drives the cooling, at least: the jacket cools with the hub below the surface."""
    few_turns: float = 4.0
    below_band_k: float = 1.5
    """A pulse with fewer turns than this starts lower, at most this far below the band."""
    bursts_tried: int = 8
    """Pulses after which a temperature that cannot be held is given up; the condition ends with it."""
    heat_lag_s: float = 500.0
    """From hub to surface, heat takes minutes to pass 8 mm of rubber; then equilibrium in contact, minutes again."""
    heat_per_k_s: float = 5.7
    """Per kelvin of surface, with the hub's lead and the approach to the band."""
    rolling_settle_s: float = 190.0
    """Without slip: rolling until what the condition before left in the rubber has gone."""
    next_condition_s: float = 5.0
    """Rolling into the soak of the next condition at a temperature that already stands."""
    unknown_mu: float = 1.0
    """Coefficient of a compound without a friction model."""


CONSTANTS = EstimateConstants()

NEAR_K = 2.0
"""Nearer than this to its temperature the wheel needs no heating: the soak of the first condition does."""
