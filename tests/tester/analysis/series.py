"""Synthetic samples and blocks with known truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import exp, sqrt
from random import Random

from tester.analysis.blocks import Block, BlockCounter, resultant
from tester.base.quantities import Means
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES

REVOLUTION_S = 0.353
"""A 90 mm wheel at 0.8 m/s."""


def sample(**values: float) -> tuple[float, ...]:
    """Return a sample of a sliding contact, burst 1 of repeat 1, with some columns replaced."""
    usual = dict.fromkeys(QUANTITIES.names, 0.0)
    usual |= {"wheel_speed_m_s": 0.8, "belt_speed_m_s": 0.5, "slip_m_s": 0.3, "load_setpoint_n": 200.0}
    usual |= {"force_x_n": 146.0, "force_z_n": 200.0, "surface_c": 25.0, "hub_c": 30.0}
    usual |= {"burst": 1.0, "repeat_key": 1.0}
    return tuple(float((usual | values)[name]) for name in QUANTITIES.names)


def means_of(**given: float) -> Means:
    """Return means of the wheel's channels, NaN for missing ones."""
    return Means(QUANTITIES, [given.get(one.name, float("nan")) for one in QUANTITIES.averaged])


def block(mu: float, *, at_s: float = 0.0, burst: int = 1, surface_c: float = 25.0, **means: float) -> Block:
    """Return a block of one revolution, at 200 N and with a purely longitudinal coefficient by default."""
    usual = {"force_x_n": 200.0 * mu, "force_y_n": 0.0, "force_z_n": 200.0, "moment_z_nm": 0.01}
    usual |= {"drive_torque_nm": 6.5, "wheel_speed_m_s": 0.8, "belt_speed_m_s": 0.5, "slip_m_s": 0.3}
    usual |= {"sideslip_deg": 0.0, "camber_deg": 0.0, "hub_c": 30.0}
    usual |= means
    found = means_of(**usual, surface_c=surface_c)
    resulting = resultant(found.along, found.across, found.normal)
    return Block(burst, 35, at_s, at_s + REVOLUTION_S, at_s, resulting, found)


def blocks(values: Sequence[float], *, per_burst: int = 1_000_000, surface: Sequence[float] = ()) -> list[Block]:
    """Return one block per value, in bursts of ``per_burst``, 20 s apart; ``surface`` temperatures repeat."""
    made: list[Block] = []
    for i, mu in enumerate(values):
        burst = 1 + i // per_burst
        temperature = surface[i % len(surface)] if surface else 25.0
        made.append(block(mu, at_s=i * REVOLUTION_S + 20.0 * burst, burst=burst, surface_c=temperature))
    return made


def correlated(random: Random, deviation: float = 0.01, tau_s: float = 0.3) -> Iterator[float]:
    """Yield means over a revolution of AR(1) noise sampled at 100 Hz, without end."""
    share = exp(-0.01 / tau_s)
    step = deviation * sqrt(1.0 - share * share)
    x = random.gauss(0.0, deviation)
    while True:
        total = 0.0
        for _ in range(35):
            x = share * x + random.gauss(0.0, step)
            total += x
        yield total / 35.0


def counter_of(collected: list[Block]) -> BlockCounter:
    """Return the counter of a repeat that has collected these blocks."""
    counter = BlockCounter(QUANTITIES)
    counter.blocks.extend(collected)
    return counter
