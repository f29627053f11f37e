"""Schema of a kept law's file: the validated model of the YAML file, written by a fit and read by people and programs.

The hash at its end is over its content, so that a change after the fit shows; comments and layout do not count.
"""

from __future__ import annotations

import json
from hashlib import sha256
from math import sqrt
from typing import Annotated, Final, Literal, TypeAlias

from pydantic import Field, model_validator

from sim.physics import laws
from sim.physics.fitted import FITTED_FIGURES
from tester.base.units import Quantity, as_text
from tester.base.validation import Section

FORMAT: Final = 1
Form: TypeAlias = Literal["v2", "paper", "power", "wlf_bell", "persson", "greta"]
OF_FIGURES: Final = ("v2", "paper", "power", "wlf_bell")
FORMS: Final = (*OF_FIGURES, *FITTED_FIGURES)
"""Laws that are kept. Those of ``FITTED_FIGURES`` are made of a compound's and a surface's file too."""
Name: TypeAlias = Annotated[str, Field(min_length=1, max_length=200)]
Words: TypeAlias = Annotated[str, Field(max_length=2000)]
Hash: TypeAlias = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Row: TypeAlias = Annotated[list[float], Field(max_length=20)]
_SLACK: Final = 1e-9
"""Rounding that a covariance may show."""


class KeptParameter(Section, frozen=True):
    """A parameter of the law."""

    value: float
    unit: Annotated[str, Field(max_length=20)] = ""
    """"" for a ratio"""
    fitted: bool = True
    """false: held at this value"""
    logarithm: bool = False
    """whether the covariance is of its natural logarithm"""


class LawRange(Section, frozen=True):
    """Least and greatest values of the conditions that were fitted."""

    temperature: Annotated[list[Annotated[float, Quantity("degC")]], Field(min_length=2, max_length=2)]
    load: Annotated[list[Annotated[float, Quantity("N", gt=0)]], Field(min_length=2, max_length=2)]
    speed: Annotated[list[Annotated[float, Quantity("m/s", ge=0)]], Field(min_length=2, max_length=2)]
    """of sliding"""

    @model_validator(mode="after")
    def _ascend(self) -> LawRange:
        for name in ("temperature", "load", "speed"):
            low, high = getattr(self, name)
            if high < low:
                raise ValueError(f"{name}: {high:g} is below {low:g} (expected the least value first)")
        return self


class FittedData(Section, frozen=True):
    """A source of the conditions that were fitted."""

    source: Name
    """folder of the run, or a packaged table"""
    table: Name
    rows: Annotated[int, Field(ge=1)]
    sha256: Hash
    """hash of the fitted conditions: label, group, nominal and measured values, coefficient"""


