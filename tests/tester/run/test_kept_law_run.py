"""A simulated run with a kept law: it resumes with the copy in its folder, whatever happened to the original."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tester.results.verify import verify
from tester.run.folder import read_work
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tests.tester.inputs.kept_laws.kept_example import example_text
from tests.tester.run.cut_short import SETS, cut_short
from tests.tester.run.test_session import Screen

OTHER = {"a": {"value": 0.3, "logarithm": True}, "n": {"value": 0.2}, "m": {"value": -0.1, "fitted": False}}


@pytest.fixture(scope="module")
def cut(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with a kept law that died in the middle of its second repeat, beside its recipe and its law."""
    home = tmp_path_factory.mktemp("cut")
    (home / "law.yaml").write_text(example_text(compound="1#"), encoding="utf-8")
    return cut_short(home, sets=(*SETS, f"sim.friction_model={home / 'law.yaml'}"))


@pytest.fixture
def law(cut: Path) -> Path:
    """The original of the law, as it was fitted."""
    path = cut.parents[1] / "law.yaml"
    path.write_text(example_text(compound="1#"), encoding="utf-8")
    return path


def resumed(cut: Path, home: Path) -> Path:
    """Resume a copy of the run to its end."""
    folder = home / cut.name
    shutil.copytree(cut, folder)
    assert Session(SessionOptions(), Screen()).resume(folder) == 0
    return folder


def test_a_run_resumes_by_the_copy_without_the_original_or_with_another(cut: Path, law: Path, tmp_path: Path) -> None:
    same = resumed(cut, tmp_path / "same")
    law.write_text(example_text(compound="1#", parameters=OTHER), encoding="utf-8")
    changed = resumed(cut, tmp_path / "changed")
    law.unlink()
    gone = resumed(cut, tmp_path / "gone")
    tables = [(folder / "appendix.csv").read_bytes() for folder in (same, changed, gone)]
    assert tables[0] == tables[1] == tables[2] and verify(gone).problems == ()


def test_a_changed_copy_is_put_back(cut: Path, law: Path, tmp_path: Path) -> None:
    shutil.copytree(cut, tmp_path / cut.name)
    copy = tmp_path / cut.name / "laws" / "law.yaml"
    copy.write_text(example_text(compound="1#", parameters=OTHER), encoding="utf-8")
    screen = Screen()
    assert Session(SessionOptions(), screen).resume(tmp_path / cut.name) == 0
    assert "laws/law.yaml put back as recorded" in screen.messages[0]
    assert copy.read_bytes() == law.read_bytes()


def test_a_worker_reads_the_copy(cut: Path, law: Path) -> None:
    law.unlink()
    work = read_work(cut)
    assert Path(work.rig.plant.friction_model) == (cut / "laws" / "law.yaml").resolve()  # type: ignore[attr-defined]
