"""The section of a report on the tested materials: the files of compounds and surface in the record."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TypeVar

from tester.base.source import InvalidSource
from tester.base.units import show
from tester.base.words import NONE, decimal
from tester.inputs.materials.compound import compound_model
from tester.inputs.materials.material_schema import CompoundModel
from tester.inputs.materials.surface_file import surface_model
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
from tester.report.record_section import RunRecord
from tester.results.hardness_read import hardness_lines
from tester.store.records import StoredMaterial

Model = TypeVar("Model")


def materials_sections(record: RunRecord, key: str) -> Iterator[ReportSection]:
    """Yield the section; nothing for a run whose materials are names alone."""
    files = record.results.run.info.materials
    if not files:
        return
    parts: list[Part] = []
    compounds = {file.name: model for file in files if (model := _model(file, "compound", compound_model)) is not None}
    if any(model.formulation for model in compounds.values()):
        parts.append(_formulations(compounds))
    for material in files:
        parts += _described(material, compounds.get(material.name), hardness_lines(record.results, material.name))
    bare = [name for name in dict.fromkeys(row.info.compound for row in record.results.rows) if name not in compounds]
    if bare:
        parts.append(Paragraph(f"Named alone, without a file: {', '.join(bare)}.", "small"))
    yield ReportSection(key, "Materials", parts)


def _model(stored: StoredMaterial, role: str, read: Callable[[str, str], Model]) -> Model | None:
    """Return the file of a material of this role; None for another role, or a file of a version with other keys."""
    if stored.role != role or stored.text is None:
        return None
    try:
        return read(stored.text, stored.file)
    except InvalidSource:
        return None  # its hash and source are reported all the same


def _formulations(compounds: Mapping[str, CompoundModel]) -> ReportTable:
    known = [(name, model) for name, model in compounds.items() if model.formulation]
    ingredients = dict.fromkeys(ingredient_name for _, model in known for ingredient_name in model.formulation)
    rows = [
        ReportRow((ingredient, *(decimal(phr, 1) if (phr := model.formulation.get(ingredient)) is not None else NONE
                          for _, model in known)))
        for ingredient in ingredients
    ]  # fmt: skip
    titles = heads("ingredient", *(name for name, _ in known), text=(0,))
    return ReportTable("Formulations (phr)", titles, rows, "phr: parts by weight per hundred of rubber")


def _described(
    stored_material: StoredMaterial, compound: CompoundModel | None, read: Iterable[str]
) -> list[Part]:
    facts = [("source", file_name(stored_material.source)), ("SHA-256", stored_material.sha256)]
    if compound is not None:
        facts = [*_of_compound(compound), *(("hardness read", line) for line in read), *facts]
    surface = _model(stored_material, "surface", surface_model)
    if surface is not None:
        facts = [("note", surface.note or NONE), ("figures from", surface.source or NONE), *facts]
    parts: list[Part] = [Paragraph(f"{stored_material.role.capitalize()} {stored_material.name}"), FactSheet(facts)]
    if stored_material.doubts:
        parts += [Paragraph("Doubtful in it:", "care"), Listing(stored_material.doubts.splitlines(), "care")]
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
