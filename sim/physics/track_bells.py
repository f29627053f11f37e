"""Rubbers and surfaces of the simulated track: what its bells of friction are made of.

``[A]`` marks an engineering assumption. A field is ``Annotated[float, unit]``; unit "1" is a plain number.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import Annotated, Final

from sim.physics.two_bells import TwoBellsParameters
from sim.physics.wlf import WlfBellParameters


def refuse(group: object, zero_allowed: AbstractSet[str], signed: AbstractSet[str] = frozenset()) -> None:
    """Raise ValueError unless every number of a group is finite and above zero, or zero where allowed."""
    for item in fields(group):  # type: ignore[arg-type]
        value: object = getattr(group, item.name)
        if isinstance(value, bool) or not isinstance(value, int | float) or item.name in signed:
            continue
        if not math.isfinite(value) or value < 0.0 or (value == 0.0 and item.name not in zero_allowed):
            least = "at least 0" if item.name in zero_allowed else "above 0"
            raise ValueError(f"{type(group).__name__}.{item.name} must be finite and {least}, not {value!r}")


@dataclass(frozen=True, slots=True)
class TrackRubber(WlfBellParameters):
    """A rubber of the simulated track, for ``wlf_bell`` and for ``two_bells``.

    The frequencies are the maxima of the moduli in the rubber's file at t_ref. Heights and widths are assumed; with
    them mu reaches 2.2 on glass and 2.1 on an abrasive, as ``wlf_bell`` does.
    """

    loss_modulus: Annotated[float, "Hz"] = 3673.0  # of its maximum at t_ref, which with jump places adhesion
    loss_factor: Annotated[float, "Hz"] = 11.615  # of its maximum at t_ref, which with grit places hysteresis
    adhesion: Annotated[float, "1"] = 1.7  # [A] of two_bells, above mu_0 on a smooth surface
    hysteresis: Annotated[float, "1"] = 1.6  # [A] of two_bells, above mu_0 on an abrasive
    adhesion_width: Annotated[float, "1"] = 0.7  # [A] decades from the maximum to 1/e of it: both are seen apart
    hysteresis_width: Annotated[float, "1"] = 0.7  # [A]

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        WlfBellParameters.__post_init__(self)
        refuse(self, {"mu_0", "adhesion", "hysteresis"}, signed={"t_ref"})


@dataclass(frozen=True, slots=True)
class TrackSurface:
    """A surface of the simulated track, for ``two_bells``; the defaults are an abrasive of 180 mesh."""

    jump: Annotated[float, "um"] = 0.006  # 6 nm (paper S, section 4): the molecular jump of adhesion
    grit: Annotated[float, "um"] = 150.0  # between asperities (paper S, section 4): the longest wave in its file
    adhesion: Annotated[float, "1"] = 0.5  # [A] share of a rubber's adhesion on a smooth surface: less touches
    hysteresis: Annotated[float, "1"] = 1.0  # [A] share of a rubber's hysteresis on an abrasive

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, {"adhesion", "hysteresis"})


_SBR: Final = TrackRubber()
_INR: Final = TrackRubber(
    t_ref=-20.0, v_ref=2.753e-3, mu_max=2.36, width=2.6,
    loss_factor=18.353, hysteresis=1.86, hysteresis_width=0.60,
)  # fmt: skip
_ABR: Final = TrackRubber(
    t_ref=16.0, v_ref=2.285e-3, mu_max=2.23, width=2.8,
    loss_factor=15.233, hysteresis=1.73, hysteresis_width=0.65,
)  # fmt: skip
_BUTYL: Final = TrackRubber(
    t_ref=-23.0, v_ref=1.058e-3, width=3.2,
    loss_factor=7.054, hysteresis=1.53, hysteresis_width=0.74,
)  # fmt: skip
RUBBERS: Final[Mapping[str, TrackRubber]] = MappingProxyType({
    "SBR": _SBR,  # Tg = -53 degC [A]
    "NR": _INR,  # Tg = -70 degC [A], as INR
    "NBR": replace(_ABR, t_ref=25.0),  # Tg = -25 degC [A], else as ABR
    "ABR": _ABR,  # Tg = -34 degC, as in the compound's file, like those below
    "INR": _INR,  # Tg = -70 degC
    "butyl": _BUTYL,  # Tg = -73 degC
})
"""Rubbers by their names in recipes.

Each has the places of its file's moduli: at t_ref the loss modulus is greatest at the same frequency for all [A]; the
loss factor at a lower one, the broader its relaxation is (``b`` in the file). Heights of hysteresis are in the
proportions that paper S, Eq 1, gives for these moduli on silicon carbide; its width and that of ``wlf_bell`` go with
1 / b [A]. Adhesion is the same for all: on smooth tracks gum rubbers have one maximum of similar shape and about the
same height (doi 10.1201/9781420007183-26, abstract). The shift has the same constants for all (paper S, section 4).
"""
_SMOOTH: Final = TrackSurface(adhesion=1.0, hysteresis=0.0)
SURFACES: Final[Mapping[str, TrackSurface]] = MappingProxyType({
    "silicon carbide": TrackSurface(),
    "glass": _SMOOTH,
    "wavy glass": _SMOOTH,
    "polished steel": TrackSurface(adhesion=0.8, hysteresis=0.0),  # [A] below glass, as paper S, Fig 6
})
"""Surfaces by their names in recipes; any other one, and a bare track, is an abrasive like the first."""


def bells(rubber: TrackRubber, surface: TrackSurface) -> TwoBellsParameters:
    """Return the two bells of a rubber on a surface: each place is a length of the surface times a frequency."""
    return TwoBellsParameters(
        mu_0=rubber.mu_0,
        adhesion=rubber.adhesion * surface.adhesion,
        hysteresis=rubber.hysteresis * surface.hysteresis,
        adhesion_width=rubber.adhesion_width,
        hysteresis_width=rubber.hysteresis_width,
        v_adhesion=1e-6 * surface.jump * rubber.loss_modulus,
        v_hysteresis=1e-6 * surface.grit * rubber.loss_factor,
        t_ref=rubber.t_ref,
        c1=rubber.c1,
        c2=rubber.c2,
    )
