"""`tester materials` and `tester schema --of`, as users call them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import recipes
from tester.cli.main import invoke
from tester.inputs.materials.compound import load_compound
from tester.inputs.materials.surface_file import load_surface

ROWS = "".join(f"{-60 + 5 * i};1;{2000 // (i + 1)},5;{200 // (i + 1)},25\n" for i in range(20))
DMA = f"Instrument;X\nOperator;Li\n\nTemp./°C;Freq.;Storage Modulus;Loss Modulus\n;[Hz];[MPa];[MPa]\n{ROWS}"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TESTER_MATERIALS", raising=False)
    return tmp_path


def test_list_names_packaged_materials_and_hidden_ones(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "compounds").mkdir()
    (folder / "compounds" / "mine.yaml").write_text("name: SBR\n", encoding="utf-8")
    assert invoke(["materials", "list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["compound", "SBR", "compounds/mine.yaml".replace("/", str(Path("/"))[0])]
    (hidden,) = [line for line in lines if "not used" in line]
    assert "sbr.yaml (not used: " in hidden and "mine.yaml is nearer)" in hidden
    assert any(line.split()[:3] == ["surface", "silicon", "carbide"] for line in lines)


def test_list_as_json(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["materials", "list", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert {"role": "surface", "name": "S0", "file": str(recipes.FOLDER / "surfaces" / "s0.yaml"),
            "hidden": False} in listed  # fmt: skip


def test_list_reports_a_file_without_a_name(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "surfaces").mkdir()
    (folder / "surfaces" / "x.yaml").write_text("note: y\n", encoding="utf-8")
    assert invoke(["materials", "list"]) == 0
    assert "x.yaml: has no name, so no recipe can name it" in capsys.readouterr().err


def test_show_prints_the_content_of_a_file_and_its_hash(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["materials", "show", "tread"]) == 0
    out = capsys.readouterr().out
    assert "holds    measured, 261 points, -110 to 150 degC, 1 Hz" in out
    assert "data     tread.csv, sha256 " in out
    assert invoke(["materials", "show", "tread", "--json"]) == 0
    (one,) = json.loads(capsys.readouterr().out)
    assert f"sha256   {one['sha256']}" in out and one["content"]["shear"]["tau_s0"] == "12000 Pa"


def test_show_distinguishes_the_four_rubbers_of_grosch(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shown: list[dict[str, object]] = []
    for name in ("SBR", "ABR", "INR", "butyl"):
        assert invoke(["materials", "show", name, "--json"]) == 0
        shown.append(json.loads(capsys.readouterr().out)[0]["facts"])
    for label in ("tan peak", "E0", "shift", "at 20 °C"):
        assert len({str(facts[label]) for facts in shown}) == 4, label


def test_show_of_an_unknown_name_is_a_usage_error(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["materials", "show", "tred"]) == 2
    assert 'did you mean "tread"?' in capsys.readouterr().err


def test_check_reports_doubts_and_problems(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "c.yaml").write_text("name: x\nmoduli: {constant: {G: 1 MPa}}\n", encoding="utf-8")
    assert invoke(["materials", "check", "c.yaml"]) == 0
    out, err = capsys.readouterr()
    assert out == "c.yaml: valid, compound x: constant, G 1 MPa, tan delta 0\n"
    assert err.startswith("doubt: c.yaml:2:1: a constant modulus is no rubber's")
    (folder / "s.yaml").write_text("name: x\nspectrum: {C0: 1 m4}\n", encoding="utf-8")
    assert invoke(["materials", "check", "s.yaml"]) == 3
    assert "s.yaml:2:1: q0 is missing" in capsys.readouterr().err
    assert invoke(["materials", "check", "s.yaml", "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["valid"] is False


def test_an_import_is_reported_and_can_be_read_again(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "d.csv").write_text(DMA, encoding="cp1252")
    assert invoke(["materials", "import", "dma", "d.csv", "--name", 'my "1#"', "-o", "c.yaml"]) == 0
    out, err = capsys.readouterr()
    assert out == "c.yaml\n"
    assert "noted: numbers have a decimal comma" in err
    assert 'doubt: d.csv:4:1: "Storage Modulus" does not say of which deformation' in err
    one = load_compound(Path("c.yaml"))
    assert one.model.name == 'my "1#"' and one.table is not None
    assert (one.table.rows[0].storage_pa, one.table.rows[0].loss_pa) == (2000.5e6, 200.25e6)
    text = Path("c.yaml").read_text(encoding="utf-8")
    assert "SHA-256" in text
    # The file keeps the doubt of the import.
    assert any("does not say of which deformation" in doubt.message for doubt in one.file.doubts)


def test_an_import_replaces_no_file_by_default(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "d.csv").write_text(DMA, encoding="utf-8")
    (folder / "c.yaml").write_text("mine\n", encoding="utf-8")
    arguments = ["materials", "import", "dma", "d.csv", "--name", "x", "-o", "c.yaml"]
    assert invoke(arguments) == 2
    assert Path("c.yaml").read_text(encoding="utf-8") == "mine\n"
    assert invoke([*arguments, "--force"]) == 0


def test_a_table_that_is_too_long_for_a_file_of_ours_is_not_written(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = "".join(f"{-60 + 0.01 * i:.2f};1;{2e9 / (i + 1)};{2e8 / (i + 1)}\n" for i in range(9000))
    (folder / "d.csv").write_text(f"T [degC];f [Hz];E' [Pa];E'' [Pa]\n{rows}", encoding="utf-8")
    assert invoke(["materials", "import", "dma", "d.csv", "--name", "x", "-o", "c.yaml"]) == 2
    assert "would be larger than 256 kB" in capsys.readouterr().err and not Path("c.yaml").exists()


def test_columns_and_units_may_be_given(folder: Path) -> None:
    text = DMA.replace("Storage Modulus;Loss Modulus", "A;B").replace(";[Hz];[MPa];[MPa]\n", "")
    (folder / "d.csv").write_text(text, encoding="utf-8")
    arguments = ["materials", "import", "dma", "d.csv", "--name", "x", "-o", "c.yaml"]
    assert invoke(arguments) == 3
    said = ["--columns", "E'=A", "--columns", "E''=B", "--unit", "A=MPa", "--unit", "B=kPa", "--unit", "Freq.=Hz"]
    assert invoke([*arguments, *said]) == 0
    table = load_compound(Path("c.yaml")).table
    assert table is not None and table.rows[0].loss_pa == pytest.approx(200.25e3)


def test_a_quantity_that_is_none_is_a_usage_error(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "d.csv").write_text(DMA, encoding="utf-8")
    arguments = ["materials", "import", "dma", "d.csv", "--name", "x", "-o", "c.yaml", "--columns"]
    assert invoke([*arguments, "Q=A"]) == 2
    assert '"Q" is none of temperature, frequency' in capsys.readouterr().err
    assert invoke([*arguments, "E'"]) == 2


def test_a_scan_becomes_a_surface(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    np.savetxt("m.csv", np.random.default_rng(0).normal(size=(64, 64)), delimiter=",")
    arguments = ["materials", "import", "scan", "m.csv", "-o", "s.yaml"]
    assert invoke(arguments) == 3
    assert "--unit um" in capsys.readouterr().err
    assert invoke([*arguments, "--pixel", "1um", "--unit", "um", "--name", "lab"]) == 0
    one = load_surface(Path("s.yaml"))
    assert one.model.name == "lab" and one.radial is not None
    # White noise of 1 um in 1 um pixels; the corners beyond the shortest wave of both sides hold 1 - pi / 4 of it.
    assert one.radial.rms_height_m**2 == pytest.approx(np.pi / 4.0 * 1e-12, rel=0.1)


def test_a_scan_of_an_instrument_names_the_extra(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    (folder / "m.al3d").write_bytes(b"x")
    assert invoke(["materials", "import", "scan", "m.al3d", "-o", "s.yaml"]) == 1
    assert 'pip install "friction-tester[topography]"' in capsys.readouterr().err


@pytest.mark.parametrize("what", ["recipe", "compound", "surface"])
def test_schemas_are_those_that_ship(what: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["schema", "--of", what]) == 0
    assert capsys.readouterr().out == (recipes.FOLDER / f"{what}.schema.json").read_text(encoding="utf-8")


def test_check_of_a_recipe_warns_of_doubts(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from tests.tester.inputs.recipe.texts import SMALL

    (folder / "r.yaml").write_text(SMALL, encoding="utf-8")
    (folder / "compounds").mkdir()
    path = folder / "compounds" / "one.yaml"
    path.write_text('name: "1#"\ndoubts: [it was old]\n', encoding="utf-8")
    assert invoke(["check", "r.yaml", "--verbose"]) == 0
    err = capsys.readouterr().err
    assert "warning: " in err and "one.yaml:2:10: it was old" in err and "compound 1#: " in err
    assert invoke(["check", "r.yaml", "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["doubts"]) == 1
    path.write_text('name: "1#"\nTg: -53\n', encoding="utf-8")
    assert invoke(["check", "r.yaml"]) == 3
    assert "one.yaml:2:5: Tg: -53 has no unit" in capsys.readouterr().err


def test_show_gives_the_facts_of_a_sweep(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["materials", "show", "tread"]) == 0
    lines = {line[:9].strip(): line[9:] for line in capsys.readouterr().out.splitlines()}
    # The formulas of tread.csv: 0.12 + 0.55 at -15 degC, 7 MPa to 2 GPa; strain as its file states.
    assert lines["tan peak"].startswith("0.670") and " at -15.0" in lines["tan peak"]
    assert lines["E0"].startswith("7.000") and lines["Einf"].startswith("1999.")
    assert lines["Einf/E0"].startswith("285.7") and "kelvins a decade: 1 frequency" in lines["unknown"]
    assert "strain 1 %" in lines["holds"]


def test_show_of_a_formula_gives_its_maxima_over_the_frequency(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["materials", "show", "SBR", "--json"]) == 0
    (one,) = json.loads(capsys.readouterr().out)
    # omega of the loss factor 3162 rad/s, of the loss modulus 1e6 rad/s at 20 degC.
    assert one["facts"]["at 20 °C"] == [
        "tan delta has its peak, 1.24, at 503 Hz",
        "the loss modulus has its peak at 1.59e+05 Hz",
    ]
    assert one["content"]["sources"]["Tg"].startswith("[A]")


@pytest.mark.parametrize(
    ("name", "waves"),
    [
        ("road", ["as the file states them (length, Ra):"]),
        ("asphalt", ["found in the spectrum, divided at 500 um; each has rms height and slope of its side (length, "
                     "amplitude, which counts as Ra):"]),
    ],
)  # fmt: skip
def test_show_distinguishes_stated_waves_from_found_ones(
    name: str, waves: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["materials", "show", name, "--json"]) == 0
    (one,) = json.loads(capsys.readouterr().out)
    assert one["facts"]["waves"] == waves and one["facts"]["coarse"] and one["facts"]["fine"]


def test_a_prediction_with_found_waves_states_it(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["predict", "--law", "greta", "--compound", "tread", "--slip", "1 m/s", "--load", "30 N",
                 "--temperature", "25 degC", "--surface"]  # fmt: skip
    assert invoke([*arguments, "asphalt"]) == 0
    assert "the two waves of asphalt are found in its spectrum, divided at 500 um" in capsys.readouterr().err
    assert invoke([*arguments, "road"]) == 0
    assert "waves" not in capsys.readouterr().err


def test_a_strain_survives_an_import(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = DMA.splitlines()
    lines[3], lines[4] = lines[3] + ";Strain", lines[4] + ";[%]"
    for name, strains in (("one", ("0,1", "0,1")), ("two", ("0,1", "3"))):
        rows = [f"{line};{strains[i % 2]}" for i, line in enumerate(lines[5:])]
        (folder / "d.csv").write_text("\n".join([*lines[:5], *rows]), encoding="utf-8")
        assert invoke(["materials", "import", "dma", "d.csv", "--name", name, "-o", f"{name}.yaml"]) == 0
        table = load_compound(Path(f"{name}.yaml")).table
        assert table is not None
        assert [row.strain_percent for row in table.rows[:2]] == [float(one.replace(",", ".")) for one in strains]
    assert "measured at strains of 0.1 to 3 %" in capsys.readouterr().err
    (folder / "d.csv").write_text(DMA, encoding="utf-8")
    arguments = ["materials", "import", "dma", "d.csv", "--name", "x", "-o", "x.yaml", "--force"]
    assert invoke(arguments) == 0
    assert "the strain is not stated" in capsys.readouterr().err
    assert invoke([*arguments, "--strain", "0.2 %"]) == 0
    assert "the strain is not stated" not in capsys.readouterr().err
    table = load_compound(Path("x.yaml")).table
    assert table is not None and table.strains_percent == (0.2, 0.2)


@pytest.mark.parametrize(("name", "texts"), [("tread", ["tan", "20"]), ("asphalt", ["rms slope 1.17", "found"])])
def test_a_material_is_drawn_with_its_words(
    name: str, texts: list[str], folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    from tester.report import draw

    monkeypatch.setitem(draw.RC, "svg.fonttype", "none")  # text as text
    assert invoke(["materials", "draw", name, "--out", "a.svg"]) == 0
    assert capsys.readouterr().out == "a.svg\n"
    drawn = Path("a.svg").read_text(encoding="utf-8")
    assert drawn.startswith("<?xml") and all(text in drawn for text in texts)


def test_a_drawing_names_the_missing_extra_the_format_and_undrawable_materials(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys

    assert invoke(["materials", "draw", "tread", "-o", "a.bmp"]) == 1
    assert "a figure is one of png, svg, pdf" in capsys.readouterr().err
    assert invoke(["materials", "draw", "road", "-o", "a.png"]) == 1
    assert "road has two waves and no spectrum" in capsys.readouterr().err
    assert invoke(["materials", "draw", "1#", "-o", "a.png"]) == 1
    assert "holds no moduli" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert invoke(["materials", "draw", "tread", "-o", "a.png"]) == 1
    assert 'pip install "friction-tester[report]"' in capsys.readouterr().err
