"""The report as a page: whole, harmless, well-formed, with nothing fetched and nothing run."""

from __future__ import annotations

import html
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tester.analysis.reference_watch import ControlChart, ControlPoint, ReferenceWatch
from tester.base.plugins import MissingExtraError
from tester.base.words import FORBIDDEN
from tester.report.charts import Material, values_of
from tester.report.layout import Paragraph, Report, ReportSection
from tester.report.page import LONGEST_TEXT, POLICY, page_of, readable
from tester.report.record_section import MachineWords, RunRecord, read_record
from tester.report.report_build import report_of
from tests.tester.kinds.wheel_on_belt.fit.made import made_run
from tests.tester.results.test_reference import BLUNT, SHARP, watched_run
from tests.tester.store.build import CONDITION, PIECE, RUN, SPECIMENS, open_writer, record

pytest.importorskip("matplotlib", reason="needs the extra `report`")
pytest.importorskip("jinja2", reason="needs the extra `report`")

HTML = "{http://www.w3.org/1999/xhtml}"
SVG = "{http://www.w3.org/2000/svg}"
WORDS = MachineWords("rubber wheel on a belt", "the friction coefficient of a wheel")
HOSTILE = (
    "<script>alert(1)</script>",
    "\"' onload=alert(1) x='",
    "]]><svg onload=alert(1)>",
    "a\u202egnp.exe\u0007\x1b[2J",
    "$\\frac$ {{ 7 * 7 }} {% raw %}",
    "</style><img src=http://a.example/b.png>",
    "long" * 5000,
)
_ELEMENTS = """html head meta title style body header p h1 h2 h3 dl div dt dd figure figcaption table thead tbody tr
th td nav ol ul li a main article section footer details summary"""
_DRAWN = "svg g path use text defs clipPath rect circle title image"
ELEMENTS, DRAWN = (frozenset(names.split()) for names in (_ELEMENTS, _DRAWN))
"""Elements that a page may have, of its own and in drawings."""


def showing(record: RunRecord) -> Material:
    return Material(values_of(record.results))


def page(*records: RunRecord) -> str:
    return page_of(report_of(records, showing))


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> RunRecord:
    folder = tmp_path_factory.mktemp("runs") / "one"
    design = [(25.0, load, slip) for load in (100.0, 200.0) for slip in (0.1, 0.3)]
    return read_record(made_run(folder, design, carried=[2], failed=[4]), WORDS)


