"""Laws of friction, found by name.

A law returns the coefficient at a temperature (degC), a load (N) and a sliding speed (m/s). ``paper`` and ``v2``
are those of ``sim.physics.friction``, which contain their compounds. ``wlf_bell`` (``sim.physics.wlf``), ``two_bells``
(module of this name), ``power`` and ``arrhenius`` (``sim.physics.simple``) need figures. ``persson`` and ``greta``
(modules of these names) are made of a rubber and a surface; a ``LawSetting`` gives the source of both. A law from
elsewhere is registered, or a look-up finds it for a name that this module does not know.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from math import isfinite
from pathlib import Path
from types import MappingProxyType
from typing import Final, Protocol, runtime_checkable

from sim.physics.friction import MODEL_NAMES, FrictionModel, model_of
from sim.physics.materials import Components, Materials, Rubber, Surface
from sim.physics.simple import arrhenius, power
from sim.physics.two_bells import two_bells
from sim.physics.wlf import wlf_bell


class FrictionLaw(Protocol):
    """The coefficient of friction of one compound."""

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient at a temperature in degC, a load above 0 N and a sliding speed of at least 0 m/s."""
        ...


@runtime_checkable
class LawOfParts(FrictionLaw, Protocol):
    """A law that knows how much of its coefficient is adhesion and how much hysteresis."""

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return both parts; ``mu`` is their sum."""
        ...


@runtime_checkable
class LawOfRange(FrictionLaw, Protocol):
    """A law that knows its range of validity."""

    def caveats(self, temperature_c: float, load_n: float, slip_m_s: float) -> Iterator[str]:
        """Yield the reasons for care with the coefficient of a condition, a line each."""
        ...


@dataclass(frozen=True, slots=True)
class StatedLaw:
    """The law that a compound's file states: the name of a law, its figures, and the factor of a sideslip angle."""

    form: str
    figures: Mapping[str, float]
    cornering: float = 0.0
    """Extra friction per sin|sideslip|."""


def _states_none(compound: str) -> StatedLaw | None:
    return None


@dataclass(frozen=True, slots=True)
class LawSetting:
    """Data for a law besides compound and figures."""

    materials: Materials | None = None
    surface: str = ""
    """Name of the track."""
    area_mm2: float | None = None
    """Nominal area of contact: the load over it is the pressure."""
    tables: Path | None = None
    """Folder for the tables of slow laws; None: they are made anew."""
    stated: Callable[[str], StatedLaw | None] = _states_none
    """Returns the law that a compound's file states; None without a file, or for one that states none."""


@dataclass(frozen=True, slots=True)
class OfMaterials:
    """Declares a law that is made of materials."""

    make: Callable[[Rubber, Surface, float, Mapping[str, float]], FrictionLaw]
    """Makes the law from a rubber, a surface, the nominal area of contact in mm2, and figures; raises ValueError for
    unsuitable ones."""
    slow: bool = False
    """Whether it is so slow that a simulated rig uses a table of it (``sim.physics.tabulated``)."""
    version: int = 1
    """Version of the law, to be changed with its values for the same materials: older tables are then not used."""


PlainMaker = Callable[[str, Mapping[str, float]], FrictionLaw]
"""Makes a law from a compound's name and its figures (the law's parameters by name, in the units of the law); raises
UnknownCompoundError, or ValueError for figures that are missing, unknown or out of range."""

LawMaker = PlainMaker | OfMaterials

NO_FIGURES: Final[Mapping[str, float]] = MappingProxyType({})
NO_SETTING: Final = LawSetting()


class UnknownLawError(ValueError):
    """A law that is not registered; the message lists the registered laws."""


class NoPartsError(ValueError):
    """A law without separate parts; the message names it."""


