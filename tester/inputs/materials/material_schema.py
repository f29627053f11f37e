"""Schema of the compounds' and surfaces' files: the validated models of the YAML files.

Every quantity is a text with a unit in the file and a float here, in the unit of the annotation. The JSON Schemas for
editors are generated from these classes.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import exp
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import BaseModel, Field, model_validator

from tester.base.units import SHORE_A, Quantity
from tester.base.validation import Section
from tester.inputs.materials.stated_law import LawModel

Text: TypeAlias = Annotated[str, Field(min_length=1, max_length=200)]
Note: TypeAlias = Annotated[str, Field(min_length=1, max_length=2000)]
Phr: TypeAlias = Annotated[float, Quantity("1", ge=0, le=1000)]
Modulus: TypeAlias = Annotated[float, Quantity("Pa", gt=0, le=1e12)]
Celsius: TypeAlias = Annotated[float, Quantity("degC", ge=-200, le=400)]
Length: TypeAlias = Annotated[float, Quantity("m", gt=0, le=1)]
WaveNumber: TypeAlias = Annotated[float, Quantity("1/m", gt=0, le=1e11)]
Cells: TypeAlias = Annotated[list[float | int], Field(min_length=1, max_length=20)]
Headings: TypeAlias = Annotated[list[Text], Field(min_length=2, max_length=20)]
MAX_ROWS = 20_000

LEAST_WAVES = 1.01
"""q1 over q0, at least: a narrower band is a line, not a spectrum."""


class MaterialModel(Section, frozen=True):
    """The keys of every material's file."""

    name: Text
    """as recipes name it; the file may have another name"""
    note: Note | None = None
    source: Note | None = None
    """source of the figures; [A] for an assumption"""
    sources: dict[Text, Note] = Field(default_factory=dict[str, str])
    """source of single figures, by key; a section's key covers the section"""
    doubts: Annotated[list[Note], Field(max_length=100)] = Field(default_factory=list[str])
    """doubts that an import or a person has noted; listed wherever the material is used"""

    @model_validator(mode="after")
    def _of_given_keys(self) -> Self:
        unknown = [name for name in self.sources if name not in {*given_keys(self)}]
        if unknown:
            raise ValueError(f"sources: {', '.join(unknown)} is no key of this file (expected keys that it holds)")
        return self


def given_keys(model: BaseModel) -> Iterator[str]:
    """Yield the keys that a file holds, and those of its sections."""
    for name in model.model_fields_set:
        yield name
        value = getattr(model, name)
        if isinstance(value, BaseModel):
            yield from given_keys(value)


class CureModel(Section, frozen=True):
    """Its vulcanisation."""

    temperature: Celsius | None = None
    time: Annotated[float, Quantity("s", gt=0)] | None = None


class TableModel(Section, frozen=True):
    """Measured moduli, in the file itself."""

    columns: Headings
    """names with units, such as [temperature degC, frequency Hz, E' MPa, E'' MPa]"""
    rows: Annotated[list[Cells], Field(max_length=MAX_ROWS)]
    """a list of numbers for each point, in the order of the columns"""


class TableFileModel(Section, frozen=True):
    """Measured moduli in a separate file: a table beside the compound's file."""

    name: Text
    """the file, relative to this one"""
    columns: dict[Text, Text] = Field(default_factory=dict[str, str])
    """headings that are not recognised, by quantity, such as {"E'": "Modulus 1"}"""
    units: dict[Text, Text] = Field(default_factory=dict[str, str])
    """units of headings without one, such as {"Storage Modulus": MPa}"""
    frequency: Annotated[float, Quantity("Hz", gt=0)] | None = None
    """of every point, if the file has no such column"""
    temperature: Celsius | None = None
    """of every point, if the file has no such column"""


