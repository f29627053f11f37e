"""Files of compounds: every problem at its line and column, every doubt kept."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tester.base.source import InvalidSource
from tester.inputs.materials.compound import LoadedCompound, load_compound
from tester.inputs.materials.surface_file import load_surface

ROWS = "".join(f"      - [{-60 + 5 * i}, 1, {2000 / (i + 1):.3f}, {200 / (i + 1):.3f}]\n" for i in range(20))
COLUMNS = "columns: [temperature degC, frequency Hz, E' MPa, E'' MPa]"
TABLE = f"moduli:\n  strain: 0.1 %\n  table:\n    {COLUMNS}\n    rows:\n{ROWS}"
FULL = f"""\
name: tread A
note: of the laboratory
formulation: {{NR: 60, BR: 40, N234: 50, oil: 8.5, sulphur: 1.6}}
batch: 2024-7
cure: {{temperature: 160 degC, time: 15 min}}
density: 1120 kg/m3
hardness: 64
Tg: -53 degC
poisson: 0.49
decade_k: 8
shear: {{tau_s0: 12 kPa, v_c: 1 m/s, n: 0.6, ratio: 285.7}}
{TABLE}"""


def loaded(folder: Path, text: str) -> LoadedCompound:
    (folder / "c.yaml").write_text(text, encoding="utf-8")
    return load_compound(folder / "c.yaml", "c.yaml")


def refused(folder: Path, text: str) -> list[str]:
    with pytest.raises(InvalidSource) as raised:
        loaded(folder, text)
    return [str(problem) for problem in raised.value.problems]


def doubts(folder: Path, text: str) -> list[str]:
    return [str(doubt) for doubt in loaded(folder, text).file.doubts]


def test_a_whole_compound_arrives_in_si(tmp_path: Path) -> None:
    one = loaded(tmp_path, FULL)
    m = one.model
    assert (m.name, m.formulation["oil"], m.batch, m.density, m.hardness) == ("tread A", 8.5, "2024-7", 1120.0, 64.0)
    assert m.cure is not None and (m.cure.temperature, m.cure.time) == (160.0, 900.0)
    assert (m.Tg, m.poisson, m.decade_k) == (-53.0, 0.49, 8.0)
    assert m.shear is not None and (m.shear.tau_s0, m.shear.v_c) == (12e3, 1.0)
    assert one.table is not None and one.table.rows[0].storage_pa == 2e9
    assert one.file.doubts == ()


def test_a_name_is_enough(tmp_path: Path) -> None:
    one = loaded(tmp_path, 'name: "9#"\n')
    assert (one.model.name, one.holds(), one.file.doubts) == ("9#", "no moduli", ())


def test_every_problem_is_reported_at_once_with_its_place(tmp_path: Path) -> None:
    text = FULL.replace("hardness: 64", "hardnes: 64").replace("1120 kg/m3", "1.12").replace("-53 degC", "-53 K")
    problems = refused(tmp_path, text)
    assert [one.split(": ", 1)[0] for one in problems] == ["c.yaml:6:10", "c.yaml:7:1", "c.yaml:8:5"]
    assert "has no unit (expected a density" in problems[0]
    assert 'unknown key "hardnes", did you mean hardness?' in problems[1]
    assert "temperature differences" in problems[2]


def test_a_name_is_missing(tmp_path: Path) -> None:
    (problem,) = refused(tmp_path, "Tg: -53 degC\n")
    assert "name is missing" in problem


@pytest.mark.parametrize(
    ("moduli", "message"),
    [
        ("{}", "nothing is given (expected exactly one of table, file, fractional_zener, constant)"),
        (
            "{constant: {G: 1 MPa}, fractional_zener: {Gr: 1 Pa, Gg: 1 GPa, tau: 1 s, at: 0 degC, b: 0.5, Ts: 0 degC}}",
            "fractional_zener and constant is given",
        ),
        (
            "{fractional_zener: {Gr: 1 GPa, Gg: 1 MPa, tau: 1 s, at: 0 degC, b: 0.5, Ts: 0 degC}}",
            "is not above Gr",
        ),
        ("{constant: {G: -1 MPa}}", "-1e+06 Pa is too small (expected more than 0 Pa)"),
        ("{file: {name: ../dma.csv}}", '"../dma.csv" is not beside this file'),
        ("{file: {name: dma.csv}}", 'there is no file "dma.csv" beside this one'),
        ("{file: {name: dma.csv, columns: {Q: x}}}", '"Q" is no quantity of a table of moduli'),
    ],
)
def test_moduli_that_cannot_be_are_refused(tmp_path: Path, moduli: str, message: str) -> None:
    problems = refused(tmp_path, f"name: x\nmoduli: {moduli}\n")
    assert any(message in one and one.startswith("c.yaml:2:") for one in problems), problems


def test_rows_are_judged_at_their_lines(tmp_path: Path) -> None:
    text = FULL.replace("[-50, 1, 666.667, 66.667]", "[-50, 1, -666.667, 66.667]")
    (problem,) = refused(tmp_path, text)
    line = text.splitlines().index("      - [-50, 1, -666.667, 66.667]") + 1
    assert problem == f"c.yaml:{line}:9: E': -6.66667e+08 Pa is not above 0"


def test_a_row_of_another_length_is_refused(tmp_path: Path) -> None:
    (problem,) = refused(tmp_path, FULL.replace("[-50, 1, 666.667, 66.667]", "[-50, 1, 666.667]"))
    assert "rows: 3 numbers (expected 4, one for each of columns)" in problem


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ("temperature degC, frequency Hz, E', E'' MPa", '"E\'" has no unit (expected Pa, kPa, MPa or GPa'),
        ("temperature, frequency Hz, E' MPa, E'' MPa", '"temperature" has no unit (expected degC or K'),
        ("temperature degC, frequency Hz, E' MPa, E' MPa", "E' is there twice"),
        ("temperature degC, frequency Hz, E' MPa, tan", "expected temperature, frequency, E' and E'', each once"),
        ("temperature degC, colour Hz, E' MPa, E'' MPa", '"colour Hz" is no heading'),
    ],
)
def test_incomplete_columns_are_refused(tmp_path: Path, columns: str, message: str) -> None:
    text = FULL.replace("temperature degC, frequency Hz, E' MPa, E'' MPa", columns)
    assert any(message in one for one in refused(tmp_path, text))


def test_columns_may_stand_in_any_order(tmp_path: Path) -> None:
    text = FULL.replace("temperature degC, frequency Hz, E' MPa, E'' MPa", "temperature degC, E'' kPa, E' kPa, f Hz")
    text = text.replace(ROWS, "".join(f"      - [{-60 + 5 * i}, {100 - i}, {1000 - 10 * i}, 1]\n" for i in range(20)))
    one = loaded(tmp_path, text)
    assert one.table is not None
    first = one.table.rows[0]
    assert (first.frequency_hz, first.storage_pa, first.loss_pa) == (1.0, 1e6, 1e5)


def test_a_file_beside_is_read_and_kept_with_its_hash(tmp_path: Path) -> None:
    lines = "".join(f"{-60 + 5 * i};1;{2000 / (i + 1)};{200 / (i + 1)}\n" for i in range(20))
    (tmp_path / "dma.csv").write_text(f"T [degC];f [Hz];E' [MPa];E'' [MPa]\n{lines}", encoding="utf-8")
    one = loaded(tmp_path, "name: x\ndecade_k: 8\nmoduli: {file: {name: dma.csv}}\n")
    assert one.table is not None and one.table.rows[1].storage_pa == 1e9
    (data,) = one.file.data
    assert data.name == "dma.csv" and len(data.sha256) == 64


def test_problems_of_a_file_beside_are_reported_at_its_own_lines(tmp_path: Path) -> None:
    (tmp_path / "dma.csv").write_text("T [degC];f [Hz];E';E'' [MPa]\n1;1;1;1\n", encoding="utf-8")
    (problem,) = refused(tmp_path, "name: x\nmoduli: {file: {name: dma.csv}}\n")
    assert problem == 'dma.csv:1:1: "E\'" has no unit (expected Pa, kPa, MPa or GPa; units: {"E\'": Pa})'


def test_doubts_name_their_subject(tmp_path: Path) -> None:
    assert doubts(tmp_path, FULL.replace("decade_k: 8\n", "")) == [
        "c.yaml:11:1: measured at 1 Hz alone, and decade_k is missing: 8 K a decade (paper G) counts"
    ]
    (doubt,) = doubts(tmp_path, FULL.replace("N234: 50, oil: 8.5", "N234: 5000 %, oil: 800"))
    assert "formulation adds up to 951.6 phr (expected 90 to 500)" in doubt
    (doubt,) = doubts(tmp_path, FULL.replace("moduli:\n", "moduli:\n  beyond: hold\n"))
    assert "an extrapolation" in doubt
    (doubt,) = doubts(tmp_path, "name: x\nmoduli: {constant: {G: 1 MPa, loss_factor: 0.3}}\n")
    assert "a constant modulus is no rubber's" in doubt


def test_a_shift_that_is_not_that_of_the_glass_transition_is_doubted(tmp_path: Path) -> None:
    zener = "{Gr: 1 MPa, Gg: 1 GPa, tau: 1e-6 s, at: 20 degC, b: 0.6, Ts: 10 degC}"
    (doubt,) = doubts(tmp_path, f"name: x\nTg: -53 degC\nmoduli: {{fractional_zener: {zener}}}\n")
    assert "Ts, 10 degC, is not Tg + 50 K, -3 degC" in doubt


def test_doubts_of_an_import_stay(tmp_path: Path) -> None:
    assert doubts(tmp_path, "name: x\ndoubts:\n  - one\n  - two\n") == ["c.yaml:3:5: one", "c.yaml:4:5: two"]


def test_the_examples_of_the_page_are_valid(tmp_path: Path) -> None:
    page = Path(__file__).parents[4] / "docs" / "how-to" / "describe-a-compound.md"
    blocks = re.findall(r"^```yaml\n(.*?)^```", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    lines = "".join(f"{-60 + 5 * i};1;{2000 / (i + 1)};{200 / (i + 1)}\n" for i in range(20))
    (tmp_path / "tread-a.csv").write_text(f"T [degC];f [Hz];E' [MPa];E'' [MPa]\n{lines}", encoding="utf-8")
    one = loaded(tmp_path, blocks[0])
    assert one.model.name == "tread A" and one.file.doubts == ()
    (tmp_path / "s.yaml").write_text(blocks[1], encoding="utf-8")
    assert load_surface(tmp_path / "s.yaml").model.name == "my abrasive"
