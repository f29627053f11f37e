"""The corners of a rig's range: recipes at the limits of its rig file, with rubber that differs from its beliefs.

The greatest load, temperature and slip velocity are those that `tester check` accepts, found from the rig file in this
order; none is written here. Every corner must run without a trip before a fault is tried in it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import product

from tester.inputs.recipe.loader import check
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.rig import RigConfig

COMPOUNDS = ("1#", "2#", "3#")
STIFFNESS = (0.75, 1.3)
"""Stiffness of the contact, as a share of the rig file's belief."""
HEAT = (0.7, 1.3)
"""Friction heat into the rubber, as a share of the rig file's belief."""
LOAD_STEP_N, SLIP_STEP_MM_S, TEMPERATURE_STEP_K = 1, 10, 1
GROUND_IN = "sim.running_in=0"
"""The wheel is ground in: new rubber grips a tenth better, and grinding takes longer than all the rest."""
WHEEL_M_S, PRE_GRIND_BELT_M_S = 0.8, 0.6
"""Rim speed of the paper's tests; the belt in pre-grinding."""

_TEXT = """\
recipe: at the limits
specimens:
  - compound: "{compound}"
pre_grind: {{wheel_speed: {wheel:g} m/s, belt_speed: {belt:g} m/s, load: {load} N, duration: 4 s}}
measure:
  wheel_speed: {wheel:g} m/s
  repeats: 1
  min_valid: 1
  window: 5 rev
  soak: {{within: 2 degC, for: 2 s}}
grids:
  - name: greatest
    slip_velocity: {slip} mm/s
    load: {load} N
    temperature: {temperature} degC
"""


@dataclass(frozen=True, slots=True)
class Corner:
    """A compound's greatest load (N), slip velocity (mm/s) and temperature (degC), on a rig that differs from its file.

    ``stiffness`` and ``heat`` are shares of the rig file's beliefs of the contact and of friction's heat.
    """

    compound: str
    stiffness: float
    heat: float
    load_n: int
    slip_mm_s: int
    temperature_c: int
    overrides: tuple[str, ...]

    @property
    def name(self) -> str:
        """As text."""
        return f"{self.compound}, stiffness {self.stiffness - 1:+.0%}, friction heat {self.heat - 1:+.0%}"

    @property
    def text(self) -> str:
        """The recipe."""
        return _text(self.compound, self.load_n, self.slip_mm_s, self.temperature_c)


@cache
def corners() -> dict[str, Corner]:
    """Return every corner of the packaged rig by its name."""
    rig = load_rig("sim")
    found: dict[str, Corner] = {}
    for compound in COMPOUNDS:
        greatest = _greatest(compound, rig)
        for stiffness, heat in product(STIFFNESS, HEAT):
            corner = Corner(compound, stiffness, heat, *greatest, _unlike(rig, stiffness, heat))
            found[corner.name] = corner
    return found


def _unlike(rig: RigConfig, stiffness: float, heat: float) -> tuple[str, ...]:
    """Return the overrides that make the simulated rig differ by these shares from its file's beliefs."""
    believed, fraction = rig.loops.load.stiffness_n_per_mm, rig.observer.friction_heat_fraction
    return (
        f"sim.contact.reference_stiffness={stiffness * believed:g} N/mm",
        f"sim.friction_heat_fraction={heat * fraction:g}",
        GROUND_IN,
    )


def _greatest(compound: str, rig: RigConfig) -> tuple[int, int, int]:
    """Return load (N), slip velocity (mm/s) and temperature (degC) beyond each of which ``check`` refuses the recipe.

    Load and temperature are found with hardly any slip; slip comes last.
    """
    mild_mm_s, warm_c = SLIP_STEP_MM_S, int(rig.ambient_c) + 1
    limits = rig.limits

    def passes(load_n: int, slip_mm_s: int, temperature_c: int) -> bool:
        return not check(_text(compound, load_n, slip_mm_s, temperature_c), rig, PART, "corner.yaml")

    load_n = _most(lambda one: passes(one, mild_mm_s, warm_c), int(limits.load_n), LOAD_STEP_N)
    temperature_c = _most(lambda one: passes(load_n, mild_mm_s, one), int(limits.surface_c), TEMPERATURE_STEP_K)
    slip_mm_s = _most(lambda one: passes(load_n, one, temperature_c), round(1e3 * WHEEL_M_S), SLIP_STEP_MM_S)
    return load_n, slip_mm_s, temperature_c


def _most(passes: Callable[[int], bool], start: int, step: int) -> int:
    """Return the first of ``start``, ``start`` - ``step``, ... that passes. Raises ValueError if none does."""
    for value in range(start, 0, -step):
        if passes(value):
            return value
    raise ValueError(f"nothing from {start} down passes the check")


def _text(compound: str, load_n: int, slip_mm_s: int, temperature_c: int) -> str:
    return _TEXT.format(
        compound=compound, load=load_n, slip=slip_mm_s, temperature=temperature_c, wheel=WHEEL_M_S,
        belt=PRE_GRIND_BELT_M_S,
    )  # fmt: skip