class ZenerModel(Section, frozen=True):
    """G = Gr + (Gg - Gr) z / (1 + z), z = (i omega tau aT)^b: a rubber as a formula."""

    Gr: Modulus
    """shear modulus of the rubber"""
    Gg: Modulus
    """shear modulus of the glass"""
    tau: Annotated[float, Quantity("s", gt=0)]
    """relaxation time at the temperature `at`"""
    at: Celsius
    """temperature at which tau holds"""
    b: Annotated[float, Quantity("1", gt=0, le=1)]
    Ts: Celsius
    """reference temperature of the WLF shift, Tg + 50 K"""

    @model_validator(mode="after")
    def _in_order(self) -> ZenerModel:
        if self.Gg <= self.Gr:
            raise ValueError(f"Gg, {self.Gg:g} Pa, is not above Gr, {self.Gr:g} Pa: the glass is stiffer")
        return self


class ConstantModel(Section, frozen=True):
    """One complex shear modulus at every frequency and temperature: for comparison, no rubber is like that."""

    G: Modulus
    """its real part"""
    loss_factor: Annotated[float, Quantity("1", ge=0, le=10)] = 0.0
    """tan delta, G'' over G'"""


class ModuliModel(Section, frozen=True):
    """The complex modulus in small strain; exactly one of these."""

    table: TableModel | None = None
    file: TableFileModel | None = None
    fractional_zener: ZenerModel | None = None
    constant: ConstantModel | None = None
    strain: Annotated[float, Quantity("%", gt=0, le=100)] | None = None
    """amplitude of the strain at which the points were measured, if they have no column of it"""
    beyond: Literal["refuse", "hold"] = "refuse"
    """at frequencies beyond a table: no value, or that of its end"""

    @model_validator(mode="after")
    def _one(self) -> ModuliModel:
        ways = ("table", "file", "fractional_zener", "constant")
        given_keys = [name for name in ways if getattr(self, name) is not None]
        if len(given_keys) != 1:
            raise ValueError(
                f"{' and '.join(given_keys) or 'nothing'} is given (expected exactly one of {', '.join(ways)})"
            )
        return self


class ShearModel(Section, frozen=True):
    """Shear strength of a contact of clean rubber: tau_s0 [1 + ratio / (1 + v_c / v)^n]."""

    tau_s0: Annotated[float, Quantity("Pa", gt=0)]
    """shear strength at the slowest sliding"""
    v_c: Annotated[float, Quantity("m/s", gt=0)]
    n: Annotated[float, Quantity("1", gt=0, le=10)]
    ratio: Annotated[float, Quantity("1", ge=0, le=1e6)]
    """modulus of the glass over that of the rubber"""


class OverTemperatureModel(Section, frozen=True):
    """Its coefficient over temperature: in proportion to alpha exp(-beta (T - Tm)^2) + gamma."""

    alpha: Annotated[float, Quantity("1", ge=-100, le=100)]
    beta: Annotated[float, Quantity("1/K2", gt=0, le=1)]
    gamma: Annotated[float, Quantity("1", gt=0, le=100)]
    Tm: Celsius
    """temperature of the maximum; of the minimum if alpha is below 0"""
    least: Celsius
    """lowest temperature at which it was measured"""
    most: Celsius
    """highest temperature at which it was measured"""
    source: Note | None = None
    """source of the figures"""

    @model_validator(mode="after")
    def _sense(self) -> OverTemperatureModel:
        if self.most <= self.least:
            raise ValueError(f"most, {self.most:g} degC, is not above least, {self.least:g} degC")
        if self.alpha + self.gamma <= 0.0:
            raise ValueError(f"alpha + gamma is {self.alpha + self.gamma:g} (expected more than 0: a coefficient is)")
        return self

    def per_kelvin(self, at_c: float) -> float:
        """Return d ln(mu) / dT at a temperature in degC, 1/K."""
        off_k = at_c - self.Tm
        bell = self.alpha * exp(-self.beta * off_k * off_k)
        return -2.0 * self.beta * off_k * bell / (bell + self.gamma)