class KeptLawModel(Section, frozen=True):
    """A fitted law of friction of one compound."""

    kept_law: Literal[1]
    """version of this format"""
    form: Form
    formula: Words
    kind: Name
    """kind of rig on which it was measured"""
    compound: Name
    interface: Annotated[str, Field(max_length=40)] = ""
    surface: Annotated[str, Field(max_length=200)] = ""
    parameters: Annotated[dict[Name, KeptParameter], Field(min_length=1, max_length=20)]
    constants: dict[Name, float] = Field(default_factory=dict[str, float])
    """further figures of the formula, in SI units and degC"""
    covariance: Annotated[list[Row], Field(min_length=1, max_length=20)]
    """of the fitted parameters, in their order"""
    scatter: Annotated[float, Quantity("1", ge=0, le=10)]
    """standard deviation of a condition about the law, as a share: what repeats, conditions and a wrong form leave"""
    degrees_of_freedom: Annotated[int, Field(ge=1)]
    describes: Literal["yes", "no", "unknown"]
    """whether the law describes the conditions that were fitted"""
    range: LawRange
    area: Annotated[float, Quantity("mm2", gt=0)] | None = None
    """nominal area of contact: makes a pressure of the load"""
    area_source: Words = ""
    made_of: dict[Literal["compound", "surface"], Hash] = Field(
        default_factory=dict[Literal["compound", "surface"], str]
    )
    """of persson and greta: hashes of the files of compound and surface, with their data"""
    data: Annotated[list[FittedData], Field(min_length=1, max_length=1000)]
    content: Hash
    """hash of all that is above"""

    @property
    def fitted(self) -> tuple[str, ...]:
        """Return the names of the fitted parameters."""
        return tuple(name for name, one in self.parameters.items() if one.fitted)

    def figures(self) -> dict[str, float]:
        """Return the figures of the law (``sim.physics.laws.make``)."""
        return {name: one.value for name, one in self.parameters.items()} | self.constants

    @property
    def of_materials(self) -> bool:
        """Return whether the law is made of a rubber and a surface."""
        return self.form in FITTED_FIGURES

    def hash(self) -> str:
        """Return the hash of the content."""
        # Without the key where it is empty: files of laws of figures alone are older than it.
        content = self.model_dump(exclude={"content"} if self.made_of else {"content", "made_of"})
        return sha256(json.dumps(content, sort_keys=True, ensure_ascii=False).encode()).hexdigest()

    @model_validator(mode="after")
    def _consistent(self) -> KeptLawModel:
        count = len(self.fitted)
        if len(self.covariance) != count or any(len(row) != count for row in self.covariance):
            shape = f"{len(self.covariance)} rows of {', '.join(str(len(row)) for row in self.covariance)} numbers"
            raise ValueError(f"covariance: {shape} (expected {count} by {count}: {', '.join(self.fitted)})")
        for i, row in enumerate(self.covariance):
            for j, value in enumerate(row):
                most = sqrt(max(self.covariance[i][i], 0.0) * max(self.covariance[j][j], 0.0))
                if not abs(value) <= most * (1.0 + _SLACK) or value != self.covariance[j][i]:
                    raise ValueError(f"covariance: row {i + 1}, number {j + 1}: {value:g} (expected a covariance)")
        for name, one in self.parameters.items():
            if one.logarithm and not one.value > 0.0:
                raise ValueError(f"parameters: {name} is {one.value:g} (expected above 0: it has a logarithm)")
        if not self.of_materials:
            laws.make(self.form, self.compound, self.figures())
            return self
        missing = [name for name in FITTED_FIGURES[self.form] if name not in self.parameters]
        given = {"made_of": len(self.made_of) == 2, "surface": bool(self.surface), "area": self.area is not None}
        missing += [name for name, there in given.items() if not there]
        if missing:
            raise ValueError(f"form: {self.form} needs {', '.join(missing)}")
        return self


def law_text(model: KeptLawModel) -> str:
    """Return the law as the text of its file."""
    quote = json.dumps
    lines = [
        f"kept_law: {model.kept_law}",
        f"form: {model.form}",
        f"formula: {quote(model.formula, ensure_ascii=False)}",
        f"kind: {quote(model.kind)}",
        f"compound: {quote(model.compound, ensure_ascii=False)}",
    ]
    lines += [f"interface: {quote(model.interface)}"] if model.interface else []
    lines += [f"surface: {quote(model.surface, ensure_ascii=False)}"] if model.surface else []
    lines.append("parameters:")
    for name, one in model.parameters.items():
        marks = ("" if one.fitted else ", fitted: false") + (", logarithm: true" if one.logarithm else "")
        lines.append(f"  {name}: {{value: {one.value!r}, unit: {quote(one.unit)}{marks}}}")
    if model.constants:
        lines.append("constants: {" + ", ".join(f"{name}: {value!r}" for name, value in model.constants.items()) + "}")
    lines.append("covariance:")
    lines += [f"  - [{', '.join(map(repr, row))}]" for row in model.covariance]
    lines += [
        f"scatter: {model.scatter!r}",
        f"degrees_of_freedom: {model.degrees_of_freedom}",
        f'describes: "{model.describes}"',
        "range:",
        f"  temperature: [{', '.join(as_text(one, 'degC') for one in model.range.temperature)}]",
        f"  load: [{', '.join(as_text(one, 'N') for one in model.range.load)}]",
        f"  speed: [{', '.join(as_text(one, 'm/s') for one in model.range.speed)}]",
    ]
    if model.made_of:
        hashes = ", ".join(f"{name}: {quote(value)}" for name, value in model.made_of.items())
        lines.append(f"made_of: {{{hashes}}}")
    if model.area is not None:
        lines += [f"area: {as_text(model.area, 'mm2')}", f"area_source: {quote(model.area_source, ensure_ascii=False)}"]
    lines.append("data:")
    for data in model.data:
        at = f"source: {quote(data.source, ensure_ascii=False)}, table: {quote(data.table)}, rows: {data.rows}"
        lines.append(f"  - {{{at}, sha256: {quote(data.sha256)}}}")
    lines.append(f'content: "{model.content}"')
    return "\n".join(lines) + "\n"
