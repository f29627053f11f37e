"""Step-by-step pages, followed word by word, give the results they state."""

from __future__ import annotations

import os
import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from drivers.modbus import ModbusLink
from drivers.profiles import load_profile
from drivers.sensor import Sensor
from tester.analysis.blocks import resultant
from tester.cli.command_table import COMMANDS
from tester.cli.main import invoke

DOCS = Path(__file__).parents[1] / "docs"
TUTORIAL = DOCS / "tutorial" / "your-first-recipe.md"
TO_REPORT = DOCS / "tutorial" / "from-run-to-report.md"
READING = DOCS / "explanation" / "how-data-travel.md"
KIND = DOCS / "how-to" / "add-a-kind-of-rig.md"
PAPER = DOCS / "paper.md"
SCRIPTING = DOCS / "how-to" / "script-against-the-service.md"
STEP = re.compile(r"((?:<!-- .*? -->\n)+)```(\w+)\n(.*?)```", re.DOTALL)
NOTE = re.compile(r"<!-- (.*?) -->")
PRINTED = re.compile(r"^    (\S.*\d.*)$", re.MULTILINE)
"""A printed line with a figure in it."""
LOOKS = 100
"""Maximum number of polls until a service is there, each of some tenths of a second."""
TESTER = "from tester.cli.main import main; main()"


def said_by(folder: Path, *arguments: str) -> str:
    """Run `tester` in a folder; return all its output."""
    environment = {**os.environ, "PYTHONPATH": str(DOCS.parent), "TESTER_RUNTIME_DIR": str(folder / "runtime")}
    done = subprocess.run(
        [sys.executable, "-c", TESTER, *arguments],
        cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
    )  # fmt: skip
    return done.stdout


