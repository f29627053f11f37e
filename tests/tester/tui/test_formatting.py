"""Drawn numbers, times, bars and plots."""

from __future__ import annotations

from dataclasses import replace

from tester.tui.filters import ascii_text
from tester.tui.formatting import clean, fit, reflow
from tester.tui.plot import Canvas, PlotRange, Point, round_step, scatter
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.values_panel import bar, beyond
from tests.tester.service.views import HOSTILE, value


def test_invisible_characters_are_replaced_one_for_one() -> None:
    assert clean(HOSTILE) == "[/x] [bold]�[31m�$(rm) ' \" <b> �"
    assert len(clean("a\x1b\u202eb\tc")) == 6


def test_a_help_text_fills_its_lines_and_indents_the_action_of_a_key() -> None:
    text = "One line of a\nparagraph.\n\nspace  HOLD: lift and wait\nq      leave\n"
    assert reflow(text, 18) == "One line of a\nparagraph.\n\nspace  HOLD: lift\n       and wait\nq      leave"


def test_fit_marks_the_cut() -> None:
    assert (fit("abcdef", 6), fit("abcdef", 4), fit("abcdef", 0)) == ("abcdef", "abc…", "")


def test_a_bar_has_limit_setpoint_band_and_value() -> None:
    one = replace(value("load", "Load", "N", 30.0, 50.0, 100.0), low=10.0, band_low=45.0, band_high=55.0)
    assert bar(one, 21) == "──├───●──═┼═──────┤──"


def test_a_value_outside_the_bar_points_there() -> None:
    one = value("load", "Load", "N", 300.0, None, 100.0)
    assert bar(one, 11) == "─────────┤▶"
    assert beyond(one) == "HIGH" and beyond(replace(one, value=-1.0, low=0.0)) == "LOW"
    assert beyond(replace(one, value=None)) == ""


def test_a_range_grows_at_once_and_shrinks_late() -> None:
    scale = PlotRange(least=1.0)
    scale.cover(10.0, 20.0)
    first = (scale.low, scale.high)
    scale.cover(12.0, 17.0)
    assert (scale.low, scale.high) == first
    scale.cover(12.0, 31.0)
    assert scale.high >= 31.0
    scale.cover(15.0, 15.5)
    assert scale.high - scale.low < 4.0


def test_round_steps() -> None:
    assert [round_step(x) for x in (0.3, 1.0, 1.1, 6.0)] == [0.5, 1.0, 2.0, 10.0]


def test_dots_stand_where_the_values_are() -> None:
    canvas = Canvas(2, 1)
    scale = PlotRange(0.0, 3.0)
    canvas.bins([(0.0, 0.0), (3.0, 3.0), (0.0, 3.0)], scale)
    assert canvas.lines() == ["\N{BRAILLE PATTERN DOTS-8}\N{BRAILLE PATTERN DOTS-14568}"]


def test_a_setpoint_is_drawn_where_there_is_no_data() -> None:
    canvas = Canvas(3, 3, plain=True)
    scale = PlotRange(0.0, 2.0)
    canvas.level(1.0, "-", scale)
    canvas.bins([(1.0, 1.0)], scale)
    assert canvas.lines() == ["   ", "--*", "   "]


def test_a_scatter_labels_its_ends_and_marks_several_points_as_one() -> None:
    lines = scatter([Point(100.0, 0.8, "1"), Point(200.0, 0.7, "1"), Point(200.0, 0.7, "2")], 30, 6)
    assert "100" in lines[-1] and "200" in lines[-1]
    assert sum(line.count("+") for line in lines) == 1


def test_ascii_keeps_the_width() -> None:
    assert ascii_text("├──●──┤ 40.4 °C µ 温") == "+--o--+ 40.4 'C u ??"


def test_a_scene_without_a_service_has_nothing_to_believe() -> None:
    scene = ScreenScene(now=lambda: 5.0)
    assert not scene.linked and scene.top_alarm() is None and scene.value("load") is None
