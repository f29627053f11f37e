"""A kept law: read from its file, evaluated with its interval, with what to take care of at a condition."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import exp, log, sqrt
from pathlib import Path
from typing import Final, NamedTuple

from pydantic import ValidationError

from sim.physics import laws
from sim.physics.fitted import fitted_law
from sim.physics.materials import Rubber, Surface
from tester.analysis.quantiles import t_quantile
from tester.base.source import InvalidSource, Problem, read_tree
from tester.base.validation import problems_of
from tester.inputs.kept_laws.law_schema import KeptLawModel

_EXPECTED: Final = "a kept law is a list of keys: kept_law, form, parameters, covariance, range, data and others"
_STEP: Final = 1e-4
"""Step of a derivative, as a share of the parameter's standard deviation, or of its value where that is 0."""
NEAR: Final = 0.02
"""Share of a range's width, or of a single value, by which a value may be beyond it without a word [A]: what a rig
holds."""


class Predicted(NamedTuple):
    """A coefficient with the ends of its 95 % interval."""

    mu: float
    low: float
    high: float


@dataclass(frozen=True)
class KeptLaw:
    """A law of a file. The law itself is that of ``sim.physics.laws`` with the file's figures."""

    model: KeptLawModel
    name: str
    """The file's name."""
    doubts: tuple[str, ...] = ()
    """What is doubtful everywhere: an edited file, a law that does not describe its conditions."""
    made_of: tuple[Rubber, Surface] | None = None
    """The materials of a law that is made of them."""

    @cached_property
    def law(self) -> laws.FrictionLaw:
        """Return the law at its parameters."""
        return self._with(self.model.figures())

    def _with(self, figures: Mapping[str, float]) -> laws.FrictionLaw:
        model = self.model
        if not model.of_materials:
            return laws.make(model.form, model.compound, figures)
        assert self.made_of is not None and model.area is not None  # law_materials reads both
        return fitted_law(model.form, *self.made_of, {**figures, "area": model.area})

    def on(self, rubber: Rubber, surface: Surface, area_mm2: float, figures: Mapping[str, float]) -> laws.LawOfParts:
        """Return the law of materials for a rig's contact (``sim.physics.laws.OfMaterials``); raises ValueError."""
        self.of(rubber.name, figures)
        if surface.name != self.model.surface:
            raise ValueError(f"{self.name} is the law on {self.model.surface!r}, not on {surface.name!r}")
        return fitted_law(self.model.form, rubber, surface, {**self.model.figures(), "area": area_mm2})

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient (``FrictionLaw.mu``)."""
        return self.law.mu(temperature_c, load_n, slip_m_s)

    def caveats(self, temperature_c: float, load_n: float, slip_m_s: float) -> Iterator[str]:
        """Yield the doubts of the file, and each variable beyond the range of the fitted conditions."""
        yield from self.doubts
        yield from self.beyond(temperature_c, load_n, slip_m_s)

    def beyond(self, temperature_c: float, load_n: float, slip_m_s: float) -> Iterator[str]:
        """Yield each variable that is beyond the range of the fitted conditions."""
        known = self.model.range
        for what, value, (low, high), unit, scale in (
            ("temperature", temperature_c, known.temperature, "degC", 1.0),
            ("load", load_n, known.load, "N", 1.0),
            ("speed", slip_m_s, known.speed, "mm/s", 1e3),
        ):
            slack = NEAR * ((high - low) or abs(high))
            if not low - slack <= value <= high + slack:
                within = f"{scale * low:.4g} to {scale * high:.4g} {unit} of {self.name}"
                yield f"{what} {scale * value:.4g} {unit} is beyond the fitted {within}: an extrapolation"

    def predict(self, temperature_c: float, load_n: float, slip_m_s: float) -> Predicted:
        """Return the coefficient of a new condition of the same specimens, with the interval (95 %) of its measured
        value: from the covariance of the parameters, and the scatter of conditions about the law."""
        at = temperature_c, load_n, slip_m_s
        mu = self.mu(*at)
        slopes = [(log(ahead.mu(*at)) - log(behind.mu(*at))) / step for ahead, behind, step in self._nearby]
        covariance = self.model.covariance
        variance = sum(a * b * covariance[i][j] for i, a in enumerate(slopes) for j, b in enumerate(slopes))
        standard = sqrt(max(variance, 0.0) + self.model.scatter**2)
        off = t_quantile(0.975, float(self.model.degrees_of_freedom)) * standard
        return Predicted(mu, mu * exp(-off), mu * exp(off))

    @cached_property
    def _nearby(self) -> list[tuple[laws.FrictionLaw, laws.FrictionLaw, float]]:
        """Return, for each fitted parameter, the laws a step ahead and behind, and the distance of both."""
        model = self.model
        near: list[tuple[laws.FrictionLaw, laws.FrictionLaw, float]] = []
        for place, name in enumerate(model.fitted):
            one = model.parameters[name]
            step = _STEP * (sqrt(model.covariance[place][place]) or abs(one.value) or 1.0)
            ends = [one.value * exp(move) if one.logarithm else one.value + move for move in (step, -step)]
            ahead, behind = (self._moved(name, value) for value in ends)
            near.append((ahead, behind, 2.0 * step))
        return near

    def _moved(self, name: str, value: float) -> laws.FrictionLaw:
        return self._with(self.model.figures() | {name: value})

    def of(self, compound: str, figures: Mapping[str, float] = laws.NO_FIGURES) -> KeptLaw:
        """Return itself for its own compound (``sim.physics.laws.PlainMaker``). Raises ValueError for any other."""
        model = self.model
        if compound != model.compound:
            raise ValueError(f"{self.name} is the law of {model.compound!r}, not of {compound!r}")
        if figures:
            raise ValueError(f"{self.name} has its own figures and takes none, not {', '.join(figures)}")
        if model.interface not in ("", "dry"):
            raise ValueError(f"{self.name} is of a {model.interface} contact (expected dry: the rig file has the rest)")
        return self


def load_law(path: Path) -> KeptLaw:
    """Read a kept law, without its compound and surface (``law_materials``).

    Raises InvalidSource with every problem.
    """
    tree, problems = read_tree(path)
    if not isinstance(tree.data, dict):
        raise InvalidSource([*problems, Problem(tree.name, 1, 1, _EXPECTED)])
    try:
        model = KeptLawModel.model_validate(tree.data)
    except ValidationError as error:
        raise InvalidSource([*problems, *problems_of(error, tree, KeptLawModel)]) from error
    if problems:
        raise InvalidSource(problems)
    return KeptLaw(model, path.name, tuple(_doubts(model, path)))


def _doubts(model: KeptLawModel, path: Path) -> Iterator[str]:
    if model.hash() != model.content:
        yield f"{path.name} was edited after its fit: its content does not have the hash that the fit wrote"
    if model.describes == "no":
        yield f"the law of {path.name} does not describe the conditions that it was fitted to"
    elif model.describes == "unknown":
        yield f"whether the law of {path.name} describes its conditions is unknown: their repeatability was"
