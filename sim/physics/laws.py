"""Laws of friction, found by name.

A law is asked for the coefficient at a temperature (degC), a load (N) and a sliding speed (m/s). ``paper`` and ``v2``
are those of ``sim.physics.friction``, which know their compounds; ``wlf_bell`` (``sim.physics.wlf``) is given its
figures. A law from elsewhere is registered, or looked up where this module knows no law of a name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Final, Protocol

from sim.physics.friction import MODEL_NAMES, FrictionModel
from sim.physics.wlf import wlf_bell


class FrictionLaw(Protocol):
    """The coefficient of friction of one compound."""

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient at a temperature in degC, a load above 0 N and a sliding speed of at least 0 m/s."""
        ...


LawMaker = Callable[[str, Mapping[str, float]], FrictionLaw]
"""From a compound's name and its figures (the law's parameters by name, in the units that the law states); raises
UnknownCompoundError, or ValueError for figures that are missing, unknown or out of range."""

NO_FIGURES: Final[Mapping[str, float]] = MappingProxyType({})


class UnknownLawError(ValueError):
    """A law that nobody has registered; the message names those that are there."""


def _of_the_paper(model: str, compound: str, figures: Mapping[str, float]) -> FrictionLaw:
    if figures:
        raise ValueError(f"law {model!r} has its figures from the paper and takes none, not {', '.join(figures)}")
    return FrictionModel(compound, model)


_LAWS: dict[str, LawMaker] = {
    **{name: partial(_of_the_paper, name) for name in MODEL_NAMES},
    "wlf_bell": wlf_bell,
}
_FINDERS: list[Callable[[str], LawMaker | None]] = []


def register(name: str, maker: LawMaker) -> None:
    """Add a law. Raises ValueError for a name that is taken."""
    if name in _LAWS:
        raise ValueError(f"a law {name!r} is there already")
    _LAWS[name] = maker


def look_up_with(finder: Callable[[str], LawMaker | None]) -> None:
    """Ask ``finder`` for laws of names that are not known here; None: it has none either."""
    if finder not in _FINDERS:
        _FINDERS.append(finder)


def names() -> tuple[str, ...]:
    """Return the laws that are known by now."""
    return tuple(_LAWS)


def find(name: str) -> LawMaker:
    """Return what makes a law. Raises UnknownLawError."""
    if name not in _LAWS:
        for finder in _FINDERS:
            maker = finder(name)
            if maker is not None:
                _LAWS[name] = maker
                break
        else:
            raise UnknownLawError(f"no friction law {name!r}; known: {', '.join(_LAWS)}")
    return _LAWS[name]


def make(name: str, compound: str, figures: Mapping[str, float] = NO_FIGURES) -> FrictionLaw:
    """Return the law of a name for a compound. Raises UnknownLawError and what its maker raises."""
    return find(name)(compound, figures)
