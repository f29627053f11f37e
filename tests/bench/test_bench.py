"""The benchmarks' own machinery: registry, table, JSON, verdicts. Nothing here depends on how long anything takes."""

from __future__ import annotations

import json
import math

import pytest

from bench import cli, lateness, model, registry, scan_cost
from bench.big_recipe import long_list_text, recipe_text, work
from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, Limit, Verdict, at_least, at_most, number, ratio, unavailable
from bench.ledger import PARTS, Ledger
from bench.live import SLIDING_RECIPE, live_run
from bench.machine import machine
from bench.report import as_json, as_markdown, missed, table
from bench.speed import one_compound
from bench.wrapping import ENTRY_POINTS, wrapped
from sim.machines.wheel_on_belt.plant import Plant
from tester.inputs.recipe.conditions import conditions_of
from tester.inputs.recipe.loader import load_checked
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.recipe.part import PART

MACHINE: dict[str, str | int] = {"interpreter": "CPython 3.11", "pgo": "no", "cpus": 2}
FAST = Figure("drivers", "us", (11.0, 9.0, 10.0), at_most(12.0))
SLOW = Figure("control", "us", (14.0, 9.0, 11.0), at_most(10.0), "interlocks")
PLAIN = Figure("nodes", "us", (20.0,))
ABSENT = unavailable("pty", "us", "this system has no pseudo-terminals")
BROKEN = Figure("rig", "", (), note="tripped", failed=True)


# Figures


def test_a_figure_is_the_median_of_its_runs_with_the_extremes() -> None:
    assert (FAST.median, FAST.least, FAST.greatest) == (10.0, 9.0, 11.0)


@pytest.mark.parametrize(
    ("runs", "limit", "verdict"),
    [
        ((9.0, 10.0, 99.0), at_most(10.0), Verdict.HOLDS),
        ((9.0, 10.1, 99.0), at_most(10.0), Verdict.MISSED),
        ((9.0, 10.0, 99.0), at_most(10.0, worst=True), Verdict.MISSED),
        ((1.0, 800.0, 900.0), at_least(800.0), Verdict.HOLDS),
        ((1.0, 799.0, 900.0), at_least(800.0), Verdict.MISSED),
        ((1.0, 800.0, 900.0), at_least(800.0, worst=True), Verdict.MISSED),
        ((0.0,), at_most(0.0, worst=True), Verdict.HOLDS),
        ((math.nan,), at_most(10.0), Verdict.MISSED),
        ((math.nan,), at_least(10.0), Verdict.MISSED),
        ((5.0,), None, Verdict.SHOWN),
        ((), at_most(10.0), Verdict.UNAVAILABLE),
    ],
)
def test_verdict_follows_from_runs_and_limit(runs: tuple[float, ...], limit: Limit | None, verdict: Verdict) -> None:
    assert Figure("a", "us", runs, limit).verdict is verdict


def test_only_a_figure_beyond_its_limit_or_a_failure_counts_as_missed() -> None:
    assert [figure.missed for figure in (FAST, SLOW, PLAIN, ABSENT, BROKEN)] == [False, True, False, False, True]


def test_a_ratio_is_taken_run_for_run() -> None:
    assert ratio("a / b", [2.0, 9.0], [1.0, 3.0]).runs == (2.0, 3.0)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1234567.0, "1,234,567"), (0.0734, "0.073"), (2.345, "2.35"), (145.04, "145.0"), (2345.6, "2,346")],
)
def test_numbers_have_three_or_four_digits(value: float, text: str) -> None:
    assert number(value) == text


# Reports


def test_the_table_shows_every_figure_with_limit_and_verdict() -> None:
    lines = table({"scan": [FAST, SLOW, PLAIN]}, MACHINE).splitlines()
    assert lines[0] == "interpreter: CPython 3.11, pgo: no, cpus: 2"
    assert lines[2].split() == ["topic", "figure", "median", "min", "max", "unit", "limit"]
    assert lines[4].split() == ["scan", "drivers", "10", "9", "11", "us", "<=", "12", "ok"]
    assert lines[5].split() == ["scan", "control", "11", "9", "14", "us", "<=", "10", "MISSED:", "interlocks"]
    assert lines[6].split() == ["scan", "nodes", "20", "20", "20", "us"]


