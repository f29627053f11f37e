"""Parameters of a specimen on a track: the rig file's section ``sim`` of this kind.

``[A]`` marks an engineering assumption. A field is ``Annotated[float, unit]``; unit "1" is a plain number.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from itertools import product
from typing import Annotated, Final, Literal

from sim.physics import laws
from sim.physics.lookup import TableSpan
from sim.physics.materials import Components, ReadOnce
from sim.physics.track_bells import RUBBERS, SURFACES, TrackRubber, TrackSurface, bells, refuse
from sim.physics.two_bells import TwoBells
from sim.physics.wlf import GLASS_TO_REFERENCE_K, WlfBell

Motion = Literal["linear", "disc"]
Interface = Literal["dry", "wet", "talc"]

TWO_BELLS: Final = "two_bells"

TABLE_M_S: Final = (1e-6, 10.0)
TABLE_C: Final = (-50.0, 100.0)
TABLE_N: Final = (2.0, 200.0)
"""Ranges of a slow law's table for a simulated rig. Values below them, as for a track that comes to a stop or for an
arm that is lowered, are those at the ends."""


@dataclass(frozen=True, slots=True)
class TrackContact:
    """Specimen, arm and track."""

    stiffness: Annotated[float, "N/mm"] = 200.0  # [A] tangential, of arm, cell and specimen in a row
    static_excess: Annotated[float, "1"] = 0.2  # [A] friction of a rested contact above that of sliding ...
    static_length: Annotated[float, "mm"] = 0.05  # [A] ... which goes with this sliding distance
    lift_travel: Annotated[float, "mm"] = 10.0  # [A] from lowered (0) to raised
    touch: Annotated[float, "mm"] = 1.0  # [A] the arm's position at which specimen and track meet, full load at 0
    protrusion: Annotated[float, "mm"] = 3.0  # [A] a new specimen is out of its holder by this
    squeeze: Annotated[float, "N/mm"] = 80.0  # [A] stiffness of the specimen under the load: 5 MPa, 100 mm2, 6 mm
    expansion: Annotated[float, "mm/K"] = 0.001  # [A] of the specimen: 2e-4 per kelvin, 6 mm
    wear: Annotated[float, "mm/m"] = 0.0005  # [A] height that the specimen loses over its sliding distance
    runout: Annotated[float, "mm"] = 0.02  # [A] of a disc, to either side
    weights: Annotated[float, "1"] = 0.0  # greatest error of a session's weights, as a share
    area: Annotated[float, "mm2"] = 100.0  # [A] nominal, of the specimen on the track: makes a pressure of the load
    wet: Annotated[float, "1"] = 0.6  # [A] share of the dry friction, by a law that does not know adhesion
    talc: Annotated[float, "1"] = 0.5  # [A] the same
    wet_adhesion: Annotated[float, "1"] = 0.0  # [A] share of the adhesion, by a law that knows it
    talc_adhesion: Annotated[float, "1"] = 0.1  # [A] the same: talc lowers the adhesion much more ...
    talc_hysteresis: Annotated[float, "1"] = 0.9  # [A] ... than the hysteresis (paper S, section 4)
    pressure_exponent: Annotated[float, "1"] = 0.0  # friction falls with the nominal pressure to this power (paper S,
    # section 4: up to 0.1 either way for treads, a third for soft rubber on smooth surfaces); 0: none
    pressure_reference: Annotated[float, "kPa"] = 100.0  # [A] ... and is the law's at this pressure

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        shares = {"static_excess", "wet", "talc", "wet_adhesion", "talc_adhesion", "talc_hysteresis",
                  "weights", "wear", "runout", "expansion"}  # fmt: skip
        refuse(self, shares, signed={"pressure_exponent"})
        if self.touch >= self.lift_travel:
            raise ValueError("TrackContact.touch must be below lift_travel: raised, nothing touches")

    def through(self, law: laws.FrictionLaw, interface: Interface) -> laws.FrictionLaw:
        """Return the law with the interface between specimen and track.

        If the law knows its parts, water takes adhesion and leaves hysteresis, and talc takes most of the adhesion and
        little of the hysteresis; otherwise they take a share of all.
        """
        if self.pressure_exponent:
            parts = isinstance(law, laws.LawOfParts)
            reference_n = 1e-3 * self.pressure_reference * self.area
            law = (PressedParts if parts else Pressed)(law, self.pressure_exponent, reference_n)  # type: ignore[arg-type]
        if interface == "dry":
            return law
        if isinstance(law, laws.LawOfParts):
            if interface == "wet":
                return LessOfParts(law, self.wet_adhesion, 1.0)
            return LessOfParts(law, self.talc_adhesion, self.talc_hysteresis)
        return LessFriction(law, {"wet": self.wet, "talc": self.talc}[interface])


class Pressed:
    """A law's friction that falls with the nominal pressure to a power."""

    def __init__(self, law: laws.FrictionLaw, exponent: float, reference_n: float) -> None:
        """Take the law, which holds at the reference load, N."""
        self._law, self._exponent, self._reference_n = law, exponent, reference_n

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient."""
        return self._law.mu(temperature_c, load_n, slip_m_s) * self.share(load_n)

    def share(self, load_n: float) -> float:
        """Return the friction as a share of the law's."""
        return (load_n / self._reference_n) ** -self._exponent if load_n > 0.0 else 1.0


