"""A run keeps its files of compounds and surfaces: copied, on record with hash, verified, kept when resumed."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing
from hashlib import sha256
from pathlib import Path

import pytest

import recipes
from tester.base.source import InvalidSource
from tester.cli.main import invoke
from tester.inputs.materials.files import DataFile, MaterialFile
from tester.report.materials_section import materials_sections
from tester.report.record_section import MachineWords, read_record
from tester.results.verify import verify
from tester.run.run_materials import KeptFile, kept_files, put_back, used_materials
from tester.run.session import CannotStartError, Session
from tester.run.session_options import SessionOptions
from tester.store.records import StoredMaterial
from tester.store.run_reader import RunReader
from tests.tester.inputs.recipe.texts import SMALL, recipe
from tests.tester.run.cut_short import TEXT, cut_short
from tests.tester.run.test_session import Screen

OWN = """\
name: "1#"
source: the laboratory
formulation: {NR: 100, N234: 50.5}
Tg: -60 degC
decade_k: 8
moduli:
  file: {name: dma.csv}
"""
ROWS = "".join(f"{-60 + 20 * i};1;{2000 // (i + 1)};{200 // (i + 1)}\n" for i in range(5))
DMA = f"Temp [degC];f [Hz];E' [MPa];E'' [MPa]\n{ROWS}"


def write_own(folder: Path) -> None:
    """Put a compound with its moduli, five points and so a doubt, beside a recipe."""
    (folder / "compounds").mkdir()
    (folder / "compounds" / "own.yaml").write_text(OWN, encoding="utf-8")
    (folder / "compounds" / "dma.csv").write_bytes(DMA.encode())


@pytest.fixture(scope="module")
def cut(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of that compound on S0 that died in the middle of its second repeat."""
    home = tmp_path_factory.mktemp("cut")
    write_own(home)
    return cut_short(home, TEXT + "abrasive: {name: S0}\n")


@pytest.fixture
def again(cut: Path, tmp_path: Path) -> Path:
    """A copy of that run."""
    shutil.copytree(cut, tmp_path / cut.name)
    return tmp_path / cut.name


