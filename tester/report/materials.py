"""The section of a report on what was tested: the files of compounds and surface, as the record holds them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from tester.base.source import InvalidSource
from tester.base.units import show
from tester.base.words import NONE, decimal
from tester.inputs.materials.compound import compound_model
from tester.inputs.materials.schema import CompoundModel, SurfaceModel
from tester.inputs.materials.surface import surface_model
from tester.report.layout import (
    FactSheet,
    Listing,
    Paragraph,
    Part,
    ReportRow,
    ReportSection,
    ReportTable,
    file_name,
    heads,
)
from tester.report.record import RunRecord
from tester.store.records import StoredMaterial


def materials_sections(record: RunRecord, key: str) -> Iterator[ReportSection]:
    """Yield the section; nothing of a run whose materials are names alone."""
    files = record.results.run.info.materials
    if not files:
        return
    parts: list[Part] = []
    compounds = {one.name: model for one in files if (model := _compound(one)) is not None}
    if any(model.formulation for model in compounds.values()):
        parts.append(_formulations(compounds))
    for one in files:
        parts += _told(one, compounds.get(one.name))
    bare = [name for name in dict.fromkeys(row.info.compound for row in record.results.rows) if name not in compounds]
    if bare:
        parts.append(Paragraph(f"Named alone, without a file: {', '.join(bare)}.", "small"))
    yield ReportSection(key, "Materials", parts)


def _compound(one: StoredMaterial) -> CompoundModel | None:
    if one.role != "compound" or one.text is None:
        return None
    try:
        return compound_model(one.text, one.file)
    except InvalidSource:
        return None  # a version that knew other keys wrote it; its hash and source are told all the same


def _surface(one: StoredMaterial) -> SurfaceModel | None:
    if one.role != "surface" or one.text is None:
        return None
    try:
        return surface_model(one.text, one.file)
    except InvalidSource:
        return None


def _formulations(compounds: Mapping[str, CompoundModel]) -> ReportTable:
    told = [(name, model) for name, model in compounds.items() if model.formulation]
    ingredients = dict.fromkeys(one for _, model in told for one in model.formulation)
    rows = [
        ReportRow((one, *(decimal(phr, 1) if (phr := model.formulation.get(one)) is not None else NONE
                          for _, model in told)))
        for one in ingredients
    ]  # fmt: skip
    titles = heads("ingredient", *(name for name, _ in told), text=(0,))
    return ReportTable("Formulations (phr)", titles, rows, "phr: parts by weight per hundred of rubber")


def _told(one: StoredMaterial, compound: CompoundModel | None) -> list[Part]:
    facts = [("source", file_name(one.source)), ("SHA-256", one.sha256)]
    if compound is not None:
        facts = [*_of_compound(compound), *facts]
    surface = _surface(one)
    if surface is not None:
        facts = [("note", surface.note or NONE), ("figures from", surface.source or NONE), *facts]
    parts: list[Part] = [Paragraph(f"{one.role.capitalize()} {one.name}"), FactSheet(facts)]
    if one.doubts:
        parts += [Paragraph("Doubtful in it:", "care"), Listing(one.doubts.splitlines(), "care")]
    return parts


def _of_compound(model: CompoundModel) -> Iterator[tuple[str, str]]:
    yield "note", model.note or NONE
    yield "formulation", "in the table" if model.formulation else "not known"
    yield "glass transition", NONE if model.Tg is None else show(model.Tg, "degC")
    for what, value in (("batch", model.batch), ("figures from", model.source)):
        if value:
            yield what, value
    if model.cure is not None and model.cure.temperature is not None:
        time = f", {show(model.cure.time / 60.0, 'min')}" if model.cure.time is not None else ""
        yield "cure", f"{show(model.cure.temperature, 'degC')}{time}"
    for what, value, unit in (("density", model.density, "kg/m3"), ("hardness", model.hardness, "Shore A")):
        if value is not None:
            yield what, show(value, unit)