class CompoundModel(MaterialModel, frozen=True):
    """A rubber compound: its formulation and its properties."""

    formulation: dict[Text, Phr] = Field(default_factory=dict[str, float])
    """parts per hundred of rubber (phr), by ingredient"""
    batch: Text | None = None
    cure: CureModel | None = None
    density: Annotated[float, Quantity("kg/m3", ge=500, le=5000)] | None = None
    hardness: Annotated[float, Quantity(SHORE_A, True, ge=0, le=100)] | None = None
    """Shore A"""
    hardness_tolerance: Annotated[float, Quantity(SHORE_A, True, gt=0, le=100)] | None = None
    """Shore A: a hardness further off is a doubt (default 3)"""
    Tg: Celsius | None = None
    """glass transition"""
    poisson: Annotated[float, Quantity("1", ge=0.3, le=0.5)] = 0.5
    decade_k: Annotated[float, Quantity("K", gt=0, le=50, bare=True)] | None = None
    """kelvin equivalent to a decade of frequency, for a sweep at one frequency (default 8)"""
    moduli: ModuliModel | None = None
    shear: ShearModel | None = None
    over_temperature: OverTemperatureModel | None = None
    """its coefficient on an abrasive over temperature, from a fit or a publication"""
    law: LawModel | None = None
    """its law of friction on a simulated wheel, which knows only the paper's compounds by name"""


class PowerLawModel(Section, frozen=True):
    """A self-affine surface: C(q) = C0 (q / q0)^(-2 (1 + H)) from q0 to q1."""

    C0: Annotated[float, Quantity("m4", gt=0)]
    q0: WaveNumber
    q1: WaveNumber
    H: Annotated[float, Quantity("1", ge=0, le=1)]
    """Hurst exponent"""

    @model_validator(mode="after")
    def _in_order(self) -> PowerLawModel:
        if self.q1 < LEAST_WAVES * self.q0:
            raise ValueError(
                f"q1, {self.q1:g} 1/m, is not above q0, {self.q0:g} 1/m: waves go from long (q0) to short (q1)"
            )
        return self


class WaveModel(Section, frozen=True):
    """A wave: its length, and its arithmetic mean roughness."""

    wavelength: Length
    Ra: Length

    @model_validator(mode="after")
    def _flat(self) -> WaveModel:
        if self.wavelength <= self.Ra:
            raise ValueError(f"Ra, {self.Ra:g} m, is not below wavelength, {self.wavelength:g} m: are they swapped?")
        return self


class WavesModel(Section, frozen=True):
    """Two waves, as of a road: its stones, and the texture on them."""

    coarse: WaveModel
    fine: WaveModel

    @model_validator(mode="after")
    def _in_order(self) -> WavesModel:
        if self.fine.wavelength >= self.coarse.wavelength:
            raise ValueError("fine is not finer than coarse: its wavelength is as long or longer (are they swapped?)")
        return self


class ScanModel(Section, frozen=True):
    """Heights written by an instrument, in a file beside this one."""

    file: Text
    """the file, relative to this one: a matrix of heights as text, or a format of instruments (extra `topography`)"""
    pixel: Length | None = None
    """distance from point to point, if the file does not state it"""
    unit: Literal["nm", "um", "mm", "m"] | None = None
    """of the heights, if the file does not state it"""
    detrend: Literal["mean", "plane"] = "plane"
    """subtracted before anything else"""


class RadialModel(Section, frozen=True):
    """A spectrum as a table: C at rising wave numbers."""

    columns: Literal["q 1/m, C m4"] = "q 1/m, C m4"
    rows: Annotated[list[Annotated[list[float | int], Field(min_length=2, max_length=2)]], Field(max_length=5000)]


class SurfaceModel(MaterialModel, frozen=True):
    """The surface that rubber slides on: a spectrum of heights, two waves, or both. Recipes name it as `abrasive`."""

    spectrum: PowerLawModel | None = None
    radial: RadialModel | None = None
    scan: ScanModel | None = None
    waves: WavesModel | None = None

    @model_validator(mode="after")
    def _one(self) -> SurfaceModel:
        given_keys = [name for name in ("spectrum", "radial", "scan") if getattr(self, name) is not None]
        if len(given_keys) > 1:
            raise ValueError(f"{' and '.join(given_keys)} are given (expected at most one of spectrum, radial, scan)")
        if not given_keys and self.waves is None:
            raise ValueError("nothing is given of its heights (expected one of spectrum, radial, scan, waves)")
        return self
