"""`tester fit -o`: a fit as the file of a kept law."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

import click

from tester.base.source import MAX_BYTES
from tester.base.trouble import in_words

if TYPE_CHECKING:
    from tester.analysis.fit.fit_law import FitPoint
    from tester.analysis.fit.fit_part import FitPart, MadeOf
    from tester.analysis.fit.joint import GroupFit
    from tester.inputs.kept_laws.law_schema import FittedData, KeptLawModel, LawRange

GIVEN: Final = "given to the fit (--area)"
GIVEN_THERE: Final = "of the fit (--given area)"


class Given(NamedTuple):
    """What a fit of a law of materials was given: a surface, "" for the runs' own, and figures."""

    surface: str = ""
    figures: Mapping[str, float] = MappingProxyType({})


NOTHING_GIVEN: Final = Given()


def keep(
    out: Path,
    fits: Sequence[GroupFit],
    kind: str,
    part: FitPart,
    area_mm2: float | None,
    force: bool,
    given: Given = NOTHING_GIVEN,
) -> None:
    """Write each fit into a file, whose name is printed; of several, each name gets the group's name added.

    Raises FitError for a law that is not kept, UsageError for a file that is there or cannot be written.
    """
    from tester.inputs.kept_laws.law_schema import law_text

    texts = {_path(out, fit, len(fits)): law_text(kept_model(fit, kind, part, area_mm2, given)) for fit in fits}
    if len(texts) < len(fits):
        listed = ", ".join(one.group for one in fits)
        raise click.UsageError(f"--out: the files of {listed} would have the same name")
    for path, text in texts.items():
        if len(text.encode()) > MAX_BYTES:
            raise click.UsageError(f"{path} would be larger than {MAX_BYTES // 1024} kB")
        try:
            with path.open("w" if force else "x", encoding="utf-8", newline="\n") as stream:
                stream.write(text)
        except FileExistsError as error:
            raise click.UsageError(f"{path} exists already (expected another name, or --force)") from error
        except OSError as error:
            raise click.UsageError(f"{path} cannot be written: {in_words(error)}") from error
        click.echo(f"kept: {path}", err=True)


def _path(out: Path, fit: GroupFit, count: int) -> Path:
    if count == 1:
        return out
    name = re.sub(r"[^A-Za-z0-9]+", "-", fit.group).strip("-") or "law"
    return out.with_name(f"{out.stem}-{name}{out.suffix}")


def kept_model(
    fit: GroupFit, kind: str, part: FitPart, area_mm2: float | None = None, given: Given = NOTHING_GIVEN
) -> KeptLawModel:
    """Return a fit as the content of a file; raises FitError."""
    from tester.analysis.fit.fit_law import FitError
    from tester.inputs.kept_laws.law_schema import FORMAT, FORMS, KeptLawModel, KeptParameter

    law, subject = fit.law, part.subject(fit.group)
    if law.name not in FORMS:
        raise FitError(f"the law {law.name} is not kept (expected one of {', '.join(FORMS)})")
    made = part.made_of(law, fit.group, given.surface, given.figures)
    if made is not None and area_mm2 is not None:
        raise FitError(f"--area: the law {law.name} has its area from the fit (expected --given area=MM2 there)")
    area_mm2 = area_mm2 if made is None else made.area_mm2
    fitted = [i for i, parameter in enumerate(law.parameters) if parameter.name not in fit.held]
    parameters = {
        one.name: KeptParameter(
            value=value, unit=one.unit, fitted=i in fitted, logarithm=one.positive and i in fitted
        )
        for i, (one, value) in enumerate(zip(law.parameters, fit.parameters, strict=True))
    }  # fmt: skip
    shown = {True: "no", False: "yes", None: "unknown"}
    model = KeptLawModel.model_construct(
        kept_law=FORMAT, form=law.name, formula=law.formula, kind=kind, compound=subject.compound,
        interface=subject.interface, surface=subject.surface if made is None else made.surface, parameters=parameters,
        constants=dict(law.constants) if made is None else dict(made.figures),
        covariance=[[float(value) for value in row] for row in fit.covariance], scatter=fit.lack.residual,
        degrees_of_freedom=len(fit.points) - len(fitted), describes=shown[fit.lack.shown], range=_range(fit),
        area=area_mm2, area_source=_area_source(made, area_mm2),
        made_of={} if made is None else dict(made.hashes), data=_data(fit.points), content="0" * 64,
    )  # fmt: skip
    return model.model_copy(update={"content": model.hash()})


def _area_source(made: MadeOf | None, area_mm2: float | None) -> str:
    if made is not None:
        return GIVEN_THERE
    return GIVEN if area_mm2 is not None else ""


def _range(fit: GroupFit) -> LawRange:
    """Return the range of the conditions: nominal and measured values."""
    from tester.inputs.kept_laws.law_schema import LawRange

    ends: dict[str, list[float]] = {}
    for i, variable in enumerate(fit.law.variables):
        values = [value for point in fit.points for value in (point.nominal[i], point.measured[i])]
        ends["speed" if variable.name == "slip" else variable.name] = [min(values), max(values)]
    return LawRange.model_construct(None, **ends)


def _data(points: Iterable[FitPoint]) -> list[FittedData]:
    """Return the sources of the conditions, with a hash of each."""
    from tester.inputs.kept_laws.law_schema import FittedData

    by_source: dict[str, list[FitPoint]] = {}
    for point in points:
        by_source.setdefault(point.source.name, []).append(point)
    return [
        FittedData(source=name, table="conditions", rows=len(own), sha256=data_hash(own))
        for name, own in by_source.items()
    ]


def data_hash(points: Iterable[FitPoint]) -> str:
    """Return the hash of fitted conditions: label, group, nominal and measured values, coefficient."""
    lines = [repr((one.label, one.group, one.nominal, one.measured, one.value)) for one in points]
    return sha256("\n".join(lines).encode()).hexdigest()
