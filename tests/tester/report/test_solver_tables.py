"""Friction tables of a kept law, read back by small parsers written from each program's description."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.inputs.kept_laws.law_value import KeptLaw
from tester.report.solver_tables import SOLVERS, Points, SolverTable, solver_table
from tests.tester.inputs.kept_laws.kept_example import example, example_text

AREA_MM2 = 500.0
Row = tuple[float, float, float, float]
"""Speed, pressure, temperature, coefficient."""

V2 = {
    "form": "v2",
    "constants": {},
    "parameters": {
        "a": {"value": 0.2}, "beta": {"value": 0.002, "unit": "1/K2"}, "tm": {"value": 66.0, "unit": "degC"},
        "k": {"value": -0.35}, "c": {"value": 0.35}, "b2": {"value": 1.1}, "a2": {"value": 0.4, "fitted": False},
    },
    "covariance": [[1e-4 if i == j else 0.0 for j in range(6)] for i in range(6)],
}  # fmt: skip
LAW = KeptLaw(example(**V2), "law.yaml")


def table() -> SolverTable:
    return solver_table(LAW, Points(5, 4, 3), AREA_MM2)


def text_of(solver: str, of: SolverTable) -> list[str]:
    return [*SOLVERS[solver](of)]


def read_abaqus(lines: list[str]) -> Iterator[Row]:
    """Lines after *FRICTION: coefficient, slip rate, pressure, temperature; ** begins a comment."""
    data = [line for line in lines if not line.startswith("**")]
    assert data[0] == "*FRICTION" and all(len(line) < 256 for line in lines)
    for line in data[1:]:
        mu, speed, pressure, temperature = (float(cell) for cell in line.split(","))
        yield speed, pressure, temperature, mu


def read_ansys(lines: list[str]) -> Iterator[Row]:
    """A field keeps its value until the next TBFIELD of its type; TBDATA stores at the present fields."""
    fields: dict[str, float] = {}
    commands = [line.split(",") for line in lines if not line.startswith("!")]
    assert commands[0] == ["TB", "FRIC", "1", "", "", "ISO"]
    for command in commands[1:]:
        if command[0] == "TBFIELD":
            fields[command[1]] = float(command[2])
        else:
            assert command[:2] == ["TBDATA", "1"]
            yield fields["SLRV"], fields["NPRES"], fields["TEMP"], float(command[2])


def read_lsdyna(lines: list[str]) -> Iterator[Row]:
    """Cards of fixed columns: identities in 10, values of tables and curves in 20; $ begins a comment."""
    assert lines[0] == "*KEYWORD" and lines[-1] == "*END" and all(len(line) <= 80 for line in lines)
    curves: dict[int, list[tuple[float, float]]] = {}
    tables: list[tuple[float, list[tuple[float, int]]]] = []
    keyword, identity, temperature = "", 0, 0.0
    for line in lines:
        if (match := re.fullmatch(r"\$ (\S+) degC", line)) is not None:
            temperature = float(match[1])
        if line.startswith("$"):
            continue
        if line.startswith("*"):
            keyword, identity = line, 0
        elif not identity:
            identity = int(line[:10])
            if keyword == "*DEFINE_TABLE":
                tables.append((temperature, []))
            else:
                curves[identity] = []
        elif keyword == "*DEFINE_TABLE":
            tables[-1][1].append((float(line[:20]), int(line[20:40])))
        else:
            curves[identity].append((float(line[:20]), float(line[20:40])))
    for at_c, pressures in tables:
        for pressure, curve in pressures:
            for speed, mu in curves.pop(curve):
                yield speed, pressure, at_c, mu
    (factors,) = curves.values()
    assert [at for at, _ in factors] == [at for at, _ in tables] and factors[0][1] == 1.0


def read_csv(lines: list[str]) -> Iterator[Row]:
    data = [line for line in lines if not line.startswith("#")]
    assert data[0].split(",")[:4] == ["speed_m_s", "pressure_pa", "temperature_c", "mu"]
    for line in data[1:]:
        speed, pressure, temperature, mu, low, high = map(float, line.split(","))
        assert low < mu < high
        yield speed, pressure, temperature, mu


READERS: dict[str, Callable[[list[str]], Iterator[Row]]] = {
    "abaqus": read_abaqus, "ansys": read_ansys, "lsdyna": read_lsdyna, "csv": read_csv,
}  # fmt: skip


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_tables_read_back_as_the_law(solver: str) -> None:
    rows = [*READERS[solver](text_of(solver, table()))]
    assert len(rows) == 5 * 4 * 3
    for speed, pressure, temperature, mu in rows:
        assert mu == pytest.approx(LAW.mu(temperature, 1e-6 * pressure * AREA_MM2, speed), rel=6e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_axes_ascend_from_end_to_end_of_the_range_and_the_speed_varies_first(solver: str) -> None:
    rows = [*READERS[solver](text_of(solver, table()))]
    keys = [(temperature, pressure, speed) for speed, pressure, temperature, _ in rows]
    assert all(before < after for before, after in pairwise(keys))
    assert keys[0] == pytest.approx((25.0, 2e5, 0.1)) and keys[-1] == pytest.approx((85.0, 8e5, 0.4))


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_comments_state_units_area_range_and_cuts(solver: str) -> None:
    notes = " ".join(text_of(solver, table()))
    for said in ("CHECK", "500 mm2", "given", "2024-01-01T00-00-00-mine", "25 to 85 degC", "Cut:"):
        assert said in notes, said


def test_a_range_of_decades_has_speeds_in_equal_ratios_and_a_single_value_one_point() -> None:
    wide = {**LAW.model.range.model_dump(), "speed": ["1e-5 m/s", "0.01 m/s"], "load": ["20 N", "20 N"]}
    ranges = {**wide, "temperature": ["-10 degC", "40 degC"]}
    made = solver_table(KeptLaw(example(**V2, range=ranges), "law.yaml"), Points(4, 4, 2), 100.0)
    assert made.speeds == pytest.approx((1e-5, 1e-4, 1e-3, 1e-2)) and made.pressures == pytest.approx((2e5,))
    assert len([*made.rows()]) == 4 * 1 * 2


def test_a_whole_table_takes_less_than_a_second_of_processor_time() -> None:
    began_s = time.process_time()
    for solver in SOLVERS:
        assert len(text_of(solver, solver_table(LAW, Points(), AREA_MM2))) > 4000
    assert time.process_time() - began_s < 4.0


def test_the_area_is_the_options_else_the_files_else_the_export_is_refused() -> None:
    own = KeptLaw(example(area="250 mm2", area_source="ink"), "law.yaml")
    assert solver_table(own).pressures[0] == pytest.approx(100.0 / 250e-6) and solver_table(own).area_source == "ink"
    assert solver_table(own, area_mm2=500.0).pressures[0] == pytest.approx(2e5)
    with pytest.raises(ValueError, match="knows no area of contact"):
        solver_table(LAW)


def test_the_command_writes_a_file_and_refuses_nonsense(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "law.yaml").write_text(example_text(), encoding="utf-8")
    export = ["export", "law.yaml", "--format"]
    assert invoke([*export, "ansys", "--area", "5 cm2", "--points", "3x3x2", "--out", "f.inp"]) == 0
    rows = [*read_ansys((tmp_path / "f.inp").read_text(encoding="utf-8").splitlines())]
    assert len(rows) == 18 and rows[0][1] == pytest.approx(2e5)
    for arguments, said in (
        ([*export, "ansys"], "knows no area of contact"),
        ([*export, "appendix"], "expected abaqus, ansys, lsdyna, csv"),
        ([*export, "csv", "--area", "5 cm2", "--points", "1x3x2"], "each 2 to 200"),
        (["export", "latest", "--format", "abaqus"], "are for a kept law"),
    ):
        assert invoke(arguments) == 2
        assert said in capsys.readouterr().err