def test_the_table_ends_with_the_missed_figures() -> None:
    assert table({"scan": [FAST, SLOW], "whole": [BROKEN]}, MACHINE).splitlines()[-3:] == [
        "missed, 2 of 3:",
        "  scan: control",
        "  whole: rig",
    ]


def test_the_table_ends_with_all_well_where_nothing_was_missed() -> None:
    assert table({"scan": [FAST, PLAIN]}, MACHINE).splitlines()[-1] == "all 1 figures with a limit hold"


def test_a_figure_that_a_machine_cannot_measure_has_its_own_line() -> None:
    line = table({"modbus": [ABSENT]}, MACHINE).splitlines()[4]
    assert line.split()[:6] == ["modbus", "pty", "-", "-", "-", "us"]
    assert line.endswith("not available here: this system has no pseudo-terminals")


def test_the_table_in_markdown_has_the_same_cells() -> None:
    lines = as_markdown({"scan": [FAST, SLOW]}, MACHINE).splitlines()
    assert lines[0] == "interpreter: CPython 3.11, pgo: no, cpus: 2"
    assert lines[2:4] == [
        "| topic | figure | median | min | max | unit | limit |  |",
        "|---|---|---:|---:|---:|---|---|---|",
    ]
    assert lines[4] == "| scan | drivers | 10 | 9 | 11 | us | <= 12 | ok |"
    assert lines[-2:] == ["missed, 1 of 2:", "- scan: control"]


def test_a_bar_in_a_note_does_not_end_its_cell() -> None:
    assert as_markdown({"a": [Figure("b", "us", (1.0,), note="c | d")]}, MACHINE).splitlines()[4].endswith("c \\| d |")


def test_json_holds_the_machine_every_run_and_the_missed_figures() -> None:
    record = json.loads(as_json({"scan": [SLOW, ABSENT]}, MACHINE))
    assert record["machine"] == MACHINE
    assert record["missed"] == ["scan: control"]
    slow, absent = record["figures"]
    assert (slow["median"], slow["min"], slow["max"], slow["runs"]) == (11.0, 9.0, 14.0, [14.0, 9.0, 11.0])
    assert (slow["limit"], slow["verdict"]) == ({"kind": "at most", "value": 10.0, "worst": False}, "missed")
    assert (absent["median"], absent["verdict"]) == (None, "unavailable")


def test_missed_names_topic_and_figure() -> None:
    assert missed({"scan": [FAST, SLOW], "pty": [ABSENT]}) == ["scan: control"]


def test_the_machine_line_names_the_interpreter_and_whether_it_was_built_with_pgo() -> None:
    found = machine()
    assert str(found["interpreter"]).startswith(("CPython", "PyPy"))
    assert found["pgo"] in ("yes", "no", "unknown")
    assert isinstance(found["cpus"], int)


# Registry and command line


@pytest.mark.parametrize("name", list(registry.TOPICS))
def test_every_topic_can_be_loaded(name: str) -> None:
    assert callable(registry.TOPICS[name].load())


def test_topics_are_measured_in_the_order_of_the_registry() -> None:
    assert registry.chosen(("model", "scan")) == ["scan", "model"]
    assert registry.chosen(()) == list(registry.TOPICS)


def test_an_unknown_topic_is_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["nonsense"]) == cli.EXIT_USAGE
    assert "no topic 'nonsense'" in capsys.readouterr().err


def stand_in(monkeypatch: pytest.MonkeyPatch, *figures: Figure) -> None:
    """Make the topic model return these figures without measuring."""
    monkeypatch.setattr(model, "measure", lambda effort: list(figures))


def test_exit_code_is_0_where_everything_holds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stand_in(monkeypatch, FAST, PLAIN, ABSENT)
    assert cli.main(["model"]) == 0
    assert "all 1 figures with a limit hold" in capsys.readouterr().out


def test_exit_code_is_1_where_a_figure_misses_and_the_figures_are_printed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stand_in(monkeypatch, FAST, SLOW)
    assert cli.main(["model", "--json"]) == cli.EXIT_MISSED
    assert [one["name"] for one in json.loads(capsys.readouterr().out)["figures"]] == ["drivers", "control"]