@pytest.fixture(scope="module")
def text(plain: RunRecord) -> str:
    return page(plain)


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A report of a run with hostile text in every field."""
    folder = tmp_path_factory.mktemp("hostile") / "two"
    folder.mkdir()
    every = " ".join(HOSTILE)
    run = replace(RUN, recipe_name=every, operator=every, metadata={every: every}, rig_source=every,
                  versions={every: every}, git_revision=every)  # fmt: skip
    held = CONDITION.setpoint.but(every)
    conditions = [
        replace(CONDITION, condition=i, row=i, note=every, grid=every, setpoint=held.but(load=100.0 * i))
        for i in (1, 2)
    ]
    writer = open_writer(folder)
    writer.begin_run(run, SPECIMENS, conditions)
    writer.piece_mounted(replace(PIECE, compound=every))
    record(writer, 1, [0.9, 0.91, 0.92], flags="carry-over")
    record(writer, 2, [0.7, float("nan"), 0.72])
    writer.finish("failed", every, rig_seconds=60.0)
    writer.close()
    points = (ControlPoint(1, 1, 0.0, 0.7, 0.02, True),)
    watch = ReferenceWatch((), {}, (ControlChart(every, 0.7, 0.65, 0.75, points),))
    found = read_record(folder, MachineWords(every, every, every, every))
    return page(replace(found, results=replace(found.results, watch=watch)))


def elements(text: str) -> Iterator[ElementTree.Element]:
    """Yield the elements of a page; raises ParseError where it is not well-formed."""
    return ElementTree.fromstring(text.strip().removeprefix("<!DOCTYPE html>")).iter()


def test_a_page_has_every_section_and_the_measured_values(text: str) -> None:
    titles = [one.text for one in elements(text) if one.tag == f"{HTML}h3"]
    assert titles == [
        "Conditions",
        "Figures",
        "What ran on what",
        "Uncertainty budgets",
        "Drift, repeats, exclusions",
        "Zeros of the load cell",
        "Calibration",
        "Alarms and trips",
        "Control chart",
        "Assumptions",
        "Where it is from",
    ]
    assert "Measured was the friction coefficient of a wheel." in text
    assert "Simulated: no rubber and no machine were involved." in text
    assert "No reference condition was measured." in text
    assert "3 of 4 conditions have a value; 1 carries a doubt (carry-over), none carries a note." in text


def folded(text: str) -> dict[str | None, bool]:
    """Return the sections of the appendix by their headings, and whether each is unfolded."""
    return {
        next(one.text for one in details.iter() if one.tag == f"{HTML}h3"): details.get("open") is not None
        for details in elements(text)
        if details.tag == f"{HTML}details"
    }


def test_a_screen_folds_all_but_conditions_and_figures(plain: RunRecord) -> None:
    sections = folded(page(replace(plain, verification=replace(plain.verification, problems=()))))
    assert "Uncertainty budgets" in sections and not {"Conditions", "Figures"} & sections.keys()
    assert not any(sections.values())


def test_a_section_that_reports_something_bad_is_not_folded(plain: RunRecord) -> None:
    found = replace(plain, verification=replace(plain.verification, problems=("run.db: repeat 1: changed",)))
    assert [title for title, unfolded in folded(page(found)).items() if unfolded] == ["Where it is from"]


@pytest.mark.parametrize("which", ["text", "hostile"])
def test_a_page_is_well_formed_of_known_elements_with_names_of_their_own(
    which: str, request: pytest.FixtureRequest
) -> None:
    found = [*elements(request.getfixturevalue(which))]
    names = {one.tag for one in found}
    assert {name.removeprefix(HTML) for name in names if name.startswith(HTML)} <= ELEMENTS
    assert {name.removeprefix(SVG) for name in names if name.startswith(SVG)} <= DRAWN
    assert all(name.startswith((HTML, SVG)) for name in names)
    ids = [one.get("id") for one in found if one.get("id")]
    assert len(ids) == len(set(ids))


@pytest.mark.parametrize("which", ["text", "hostile"])
def test_a_page_contains_everything_it_refers_to(which: str, request: pytest.FixtureRequest) -> None:
    text: str = request.getfixturevalue(which)
    found = [*elements(text)]
    ids = {one.get("id") for one in found}
    for one in found:
        for name, value in one.attrib.items():
            assert not name.lower().startswith("on"), name
            if name.rpartition("}")[2] in ("href", "src"):
                assert value.startswith("data:image/") or (value[1:] in ids and value[0] == "#"), value
            for place in re.findall(r"url\(([^)]*)\)", value):
                assert place[0] == "#" and place[1:] in ids
    (style,) = [one.text or "" for one in found if one.tag == f"{HTML}style"]
    assert "url(" not in style and "@import" not in style


def test_a_page_forbids_itself_everything_but_its_style_and_pictures(text: str) -> None:
    policies = [one for one in elements(text) if one.get("http-equiv") == "Content-Security-Policy"]
    assert [one.get("content") for one in policies] == [POLICY]
    assert "script" not in POLICY and POLICY.startswith("default-src 'none'")


def test_hostile_names_are_text_and_steer_nothing(hostile: str) -> None:
    assert not FORBIDDEN.search(hostile)
    assert "<script" not in hostile and "onload=alert(1)>" not in hostile.replace("&gt;", "")
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in hostile
    assert "{{ 7 * 7 }}" in hostile  # verbatim: not a template of ours
    assert all(len(one.text or "") <= LONGEST_TEXT + 40 for one in elements(hostile) if one.tag != f"{HTML}style")


def test_points_are_named_by_titles_and_figures_have_text_alternatives(text: str) -> None:
    drawn = [one for one in elements(text) if one.tag == f"{SVG}svg"]
    assert drawn and all(one.get("role") == "img" and one.get("aria-label") for one in drawn)
    names = [one.text for one in elements(text) if one.tag == f"{SVG}title"]
    assert any(name and name.startswith("1#, 300 mm/s, 100 N, 25 degC: 0.8") for name in names)


def test_every_term_of_a_budget_is_listed_with_its_source_and_its_share(text: str, plain: RunRecord) -> None:
    shown = html.unescape(text)
    for row in plain.results.rows:
        for one in row.result.compound_budget.contributions:
            assert one.name in shown and one.source in shown
    assert "wheel to wheel" in text and "stated 3 % [A]" in text


def test_a_changed_run_is_reported_on_the_first_page(plain: RunRecord) -> None:
    found = replace(plain, verification=replace(plain.verification, problems=("run.db: repeat 1: changed",)))
    text = page(found)
    assert "The record is not as it was left: 1 finding, see below." in text.partition("<nav")[0]
    assert "run.db: repeat 1: changed" in text


@pytest.mark.parametrize("made", ["text", "hostile"])
def test_a_page_is_html_to_a_strict_parser(made: str, request: pytest.FixtureRequest) -> None:
    html5lib = pytest.importorskip("html5lib", reason="needs html5lib, which .ci/run installs")
    parser = html5lib.HTMLParser()
    parser.parse(request.getfixturevalue(made))
    assert parser.errors == []


def test_a_control_chart_appears_where_there_are_reference_conditions(tmp_path: Path) -> None:
    text = page(read_record(watched_run(tmp_path, (SHARP, [float("nan")] * 3, BLUNT)), WORDS))
    assert "No reference condition" not in text and "of 2 not in control." in text
    assert "reference condition in the order in which it was measured" in text
    assert "references of 1#: limits 0." in text
    assert text.count("out of control</td>") >= 1 and text.count("no value</td>") == 1


def test_two_runs_are_overlaid_and_compared(plain: RunRecord, tmp_path: Path) -> None:
    design = [(25.0, load, 0.3) for load in (100.0, 200.0)] + [(25.0, 100.0, 0.1)]
    other = read_record(made_run(tmp_path / "other", design), WORDS)
    text = page(plain, other)
    assert "Runs compared" in text and "friction coefficient over load, of each run" not in text
    assert "one and other" in text and "friction coefficient over slip velocity, of each run" in text
    names = [one.text or "" for one in elements(text) if one.tag == f"{SVG}title"]
    assert any(name.startswith("other: 1#") for name in names)


def test_a_text_is_cut_where_it_is_very_long_and_control_characters_become_marks() -> None:
    assert readable("a\u202eb\x00") == "a?b?"
    assert readable("x" * (LONGEST_TEXT + 7)) == "x" * LONGEST_TEXT + "… (7 more characters)"


def test_a_run_without_a_value_has_a_report_that_states_it(tmp_path: Path) -> None:
    text = page(read_record(made_run(tmp_path / "none", [(25.0, 100.0, 0.3)], failed=[1]), WORDS))
    assert "0 of 1 condition have a value." in text
    assert "No condition has a budget." in text


def test_without_jinja_the_line_that_installs_it_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "jinja2", None)
    empty = Report("a", "b", [Paragraph("c")], [], "d")
    with pytest.raises(MissingExtraError, match=r"friction-tester\[report\]"):
        page_of(empty)
    assert ReportSection("a", "b", []).parts == []


@pytest.mark.parametrize("source", ["/home/ada/lab/mine.yaml", "C:\\Users\\ada\\lab\\mine.yaml"])
def test_a_page_names_files_without_the_folders_of_its_maker(source: str, plain: RunRecord) -> None:
    info = replace(plain.results.run.info, recipe_source=source, rig_source=source)
    run = replace(plain.results.run, info=info)
    text = page(replace(plain, results=replace(plain.results, run=run)))
    assert "(from mine.yaml)" in text and "ada" not in text.replace(info.operator, "")
