"""The simulated wheel's law of friction for a compound of a recipe, as far as a plan and its checks need it."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
from itertools import product
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Final

from sim.physics.friction import KNOWN, MODEL_NAMES, UnknownCompoundError
from sim.physics.laws import NO_SETTING
from sim.physics.materials import OutsideError
from sim.physics.wheel_law import WHEEL_C, WHEEL_M_S, WHEEL_N, WheelLaw, wheel_law
from tester.base.axes import SURFACE
from tester.base.source import InvalidSource, Problem, Tree
from tester.base.units import shown
from tester.inputs.materials.setting import law_setting
from tester.inputs.recipe.recipe_schema import Recipe

CLEAR_SHARE: Final = 0.1
"""In the first contact friction of more than this share of the load has a sign [A]: the least coefficient of the
paper's tests is 0.5."""
LEAST_N: Final = 1.0
"""... and also of more than this [A]: noise, cross-talk, and drift of the zero since the tare."""
CLEAR: Final = 1.2
"""Friction expected in the first contact, over the least that counts [A]: a new contact has 10 % less."""
EACH_K: Final = 10.0
"""Distance of the temperatures at which a law is tried, K [A]: a bell of a compound is some 20 K wide."""

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.rig import RigConfig


def twin_law(rig: RigConfig, compound: str, surface: str = "", recipe: Path | None = None) -> WheelLaw:
    """Return the law of a compound on the simulated wheel; ``recipe``: the file beside which others are found first.

    Raises ValueError and InvalidSource as ``wheel_law``.
    """
    model = rig.sim.friction_model
    setting = NO_SETTING if model in MODEL_NAMES and compound in KNOWN else law_setting(surface, recipe)
    return wheel_law(model, compound, setting, rig.sim.friction.area)


class TwinLaws:
    """The laws of a recipe's compounds on its belts, each found once."""

    def __init__(self, rig: RigConfig, tree: Tree) -> None:
        """Find nothing yet."""
        self._rig, self._path = rig, Path(tree.name)
        self._surfaces = [*_named_in(tree)] or [""]
        self._found: dict[tuple[str, str], WheelLaw | str] = {}

    def laws(self, compound: str) -> list[WheelLaw]:
        """Return the laws of a compound, one for each belt on which it has another; none on a machine without a known
        one.
        """
        found = [self._of(compound, surface) for surface in self._surfaces]
        usable = [one for one in found if not isinstance(one, str) and not (one.assumed and not self._rig.simulated)]
        return [one for place, one in enumerate(usable) if one not in usable[:place]]

    def fault(self, compound: str) -> str:
        """Return why the simulated wheel cannot rub with a compound, "" if it can."""
        found = (self._of(compound, surface) for surface in self._surfaces)
        return next((one for one in found if isinstance(one, str)), "")

    def _of(self, compound: str, surface: str) -> WheelLaw | str:
        key = compound, surface
        if key not in self._found:
            try:
                self._found[key] = _sound(twin_law(self._rig, compound, surface, self._path))
            except UnknownCompoundError as error:
                self._found[key] = f"sim.friction_model {self._rig.sim.friction_model}: {error}"
            except (ValueError, InvalidSource) as error:
                fault = f"the simulated wheel has no friction for {shown(compound)}: {error}"
                if isinstance(error, OutsideError):
                    fault += "; a wheel also rolls (expected moduli with beyond: hold)"
                self._found[key] = fault
        return self._found[key]


def _named_in(tree: Tree) -> Iterator[str]:
    """Yield the names of the belts in a recipe: the abrasive's, and those that its grids list."""
    top = tree.data if isinstance(tree.data, dict) else {}
    abrasive, grids = top.get("abrasive"), top.get("grids")
    name = abrasive.get("name") if isinstance(abrasive, dict) else abrasive
    if isinstance(name, str):
        yield name
    for grid in grids if isinstance(grids, list) else []:
        listed = grid.get(SURFACE) if isinstance(grid, dict) else None
        yield from (one for one in (listed if isinstance(listed, list) else [listed]) if isinstance(one, str))


def _sound(found: WheelLaw) -> WheelLaw:
    """Return the law. Raises ValueError where it has no coefficient in the range of a wheel."""
    low_c, high_c = WHEEL_C
    warmths = [low_c + EACH_K * place for place in range(round((high_c - low_c) / EACH_K) + 1)]
    for at_c, load_n, slip_m_s in product(warmths, WHEEL_N, (0.0, *WHEEL_M_S)):
        mu = found.mu(at_c, load_n, slip_m_s)
        if not (isfinite(mu) and mu >= 0.0):
            place = f"{at_c:g} degC, {load_n:g} N and {slip_m_s:g} m/s"
            raise ValueError(f"its law has the coefficient {mu:g} at {place} (expected at least 0)")
    return found


def twin_doubts(rig: RigConfig, recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield a doubt for each compound whose law on the simulated wheel is assumed, or whose friction is so low that the
    first contact would not show its direction."""
    if not rig.simulated:
        return
    found, p, seen = TwinLaws(rig, tree), rig.interlocks, set[str]()
    slip_m_s = p.first_contact_sweep * p.first_contact_slow_m_s + p.first_contact_creep_m_s
    for number, specimen in enumerate(recipe.specimens):
        at, compound = ("specimens", number, "compound"), specimen.compound
        laws = found.laws(compound)
        if not laws or compound in seen:
            continue
        seen.add(compound)
        law = min(laws, key=lambda one: one.mu(rig.ambient_c, p.first_contact_load_n, slip_m_s))
        if law.assumed:
            near = get_close_matches(compound, KNOWN, 1)
            meant = f", did you mean {near[0]}?" if near else ""
            expected = f"expected law: in the file of the compound, or one of {', '.join(KNOWN)}"
            yield tree.problem(at, f"compound: {law.assumed}{meant} ({expected})")
        mu, load_n = law.mu(rig.ambient_c, p.first_contact_load_n, slip_m_s), p.first_contact_load_n
        if not mu * load_n > CLEAR * max(LEAST_N, CLEAR_SHARE * load_n):
            place = f"{mu:.2g} at {load_n:g} N and {1e3 * slip_m_s:.3g} mm/s"
            message = f"compound: the simulated wheel's law of {shown(compound)} has {place}, too little for the first"
            yield tree.problem(at, f"{message} contact to show (expected above {CLEAR * CLEAR_SHARE:g})")
