"""Samples of rubber that is pressed in again and again, by the simulated rig's own contact, for tests of its stiffness.

A press touches, applies a load, holds it, and lifts; the rubber softens, grows, wears and relaxes as the plant's does.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field, replace

from sim.physics.contact import ContactModel, Relaxation, Warmth
from sim.physics.parameters import SimParameters
from tester.base.quantities import KEY, TIME, Roles

ROLES = Roles(("fx",), "load", "turns", 1.0, "surface", "slip", "depth", "core")
CHANNELS = (TIME, "load", "depth", "surface", "core", "slip", KEY)
DT_S = 0.02
APPROACH_MM_S = 2.0
TURN_S = 0.35
WORN_MM_PER_N_M = 1e-5
"""Loss of radius by load times distance: 0.1 mm3/(N m) on a wheel."""


@dataclass
class Pressed:
    """The rig and its samples so far."""

    seed: int = 0
    softening: float = 0.004
    relaxation: float = 0.03
    noise: float = 1.0
    columns: dict[str, list[float]] = field(default_factory=lambda: {name: [] for name in CHANNELS})
    now_s: float = 0.0
    worn_mm: float = 0.0
    core_c: float = 25.0
    repeats: int = 0

    def __post_init__(self) -> None:
        p = SimParameters()
        self.p = replace(p, softening=1.0, contact=replace(p.contact, softening=self.softening))
        self.model = ContactModel(self.p.contact)
        self.warmth = Warmth(self.p)
        self.rubber = Relaxation(self.relaxation)
        self.rubber.retime(DT_S)
        self.random = random.Random(self.seed)

    def true_depth_mm(self, load_n: float, body_c: float, lost_n: float = 0.0) -> float:
        """Return the depth at a load, mm; ``lost_n``: what relaxed rubber lacks."""
        factor = self.model.factor * self.warmth.stiffness_share(body_c)
        return float(((load_n + lost_n) / factor) ** (1.0 / self.model.exponent))

    def press(self, load_n: float, hold_s: float, slip_m_s: float = 0.3, warming_k: float = 1.5) -> None:
        """Touch, hold a load and lift."""
        self.repeats += 1
        phase, depth_mm, begun_s = self.random.random(), 8.0, self.now_s
        loaded_s = math.inf
        shown_n = 0.0
        while self.now_s - begun_s < hold_s + 6.0:
            lifting = self.now_s - loaded_s > hold_s
            surface_c = self.core_c + min(warming_k, 0.1 * max(0.0, self.now_s - loaded_s))
            body_c = 0.5 * (self.core_c + surface_c)
            radius_mm = self.warmth.growth_mm(body_c, self.core_c, 90.0) - self.worn_mm
            swing_mm = 0.025 * math.sin(2.0 * math.pi * (self.now_s / TURN_S + phase))
            touch_mm = 10.0 - radius_mm - swing_mm
            force_n = 0.0
            into_mm = depth_mm - touch_mm
            if into_mm > 0.0:
                elastic_n = self.model.factor * self.warmth.stiffness_share(body_c) * into_mm**self.model.exponent
                force_n = max(0.0, self.rubber.load_n(elastic_n))
            else:
                self.rubber.rest(DT_S)
            shown_n += 0.7 * (force_n - shown_n)
            self._sample(shown_n, depth_mm, surface_c, slip_m_s if force_n > 50.0 else 0.0)
            self.worn_mm += WORN_MM_PER_N_M * force_n * (slip_m_s if force_n > 50.0 else 0.0) * DT_S
            if force_n >= 0.97 * load_n and loaded_s == math.inf:
                loaded_s = self.now_s
            if lifting:
                depth_mm -= 60.0 * DT_S if depth_mm > 5.0 else 0.0
            elif loaded_s == math.inf:
                depth_mm += APPROACH_MM_S * DT_S
            else:
                depth_mm += min(max(0.2 * (load_n - shown_n) / 150.0, -0.02), 0.02)
            self.now_s += DT_S

    def _sample(self, force_n: float, depth_mm: float, surface_c: float, slip_m_s: float) -> None:
        gauss, noise = self.random.gauss, self.noise
        values = (self.now_s, force_n + gauss(0.0, noise), depth_mm + gauss(0.0, 0.001 * noise),
                  surface_c + gauss(0.0, 0.1 * noise), self.core_c, slip_m_s, float(self.repeats))  # fmt: skip
        for name, value in zip(CHANNELS, values, strict=True):
            self.columns[name].append(value)


def pressed(seed: int, softening: float = 0.004, relaxation: float = 0.03) -> Pressed:
    """Return rubber that was pressed 24 times: at four temperatures, with two loads, for 10 and 30 s."""
    rig = Pressed(seed, softening, relaxation)
    for core_c in (25.0, 45.0, 65.0, 85.0):
        rig.core_c = core_c
        for load_n in (100.0, 300.0, 200.0):
            rig.press(load_n, 30.0)
            rig.press(load_n, 10.0)
    return rig
