"""A compound's file: read with every problem at its line, and every doubt."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import starmap
from pathlib import Path

from tester.base.source import InvalidSource, Tree
from tester.base.units import shown
from tester.inputs.materials.dma import MAX_BYTES, read_dma
from tester.inputs.materials.files import DataFile, Findings, MaterialFile, OpenedMaterial, decoded
from tester.inputs.materials.headings import (
    QUANTITIES,
    DmaOptions,
    conversion,
    heading,
    heading_problems,
    quantity_named,
)
from tester.inputs.materials.material_schema import CompoundModel, TableFileModel, TableModel
from tester.inputs.materials.measured_moduli import ModuliRow, ModuliTable, judge, shift_doubts, strain_doubts

EXPECTED = "a compound is a list of keys: name, formulation, Tg, moduli and others"
_ROW = ("temperature", "frequency", "E'", 'E"', "strain")
FORMULATED_PHR = (90.0, 500.0)
"""Limits of the sum of a formulation [A]: the rubber alone is 100."""


@dataclass(frozen=True, slots=True)
class LoadedCompound:
    """A compound with its file; ``table`` where its moduli were measured."""

    model: CompoundModel
    file: MaterialFile
    table: ModuliTable | None = None
    notes: tuple[str, ...] = ()
    """Conversions and assumptions in reading the file of moduli."""

    def holds(self) -> str:
        """Return the source of its modulus, in words."""
        moduli = self.model.moduli
        if moduli is None:
            return "no moduli"
        if moduli.fractional_zener is not None:
            z = moduli.fractional_zener
            span = f"G {z.Gr / 1e6:g} to {z.Gg / 1e6:g} MPa"
            return f"fractional Zener, {span}, tau {z.tau:g} s at {z.at:g} degC, b {z.b:g}"
        if moduli.constant is not None:
            return f"constant, G {moduli.constant.G / 1e6:g} MPa, tan delta {moduli.constant.loss_factor:g}"
        assert self.table is not None
        return f"measured, {self.table.describe()}"


def load_compound(path: Path, name: str | None = None) -> LoadedCompound:
    """Read a compound's file; ``name`` names it in messages. Raises InvalidSource with every problem."""
    opened = OpenedMaterial(path, name, CompoundModel, EXPECTED)
    model, tree, findings = opened.model, opened.tree, opened.findings
    data: DataFile | None = None
    table: ModuliTable | None = None
    if model is not None and model.moduli is not None and model.moduli.table is not None:
        table = _inline(model.moduli.table, tree, findings)
    elif model is not None and model.moduli is not None and model.moduli.file is not None:
        _unknown_quantities(model.moduli.file, tree, findings)
        data = opened.data_file(path, ("moduli", "file", "name"), model.moduli.file.name, MAX_BYTES)
        if data is not None and not findings.problems:
            table = _beside(model, model.moduli.file, data, path, findings)
    model = opened.content()
    if table is not None and model.moduli is not None and model.moduli.strain is not None:
        table = table.at_strain(model.moduli.strain)
    for doubt in _doubts(model, table):
        findings.doubt(tree.key_position(("moduli",)), doubt)
    _formulation(model, tree, findings)
    file = opened.kept("compound", path, (data,) if data is not None else ())
    return LoadedCompound(model, file, table, tuple(findings.notes))


def compound_model(text: str, name: str) -> CompoundModel:
    """Return the content of a compound's file, without the files that it refers to. Raises InvalidSource."""
    return OpenedMaterial(text, name, CompoundModel, EXPECTED).content()


def _inline(model: TableModel, tree: Tree, findings: Findings) -> ModuliTable | None:
    """Return the moduli of a table in the file itself."""
    at = ("moduli", "table")
    wrong = [*heading_problems(model.columns)]
    for problem in wrong:
        findings.refuse(tree.position((*at, "columns")), f"columns: {problem}")
    columns = [] if wrong else [*map(heading, model.columns)]
    names = {column.quantity for column in columns}
    due = {"temperature", "frequency", "E'", 'E"'}
    if not wrong and names not in (due, due | {"strain"}):
        headings = ", ".join(model.columns)
        expected = "temperature, frequency, E' and E'', each once, and strain"
        problem_words = f"columns: {shown(headings)} (expected {expected}; "
        findings.refuse(
            tree.position((*at, "columns")), f"{problem_words}`tester materials import dma` converts others)"
        )
        return None
    for number, row in enumerate(model.rows):
        if len(row) != len(model.columns):
            problem_words = f"rows: {len(row)} numbers (expected {len(model.columns)}, one for each of columns)"
            findings.refuse(tree.position((*at, "rows", number)), problem_words)
    if findings.problems:
        return None
    turn = [conversion(column.quantity, column.unit) for column in columns]
    order = [[column.quantity for column in columns].index(name) for name in _ROW if name in names]
    values = [[change(float(cell)) for change, cell in zip(turn, row, strict=True)] for row in model.rows]
    rows = [*starmap(ModuliRow, ([value[index] for index in order] for value in values))]
    judge(rows, lambda number: tree.position((*at, "rows", number)), findings)
    return ModuliTable(tuple(rows))


def _unknown_quantities(link: TableFileModel, tree: Tree, findings: Findings) -> None:
    for name in link.columns:
        if not quantity_named(name):
            place = tree.key_position(("moduli", "file", "columns", name))
            known = ", ".join(QUANTITIES)
            findings.refuse(
                place, f"columns: {shown(name)} is no quantity of a table of moduli (expected one of {known})"
            )


def _beside(
    model: CompoundModel, link: TableFileModel, data: DataFile, path: Path, findings: Findings
) -> ModuliTable | None:
    """Return the moduli of a file beside the compound's; its problems are reported at its own lines."""
    options = DmaOptions(
        {quantity_named(name): text for name, text in link.columns.items()},
        link.units,
        link.frequency,
        link.temperature,
        model.poisson,
        model.moduli.strain if model.moduli is not None else None,
        ask_column='columns: {{"{quantity}": HEADING}}',
        ask_unit='units: {{"{heading}": {unit}}}',
        ask_value="{quantity}: {example}",
    )
    inner = Findings(str(Path(findings.file).parent / link.name) if path.parent != Path() else link.name)
    try:
        table = read_dma(decoded(data.content), options, inner)
    except InvalidSource as error:
        findings.problems += error.problems
        return None
    findings.take(inner)
    return table


def _doubts(model: CompoundModel, table: ModuliTable | None) -> list[str]:
    moduli = model.moduli
    if moduli is None:
        return []
    doubts: list[str] = []
    if table is not None:
        doubts += shift_doubts(table, model.Tg, model.decade_k)
        doubts += strain_doubts(table)
        if moduli.beyond == "hold":
            doubts.append("beyond the frequencies of its points the moduli of its ends hold on: an extrapolation")
    zener = moduli.fractional_zener
    if zener is not None and model.Tg is not None and abs(zener.Ts - model.Tg - 50.0) > 0.5:
        doubts.append(f"Ts, {zener.Ts:g} degC, is not Tg + 50 K, {model.Tg + 50.0:g} degC")
    if moduli.constant is not None:
        doubts.append("a constant modulus is no rubber's: speed and temperature change nothing")
    return doubts


def _formulation(model: CompoundModel, tree: Tree, findings: Findings) -> None:
    total = sum(model.formulation.values())
    low, high = FORMULATED_PHR
    if model.formulation and not low <= total <= high:
        summary = f"formulation adds up to {total:g} phr (expected {low:g} to {high:g}): the rubber alone is 100"
        findings.doubt(tree.key_position(("formulation",)), summary)