class PressedParts(Pressed):
    """The same of a law that knows its parts: both fall alike."""

    _law: laws.LawOfParts

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return the parts."""
        share = self.share(load_n)
        adhesion, hysteresis = self._law.components(temperature_c, load_n, slip_m_s)
        return Components(share * adhesion, share * hysteresis)


class LessFriction:
    """A share of a law's friction."""

    def __init__(self, law: laws.FrictionLaw, share: float) -> None:
        """Take the law of dry contact."""
        self._law, self._share = law, share

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient."""
        return self._law.mu(temperature_c, load_n, slip_m_s) * self._share


class LessOfParts:
    """A share of a law's adhesion, and one of its hysteresis."""

    def __init__(self, law: laws.LawOfParts, of_adhesion: float, of_hysteresis: float) -> None:
        """Take the law of dry contact."""
        self._law, self._of_adhesion, self._of_hysteresis = law, of_adhesion, of_hysteresis

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return the remaining parts."""
        adhesion, hysteresis = self._law.components(temperature_c, load_n, slip_m_s)
        return Components(self._of_adhesion * adhesion, self._of_hysteresis * hysteresis)

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient."""
        return sum(self.components(temperature_c, load_n, slip_m_s))


@dataclass(frozen=True, slots=True)
class TrackHeat:
    """Chamber and specimen, one lump each, all [A]."""

    chamber_rate: Annotated[float, "K/s"] = 0.06  # of the air at full output: 3.6 K a minute
    chamber_time: Annotated[float, "s"] = 1800.0  # of the air back to ambient; full output ends 108 K from it
    specimen_time: Annotated[float, "s"] = 300.0  # of the specimen to the air around it
    specimen_rise: Annotated[float, "K/W"] = 5.0  # of the specimen above that air, in the end, by its share of friction
    friction_share: Annotated[float, "1"] = 0.1  # of the friction's heat that goes into the specimen
    exit_rise: Annotated[float, "K/W"] = 2.0  # of the track at the contact's exit edge, above the specimen

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, {"specimen_rise", "friction_share", "exit_rise"})


