"""Trends: the past setpoint, rig time below, a line where another run begins."""

from __future__ import annotations

from dataclasses import replace

from tester.base.screen import setpoint_column
from tester.tui.plot import BORDER, WISH
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.panel_base import plain
from tester.tui.widgets.trends_panel import WINDOW_S, Bins, TrendPanel
from tests.tester.service.views import MACHINE, state

LOAD = 2
"""Place of the load among the plots."""


def scene_of(rows: list[tuple[float, float, float, float | None]]) -> ScreenScene:
    """Return a scene whose trend has these rows: wall time, rig time (s), load and its setpoint (N)."""
    scene = ScreenScene(now=lambda: 0.0, state=state(), machine=MACHINE, replayed=True)
    for wall_s, t_s, load_n, setpoint_n in rows:
        known: dict[str, float | None] = dict.fromkeys(MACHINE.trend, None)
        known |= {"wall_s": wall_s, "t_s": t_s, "load_n": load_n, "load_setpoint_n": setpoint_n}
        scene.trend.append(tuple(known[column] for column in MACHINE.trend))
    return scene


def drawn(scene: ScreenScene, width: int = 67, height: int = 10) -> list[str]:
    """Return the lines of the load's trend, whose data have 60 columns."""
    return plain(TrendPanel(LOAD).picture(scene, width, height)).split("\n")


def test_a_setpoint_is_drawn_where_it_was_and_not_over_the_past() -> None:
    rows = [(float(s), float(s), 0.0, 100.0 if s < 300 else 300.0) for s in range(600)]
    lines = drawn(scene_of(rows))
    marked = [{at for at, sign in enumerate(line) if sign == WISH} for line in lines]
    levels = [columns for columns in marked if columns]
    assert len(levels) == 2
    high, low = levels
    assert max(low) < min(high) and abs(len(low) - len(high)) <= 2


def test_rig_time_is_below_the_trend() -> None:
    lines = drawn(scene_of([(float(s), 7000.0 + s, 200.0, 200.0) for s in range(600)]))
    assert lines[-1].split() == ["rig", "1:56:40", "2:01:35", "2:06:35"]


def test_a_line_is_where_another_run_begins_with_its_time_below() -> None:
    rows = [(float(s), 500.0 + s, 200.0, None) for s in range(300)]
    rows += [(300.0 + s, float(s), 100.0, None) for s in range(300)]
    lines = drawn(scene_of(rows))
    columns = {line.index(BORDER) for line in lines[:-1] if BORDER in line}
    assert len(columns) == 1 and 30 < columns.pop() - 7 + 2 < 36
    assert "0:00:0" in lines[-1]


def test_a_value_without_a_setpoint_has_none() -> None:
    assert setpoint_column(MACHINE.trend, "friction") == ""
    assert setpoint_column(MACHINE.trend, "surface_c") == "surface_setpoint_c"


def test_continuing_rig_time_begins_no_run() -> None:
    bins = Bins(2, None, 100, 0)
    for s in range(0, int(WINDOW_S), 5):
        bins.take((float(s), float(s), 1.0))
    assert not any(one.begins for one in bins.bins)


def test_a_low_panel_has_no_axis() -> None:
    scene = scene_of([(float(s), float(s), 200.0, 200.0) for s in range(10)])
    assert len(drawn(scene, height=3)) == 3 and "rig" not in "".join(drawn(scene, height=3))


def test_the_title_has_value_unit_and_setpoint() -> None:
    panel = TrendPanel(LOAD)
    scene = scene_of([(1.0, 1.0, 200.0, 200.0)])
    values = tuple(replace(one, unit="[bold]N") if one.key == "load" else one for one in state().values)
    scene.state = replace(state(), values=values)
    panel.picture(scene, 40, 8)
    assert panel._entitled == f"Load 199.6 [bold]N {WISH}{WISH} SP 200.0"