@pytest.fixture(scope="module")
def ended(cut: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The run, resumed to its end."""
    folder = tmp_path_factory.mktemp("ended") / cut.name
    shutil.copytree(cut, folder)
    assert Session(SessionOptions(), Screen()).resume(folder) == 0
    return folder


def test_files_are_on_record_with_hash_source_and_doubts(cut: Path) -> None:
    with RunReader(cut) as reader:
        own, data, surface = reader.run().info.materials
    assert (own.role, own.name, own.file, own.text) == ("compound", "1#", "compounds/own.yaml", OWN)
    assert own.sha256 == sha256(OWN.encode()).hexdigest()
    assert own.source.endswith("own.yaml") and "5 points only" in own.doubts
    assert (data.role, data.file, data.text) == ("data", "compounds/dma.csv", DMA)
    assert (surface.role, surface.name, surface.source) == ("surface", "S0", "packaged: surfaces/s0.yaml")


def test_copies_lie_beside_the_run_s_recipe(cut: Path) -> None:
    assert (cut / "compounds" / "own.yaml").read_text(encoding="utf-8") == OWN
    assert (cut / "compounds" / "dma.csv").read_bytes() == DMA.encode()
    packaged = recipes.FOLDER / "surfaces" / "s0.yaml"
    assert (cut / "surfaces" / "s0.yaml").read_bytes() == packaged.read_bytes()


def test_a_resumed_run_keeps_the_recorded_files(again: Path) -> None:
    (again / "compounds" / "own.yaml").write_text('name: "1#"\nTg: -10 degC\n', encoding="utf-8")
    (again / "compounds" / "dma.csv").unlink()
    screen = Screen()
    assert Session(SessionOptions(), screen).resume(again) == 0
    assert "compounds/own.yaml, compounds/dma.csv put back as recorded" in screen.messages[0]
    assert (again / "compounds" / "own.yaml").read_text(encoding="utf-8") == OWN
    assert verify(again).problems == ()


def test_a_long_file_that_was_changed_stops_a_resumed_run(again: Path) -> None:
    with closing(sqlite3.connect(again / "run.db")) as database:
        database.execute("UPDATE material SET text = NULL WHERE role = 'data'")
        database.commit()
    (again / "compounds" / "dma.csv").write_text("other\n", encoding="utf-8")
    with pytest.raises(CannotStartError, match=r"compounds/dma\.csv: changed since the run began"):
        Session(SessionOptions(), Screen()).resume(again)


def test_a_changed_recipe_brings_its_files_along(again: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("TESTER_MATERIALS", raising=False)
    text = (again / "recipe.yaml").read_text(encoding="utf-8")
    (again / "recipe.yaml").write_text(text.replace("{name: S0}", "{name: road}"), encoding="utf-8")
    assert Session(SessionOptions(), Screen()).resume(again, "another track") == 0
    with RunReader(again) as reader:
        found = [(one.role, one.name) for one in reader.run().info.materials]
    assert found == [("compound", "1#"), ("data", "dma.csv"), ("surface", "S0"), ("surface", "road")]
    assert verify(again).problems == ()


def test_verify_names_a_copy_that_was_changed(ended: Path, tmp_path: Path) -> None:
    assert verify(ended).problems == ()
    folder = tmp_path / ended.name
    shutil.copytree(ended, folder)
    (folder / "compounds" / "dma.csv").write_text("other\n", encoding="utf-8")
    (folder / "surfaces" / "s0.yaml").unlink()
    problems = verify(folder).problems
    assert "compounds/dma.csv: not what the run was made with" in problems
    assert "surfaces/s0.yaml: missing" in problems


def test_verify_names_a_text_on_record_that_was_changed(ended: Path, tmp_path: Path) -> None:
    folder = tmp_path / ended.name
    shutil.copytree(ended, folder)
    with closing(sqlite3.connect(folder / "run.db")) as database:
        database.execute("UPDATE material SET text = 'name: other' WHERE role = 'surface'")
        database.commit()
    assert "run.db: the text of surfaces/s0.yaml has another hash" in verify(folder).problems


def test_show_names_them_with_their_hash(ended: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["show", str(ended)]) == 0
    out = capsys.readouterr().out
    assert f"sha256 {sha256(OWN.encode()).hexdigest()}" in out and "doubt: " in out
    assert "surface  S0: packaged: surfaces/s0.yaml" in out or "surface S0: packaged: surfaces/s0.yaml" in out


def test_a_report_has_formulations_and_glass_transition(ended: Path) -> None:
    record = read_record(ended, MachineWords("a rig", "mu"))
    (section,) = materials_sections(record, "m")
    told = repr(section)
    assert section.title == "Materials"
    for text in ("Formulations (phr)", "'N234', '50.5'", "-60 degC", sha256(OWN.encode()).hexdigest(), "5 points only"):
        assert text in told


def test_names_without_files_are_names_and_no_more(tmp_path: Path) -> None:
    text = SMALL.replace('"1#"', "unheard of") + "abrasive: {name: another belt}\n"
    used = used_materials(recipe(text), tmp_path / "r.yaml")
    assert used.files == () and used.doubts == []
    assert used.bare == (("compound", "unheard of"), ("surface", "another belt"))


def test_a_broken_file_of_a_compound_stops_the_run(tmp_path: Path) -> None:
    write_own(tmp_path)
    (tmp_path / "compounds" / "own.yaml").write_text(OWN.replace("-60 degC", "cold"), encoding="utf-8")
    with pytest.raises(InvalidSource, match=r"own\.yaml:4:5: Tg"):
        used_materials(recipe(SMALL), tmp_path / "r.yaml")


def material(path: str, name: str, text: str, *data: DataFile) -> MaterialFile:
    return MaterialFile("compound", name, Path(path), text, data)


def test_files_of_one_name_get_folders_of_their_own() -> None:
    one = material("/a/c.yaml", "A", "name: A\n", DataFile("dma.csv", b"1"))
    other = material("/b/c.yaml", "B", "name: B\n", DataFile("dma.csv", b"2"))
    third = material("/b/d.yaml", "C", "name: C\n", DataFile("DMA.csv", b"3"))
    names = [kept.stored.file for kept in kept_files([one, other, third], ["compounds/x.yaml"])]
    assert names == [
        "compounds/c.yaml", "compounds/dma.csv", "compounds/2/c.yaml", "compounds/2/dma.csv", "compounds/3/d.yaml",
        "compounds/3/DMA.csv",
    ]  # fmt: skip


def test_a_long_or_binary_file_is_kept_by_its_hash(tmp_path: Path) -> None:
    binary = DataFile("scan.al3d", b"\0\1\2")
    (_, kept) = kept_files([material("/a/c.yaml", "A", "name: A\n", binary)])
    assert isinstance(kept, KeptFile) and kept.stored.text is None and kept.content == b"\0\1\2"
    assert put_back(tmp_path, [kept.stored]) == ([], ["compounds/scan.al3d"])
    text = StoredMaterial("compound", "A", "compounds/a.yaml", "", sha256(b"x").hexdigest(), "x")
    assert put_back(tmp_path, [text]) == (["compounds/a.yaml"], [])
    assert put_back(tmp_path, [text]) == ([], [])


def test_a_sweep_takes_them_along(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from tester.run.sweep.sweep import SweepOptions, prepare_sweep

    monkeypatch.delenv("TESTER_MATERIALS", raising=False)
    write_own(tmp_path)
    (tmp_path / "r.yaml").write_text(SMALL, encoding="utf-8")
    sweep = prepare_sweep(SweepOptions(recipe=str(tmp_path / "r.yaml"), seeds=1))
    (task,) = sweep.tasks
    assert [one.stored.file for one in task.materials] == ["compounds/own.yaml", "compounds/dma.csv"]