@dataclass(frozen=True, slots=True)
class TrackSensors:
    """Imperfections of the sensors; ``TrackParameters.noise`` scales every one but ranges and lags, all [A]."""

    force_range: Annotated[float, "N"] = 200.0
    force_rms: Annotated[float, "N"] = 0.02
    force_zero: Annotated[float, "N"] = 0.5  # greatest offset of a session: what the tare takes off
    force_drift: Annotated[float, "N/K"] = 0.005  # greatest, of the air's temperature against ambient
    force_linearity: Annotated[float, "N"] = 0.0  # greatest of a session: the cell's curve off its line
    misalignment: Annotated[float, "deg"] = 0.0  # greatest of a session: of the cell's axis against the track
    height_rms: Annotated[float, "mm"] = 0.003
    height_zero: Annotated[float, "mm"] = 0.05  # greatest offset of a session
    height_drift: Annotated[float, "mm/K"] = 0.0005  # greatest, of the air's temperature against ambient
    air_rms: Annotated[float, "K"] = 0.02
    air_bias: Annotated[float, "K"] = 1.0  # greatest of a session: Pt100 class B, and the air's layers
    air_time: Annotated[float, "s"] = 5.0
    pyrometer_rms: Annotated[float, "K"] = 0.1
    pyrometer_bias: Annotated[float, "K"] = 1.0  # greatest of a session
    pyrometer_time: Annotated[float, "s"] = 0.15

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, {item.name for item in fields(self)} - {"force_range", "air_time", "pyrometer_time"})