class Reader:
    """A reader who follows a page in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def follow(self, notes: list[str], text: str) -> None:
        """Do one step: write a file, change it, run a command and compare its output with the page."""
        said = ""
        for line in text.splitlines() if not any(note.endswith(".yaml") for note in notes) else ():
            said += said_by(self.folder, *shlex.split(line)[1:])
        for note in notes:
            self._note(note, text, said)

    def change(self, note: str) -> None:
        """Edit a file as the page asks."""
        edit = re.fullmatch(r'change (\S+): "(.*?)" to "(.*?)"', note)
        assert edit, note
        path = self.folder / edit[1]
        before = path.read_text(encoding="utf-8")
        assert before.count(edit[2]) == 1
        path.write_text(before.replace(edit[2], edit[3]), encoding="utf-8")

    def _note(self, note: str, text: str, said: str) -> None:
        if note.startswith("says: "):
            assert note.removeprefix("says: ") in said
        elif note.startswith("does not say: "):
            assert said and note.removeprefix("does not say: ") not in said
        elif after := re.fullmatch(r'after "(.*?)" in (\S+)', note):
            path = self.folder / after[2]
            lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
            (place,) = [i for i, line in enumerate(lines) if line.startswith(after[1])]
            path.write_text("".join([*lines[: place + 1], text, *lines[place + 1 :]]), encoding="utf-8")
        elif note.endswith(".yaml"):
            (self.folder / note).write_text(text, encoding="utf-8")


def test_the_tutorial_works_as_written(tmp_path: Path) -> None:
    reader = Reader(tmp_path)
    steps = STEP.findall(TUTORIAL.read_text(encoding="utf-8"))
    assert len(steps) == 8

    for notes, _, text in steps:
        found = NOTE.findall(notes)
        for note in [one for one in found if one.startswith("change ")]:
            reader.change(note)
        reader.follow([one for one in found if not one.startswith("change ")], text)


@pytest.mark.parametrize("page", sorted(DOCS.rglob("*.md")), ids=lambda page: str(page.relative_to(DOCS)))
def test_links_of_a_page_lead_somewhere(page: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))

    assert [link for link in links if "://" not in link and not (page.parent / link).exists()] == []


@pytest.mark.parametrize("page", sorted(DOCS.rglob("*.md")), ids=lambda page: str(page.relative_to(DOCS)))
def test_links_into_a_page_lead_to_a_heading(page: Path) -> None:
    links = re.findall(r"\]\(([^)#\s]*\.md)?#([^)\s]+)\)", page.read_text(encoding="utf-8"))

    assert [to for name, to in links if to not in anchors(page.parent / name if name else page)] == []


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def to_report() -> str:
    """Return the page from a run to its report."""
    return TO_REPORT.read_text(encoding="utf-8")


def test_the_way_to_a_report_begins_as_its_page_states(tmp_path: Path) -> None:
    reader = Reader(tmp_path)
    steps = STEP.findall(to_report())
    assert len(steps) == 3

    for notes, _, text in steps:
        reader.follow(NOTE.findall(notes), text)


@pytest.mark.parametrize("line", re.findall(r"^tester .*", to_report(), re.MULTILINE))
def test_the_way_to_a_report_goes_by_commands_and_options_that_exist(
    line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    command, *words = shlex.split(line)[1:]

    assert invoke([command, "--help"]) == 0
    told = capsys.readouterr().out.split()
    assert [word for word in words if word.startswith("--") and word not in told] == []


@pytest.mark.parametrize("page", [TUTORIAL, SCRIPTING, PAPER], ids=lambda page: page.stem)
def test_commands_of_a_page_exist(page: Path) -> None:
    named = re.findall(r"(?:^|`)tester ([a-z-]+)", page.read_text(encoding="utf-8"), re.MULTILINE)

    assert named and set(named) <= set(COMMANDS)


def test_the_script_runs_a_recipe(tmp_path: Path) -> None:
    (script,) = [text for note, _, text in STEP.findall(SCRIPTING.read_text(encoding="utf-8")) if "script.py" in note]
    environment = {
        **os.environ, "PYTHONPATH": str(DOCS.parent), "TESTER_RUNTIME_DIR": str(tmp_path / "runtime"),
    }  # fmt: skip
    service = subprocess.Popen(
        [sys.executable, "-c", TESTER, "serve", "--out", str(tmp_path / "runs")],
        cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip
    try:
        assert any("no service" not in said_by(tmp_path, "status") for _ in range(LOOKS))
        done = subprocess.run(
            [sys.executable, "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
    finally:
        service.terminate()
        service.communicate()

    assert done.returncode == 0, done.stderr
    table = Path(done.stdout.splitlines()[-1].removeprefix("done: "))
    assert len(table.read_text(encoding="utf-8").splitlines()) == 3


def test_the_reading_of_the_example_travels_as_its_page_states() -> None:
    page = READING.read_text(encoding="utf-8")
    cell = Sensor(load_profile("four_axis_transmitter"), 1, ModbusLink("rtu", 115200, "N"))
    cell.set_tare((0.0, 0.0, 0.4, 0.0))
    registers = "00000E10 00000000 00000FA8 00000000 0000"
    cell.take(0, bytes.fromhex(registers), 1.0)
    along_n, across_n, normal_n, _ = cell.values
    mu = resultant(along_n, across_n, normal_n)

    assert cell.valid and "`0000 0FA8`" in page
    for said in (f"{cell.counts[2]:.0f} * 0.05 N = {cell.raw[2]:.1f} N", f"`force_z_n` = {normal_n:.1f}",
                 f"hypot({along_n:.1f}, {across_n:.1f}) / {normal_n:.1f} = {mu:g}", f"`{mu:.2f}`"):  # fmt: skip
        assert said in page


def test_the_page_on_kinds_quotes_the_lamp() -> None:
    quoted = re.findall(r"<!-- as in (\S+) -->\n```python\n(.*?)```", KIND.read_text(encoding="utf-8"), re.DOTALL)

    assert len(quoted) == 3
    assert [text for path, text in quoted if text not in (DOCS.parent / path).read_text(encoding="utf-8")] == []


def test_the_pages_stay_few_and_short() -> None:
    pages = [page.read_text(encoding="utf-8") for page in DOCS.rglob("*.md")]
    words = sum(bool(re.search(r"\w", token)) for text in pages for token in text.split())
    assert len(pages) <= 60 and words <= 70_000, f"{len(pages)} pages, {words} words"


def test_every_page_is_linked_from_the_first() -> None:
    first = (DOCS / "README.md").read_text(encoding="utf-8")
    pages = {str(page.relative_to(DOCS).as_posix()) for page in DOCS.rglob("*.md")}

    assert {page for page in pages if not page.startswith("decisions/") and f"]({page})" not in first} == {"README.md"}


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (["paper"], PRINTED.findall(PAPER.read_text(encoding="utf-8").partition("## Errors")[2])),
        (["paper"], ["36 of 79 rows within 5 %, 54 within 10 %, largest 50%",
                     "8.1%, 2.9%, 4.4%, 21.2% by Eqs 7 to 9; 0.9%, 1.4%, 2.2%, 2.1% by the value measured at 25 degC",
                     "11.3%, 13.9%, 14.8%, 9.9% with it as printed; 0.8%, 2.0%, 3.1%, 2.5% with it as inferred"]),
        (["fit", "appendix-a", "appendix-b"],
         ["-0.343", "-0.420", "-0.567", "+0.516", "+0.571", "+0.635"]),
    ],
    ids=["table", "claims", "trends"],
)  # fmt: skip
def test_the_page_on_the_paper_quotes_what_its_commands_print(
    command: list[str], said: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("scipy", reason="needs the extra `report`")
    page = PAPER.read_text(encoding="utf-8")

    assert invoke(command) == 0
    printed = capsys.readouterr().out
    assert len(said) >= 3
    assert [text for text in said if text not in printed or text not in page] == []


@pytest.mark.parametrize("compound", ["1#", "2#", "3#"])
@pytest.mark.parametrize("angle", [0, 10, 20, 30])
def test_the_page_on_the_paper_quotes_the_predictions(
    compound: str, angle: int, capsys: pytest.CaptureFixture[str]
) -> None:
    held = ["--slip", "300 mm/s", "--load", "200 N", "--temperature", "25 degC", "--sideslip", f"{angle} deg"]

    assert invoke(["predict", "--compound", compound, *held]) == 0
    assert capsys.readouterr().out.strip() in PAPER.read_text(encoding="utf-8")


def test_the_glossary_has_every_flag_as_the_one_list_has_it() -> None:
    text = (DOCS / "glossary.md").read_text(encoding="utf-8")
    assert runpy.run_path(str(DOCS / "flags.py"))["page_text"](text) == text


def test_the_page_of_commands_is_made_from_the_commands_as_they_are() -> None:
    text = (DOCS / "commands.md").read_text(encoding="utf-8")
    assert runpy.run_path(str(DOCS / "commands.py"))["page_text"]() == text