def test_figures_come_in_markdown_where_that_is_asked(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stand_in(monkeypatch, FAST)
    assert cli.main(["model", "--markdown"]) == 0
    assert "| model | drivers | 10 | 9 | 11 | us | <= 12 | ok |" in capsys.readouterr().out


def test_a_topic_that_fails_leaves_a_line_and_the_others_continue(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(effort: Effort) -> list[Figure]:
        raise TopicFailedError("the run tripped")

    monkeypatch.setattr(scan_cost, "measure", fail)
    stand_in(monkeypatch, FAST)
    results = cli.measure_all(["scan", "model"], Effort(), lambda _: None)
    assert (results["scan"][0].verdict, results["scan"][0].note) == (Verdict.FAILED, "the run tripped")
    assert results["model"] == [FAST]


# What is measured


def test_a_cheap_topic_gives_as_many_runs_as_asked() -> None:
    figures = model.measure(Effort(runs=2, quick=True))
    assert [len(figure.runs) for figure in figures] == [2] * len(figures)
    assert all(math.isfinite(value) and value > 0.0 for figure in figures for value in figure.runs)


def test_one_compound_of_table_2_has_its_55_conditions_in_five_repeats() -> None:
    recipe = load_checked(one_compound(False), load_rig("sim"), PART, "bench.yaml").recipe
    conditions = conditions_of(recipe, PART.settings)
    assert (len(recipe.specimens), len(conditions), conditions[0].settings.repeats) == (1, 55, 5)


def test_the_shortened_compound_and_the_sliding_recipe_are_valid() -> None:
    for text in (one_compound(True), SLIDING_RECIPE):
        assert len(conditions_of(load_checked(text, load_rig("sim"), PART, "bench.yaml").recipe, PART.settings)) == 1


def test_the_big_recipe_has_as_many_conditions_as_asked() -> None:
    assert [work(text)["found"] for text in (recipe_text(2000), long_list_text(2000))] == [2000, 2000]
    assert recipe_text(100_000).count("mm/s") == 50


def test_every_entry_point_is_found_wrapped_and_given_back() -> None:
    bare = Plant.advance
    with wrapped(Ledger()) as missing:
        assert missing == []
        assert Plant.advance is not bare
    assert Plant.advance is bare
    assert {part for part, *_ in ENTRY_POINTS} | {"nodes: drives, on a frame"} == set(PARTS)


def test_a_run_connects_its_devices_with_every_entry_point_wrapped() -> None:
    ledger = Ledger()
    with wrapped(ledger), live_run(SLIDING_RECIPE) as live:
        live.until(lambda: live.engine.scans > 3)
        charged = dict(zip(PARTS, ledger.take(), strict=True))
    assert all(us > 0.0 for part, us in charged.items() if part != "recorder")  # it has nothing to record yet


def test_the_ledger_charges_each_call_to_its_own_part() -> None:
    ledger = Ledger()
    inner = ledger.wrap("plant", lambda: None)
    ledger.wrap("twin", lambda: [inner() for _ in range(3)])()
    place = {name: i for i, name in enumerate(PARTS)}
    assert [ledger.called[place[name]] for name in ("twin", "plant", "control")] == [1, 3, 0]
    assert ledger.calls[place["twin"]] == 3
    assert len(ledger.take()) == len(PARTS)
    assert sum(ledger.called) == 0


def test_parts_are_summed_in_every_scan_before_the_median_is_taken() -> None:
    def scan(**us: float) -> tuple[float, ...]:
        return tuple(us.get(name.replace(": ", "_"), 0.0) for name in PARTS)

    scans = [scan(control=1.0, executor=9.0), scan(control=9.0, executor=1.0), scan(control=2.0, executor=2.0)]
    found = scan_cost.summary(scans)
    assert (found["control"], found["executor"], found["control + executor + engine"]) == (2.0, 2.0, 10.0)
    assert found["mean"] == 8.0


def test_a_percentile_leaves_out_the_share_above_it() -> None:
    assert lateness.percentile([float(i) for i in range(1, 101)], 0.99) == 99.0
    assert lateness.percentile([float(i) for i in range(1, 201)], 0.99) == 198.0
    assert lateness.percentile([7.0], 0.99) == 7.0
