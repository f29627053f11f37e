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
    """The laws of a recipe's compounds, each found once."""

    def __init__(self, rig: RigConfig, tree: Tree) -> None:
        """Find nothing yet."""
        self._rig, self._path = rig, Path(tree.name)
        top = tree.data if isinstance(tree.data, dict) else {}
        abrasive = top.get("abrasive")
        name = abrasive.get("name") if isinstance(abrasive, dict) else abrasive
        self._surface = name if isinstance(name, str) else ""
        self._found: dict[str, WheelLaw | str] = {}

    def law(self, compound: str) -> WheelLaw | None:
        """Return the law of a compound; None without a usable one, or on a machine without a known one."""
        found = self._of(compound)
        if isinstance(found, str) or (found.assumed and not self._rig.simulated):
            return None
        return found

    def fault(self, compound: str) -> str:
        """Return why the simulated wheel cannot rub with a compound, "" if it can."""
        found = self._of(compound)
        return found if isinstance(found, str) else ""

    def _of(self, compound: str) -> WheelLaw | str:
        if compound not in self._found:
            try:
                self._found[compound] = _sound(twin_law(self._rig, compound, self._surface, self._path))
            except UnknownCompoundError as error:
                self._found[compound] = f"sim.friction_model {self._rig.sim.friction_model}: {error}"
            except (ValueError, InvalidSource) as error:
                fault = f"the simulated wheel has no friction for {shown(compound)}: {error}"
                if isinstance(error, OutsideError):
                    fault += "; a wheel also rolls (expected moduli with beyond: hold)"
                self._found[compound] = fault
        return self._found[compound]


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
        law = found.law(compound)
        if law is None or compound in seen:
            continue
        seen.add(compound)
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