def _of_the_paper(model: str, compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    return model_of(model, compound, figures) if figures else FrictionModel(compound, model)


def _persson(rubber: Rubber, surface: Surface, area_mm2: float, figures: Mapping[str, float]) -> LawOfParts:
    from sim.physics.persson import persson  # numpy takes a tenth of a second to import: only when a law needs it

    return persson(rubber, surface, area_mm2, figures)


def _greta(rubber: Rubber, surface: Surface, area_mm2: float, figures: Mapping[str, float]) -> LawOfParts:
    from sim.physics.greta import greta  # as above

    return greta(rubber, surface, {**figures, "area": area_mm2})


_LAWS: dict[str, LawMaker] = {
    **{name: partial(_of_the_paper, name) for name in MODEL_NAMES},
    "wlf_bell": wlf_bell,
    "two_bells": two_bells,
    "power": power,
    "arrhenius": arrhenius,
    "persson": OfMaterials(_persson, slow=True),
    "greta": OfMaterials(_greta, slow=True),
}
_FILES = (".yaml", ".yml")
_FINDERS: list[Callable[[str], LawMaker | None]] = []


def register(name: str, maker: LawMaker) -> None:
    """Add a law. Raises ValueError for a name that is taken."""
    if name in _LAWS:
        raise ValueError(f"a law {name!r} is there already")
    _LAWS[name] = maker


def look_up_with(finder: Callable[[str], LawMaker | None]) -> None:
    """Set the function that looks up laws of unknown names; it returns None for a name that it does not know."""
    if finder not in _FINDERS:
        _FINDERS.append(finder)


def names() -> tuple[str, ...]:
    """Return the names of the laws known by now."""
    return tuple(_LAWS)


def find(name: str) -> LawMaker:
    """Return the maker of a law. Raises UnknownLawError."""
    if name not in _LAWS:
        for finder in _FINDERS:
            maker = finder(name)
            if maker is not None:
                if name.endswith(_FILES):
                    return maker  # a file may change: it is read anew
                _LAWS[name] = maker
                break
        else:
            raise UnknownLawError(f"no friction law {name!r}; known: {', '.join(_LAWS)}")
    return _LAWS[name]


def make(
    name: str, compound: str, figures: Mapping[str, float] = NO_FIGURES, setting: LawSetting = NO_SETTING
) -> FrictionLaw:
    """Return the law of a name for a compound.

    Raises UnknownLawError and the maker's exceptions; for a law of materials, UnknownMaterialError, and ValueError for
    an incomplete setting.
    """
    maker = find(name)
    if isinstance(maker, OfMaterials):
        return _of_materials(name, maker, compound, figures, setting)
    return maker(compound, figures)


def _of_materials(
    name: str, maker: OfMaterials, compound: str, figures: Mapping[str, float], setting: LawSetting
) -> FrictionLaw:
    materials, area_mm2 = setting.materials, setting.area_mm2
    needs = {
        f"the modulus of {compound!r}": materials is not None,
        "a surface": bool(setting.surface),
        "the nominal area of contact": area_mm2 is not None,
    }
    missing = [what for what, given in needs.items() if not given]
    if materials is None or area_mm2 is None or missing:
        raise ValueError(f"law {name!r} is made of materials and needs {' and '.join(missing)}")
    if not (isfinite(area_mm2) and area_mm2 > 0.0):
        raise ValueError(f"the nominal area of contact must be finite and above 0 mm2, not {area_mm2!r}")
    return maker.make(materials.rubber(compound), materials.surface(setting.surface), area_mm2, figures)


def caveats_of(law: FrictionLaw, temperature_c: float, load_n: float, slip_m_s: float) -> Iterator[str]:
    """Yield the reasons for care with the coefficient of a condition; none for a law without a known range."""
    if isinstance(law, LawOfRange):
        yield from law.caveats(temperature_c, load_n, slip_m_s)


def with_parts(name: str, law: FrictionLaw) -> LawOfParts:
    """Return the law itself if it knows its parts. Raises NoPartsError."""
    if isinstance(law, LawOfParts):
        return law
    raise NoPartsError(f"law {name!r} gives the coefficient alone: it does not know adhesion from hysteresis")