@dataclass(frozen=True, slots=True)
class TrackParameters:
    """All parameters of the plant."""

    motion: Motion = "linear"
    travel: Annotated[float, "mm"] = 300.0  # of a linear track from stop to stop [A]; without meaning on a disc
    switches: Annotated[float, "mm"] = 5.0  # an end switch opens the safety chain this far before its stop [A]
    enclosed: bool = True  # the specimen is in the climate chamber, else in the room's air
    noise: Annotated[float, "1"] = 1.0  # scale of every sensor imperfection
    scatter: Annotated[float, "1"] = 1.0  # scale of the friction's scatter: specimens 3 %, repeats 2 % [A]
    law: str = "wlf_bell"  # by its name in sim.physics.laws
    stick_slip: Annotated[float, "1"] = 0.0  # friction swings by this share of it to either side ...
    stick_slip_frequency: Annotated[float, "Hz"] = 4.0  # ... so often a second [A], as far as the arm's spring follows
    surface: str = ""  # of the track, where the law asks for it; "": the recipe's abrasive
    ambient: Annotated[float, "degC"] = 23.0
    faults: tuple[str, ...] = ()  # a fault script (sim.faults.language)
    contact: TrackContact = field(default_factory=TrackContact)
    heat: TrackHeat = field(default_factory=TrackHeat)
    sensors: TrackSensors = field(default_factory=TrackSensors)
    rubbers: Mapping[str, TrackRubber] = field(default_factory=lambda: dict(RUBBERS))
    surfaces: Mapping[str, TrackSurface] = field(default_factory=lambda: dict(SURFACES))

    def __post_init__(self) -> None:
        """Raise ValueError for values out of range."""
        refuse(self, {"noise", "scatter", "stick_slip"}, signed={"ambient"})
        if self.stick_slip >= 1.0:
            raise ValueError(f"stick_slip is a share of friction, 0 to below 1, not {self.stick_slip!r}")
        if not -40.0 <= self.ambient <= 60.0:
            raise ValueError(f"ambient must be -40 to 60 degC, not {self.ambient!r}")
        if 2.0 * self.switches >= self.travel:
            raise ValueError("TrackParameters.switches leave nothing of the travel")
        try:
            laws.find(self.law)
        except laws.UnknownLawError as error:
            raise ValueError(f"law: {error}") from None

    @property
    def of_materials(self) -> bool:
        """Return whether the law is made of a rubber and a surface."""
        return isinstance(laws.find(self.law), laws.OfMaterials)

    @property
    def by_surface(self) -> bool:
        """Return whether the law asks for the surface of the track."""
        return self.law == TWO_BELLS or self.of_materials

    def law_of(self, compound: str, setting: laws.LawSetting = laws.NO_SETTING) -> laws.FrictionLaw:
        """Return the law of a rubber itself.

        Raises ValueError for a rubber that ``rubbers``, or the setting's materials, lack although the law needs it.
        """
        if self.law not in ("wlf_bell", TWO_BELLS):
            return laws.make(self.law, compound, setting=self._own(setting))
        rubber = self._rubber(compound, setting)
        if self.law == TWO_BELLS:
            return TwoBells(bells(rubber, self.surfaces.get(self.surface or setting.surface, TrackSurface())))
        return WlfBell(rubber)

    def _rubber(self, compound: str, setting: laws.LawSetting) -> TrackRubber:
        """Return a rubber of the rig file, else, for ``two_bells``, of its own file; raises ValueError."""
        if compound in self.rubbers:
            return self.rubbers[compound]
        fault = f"no rubber {compound!r} among sim.rubbers; known: {', '.join(self.rubbers)}"
        if self.law != TWO_BELLS or setting.materials is None:
            raise ValueError(fault)
        from sim.physics.loss_maxima import loss_maxima  # numpy takes a tenth of a second to import

        rubber = setting.materials.rubber(compound)
        if rubber.glass_c is None:
            raise ValueError(f"{fault}; and its file states no Tg")
        ts_c = rubber.glass_c + GLASS_TO_REFERENCE_K
        of_modulus_hz, of_factor_hz = loss_maxima(rubber.modulus, ts_c)
        if not (of_modulus_hz > 0.0 and of_factor_hz > 0.0):
            raise ValueError(f"{fault}; and the moduli of its file have no maximum of their losses at {ts_c:g} degC")
        return TrackRubber(t_ref=ts_c, loss_modulus=of_modulus_hz, loss_factor=of_factor_hz)

    def friction_of(self, compound: str, setting: laws.LawSetting = laws.NO_SETTING) -> laws.FrictionLaw:
        """Return the law of a rubber for the simulated rig: a slow law as a table.

        Raises ValueError as ``law_of``, and if a slow law is not known over the whole range of the rig.
        """
        maker = laws.find(self.law)
        if not (isinstance(maker, laws.OfMaterials) and maker.slow):
            return self.law_of(compound, setting)
        from sim.physics.tabulated import tabulated  # numpy takes a tenth of a second to import

        own = self._own(setting)
        return tabulated(self.law, compound, laws.NO_FIGURES, own, table_span(own, compound))

    def known_everywhere(self, compound: str, setting: laws.LawSetting = laws.NO_SETTING) -> None:
        """Raise ValueError if a rubber's law cannot be made, OutsideError if the law does not cover the rig's whole
        range."""
        law = self.law_of(compound, setting)
        maker = laws.find(self.law)
        if isinstance(maker, laws.OfMaterials) and maker.slow:
            span = table_span(self._own(setting), compound)
            for speed, temperature_c, load_n in product(span.speeds_m_s, span.temperatures_c, span.loads_n):
                law.mu(temperature_c, load_n, speed)

    def _own(self, setting: laws.LawSetting) -> laws.LawSetting:
        """Return the setting with this rig's area, and its surface if it states one; raises ValueError without one."""
        materials = ReadOnce(setting.materials) if setting.materials is not None else None
        own = laws.LawSetting(materials, self.surface or setting.surface, self.contact.area, setting.tables)
        if self.of_materials and own.materials is not None and not own.surface:
            raise ValueError(f"law {self.law!r} needs a surface (expected the recipe's abrasive, or sim.surface)")
        return own

    def __deepcopy__(self, memo: dict[int, object]) -> TrackParameters:
        """Return itself: it never changes, and copies of a running rig share it."""
        return self


def table_span(setting: laws.LawSetting, compound: str) -> TableSpan:
    """Return the range of a rig's table of a slow law; below the glass transition the law itself is called."""
    glass_c = setting.materials.rubber(compound).glass_c if setting.materials is not None else None
    low_c, high_c = TABLE_C
    return TableSpan(TABLE_M_S, (min(max(low_c, glass_c if glass_c is not None else low_c), 0.0), high_c), TABLE_N)
