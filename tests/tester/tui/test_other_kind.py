"""A machine unknown to the screens: they draw it from the service's description."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from textual.widgets import OptionList

from tester.base.screen import HandAxis, MachineView, PlotView, Value
from tester.service.commands import Arm, Jog
from tester.service.state_view import ManualView
from tester.tui.gone import death_text
from tests.tester.service.views import HOSTILE
from tests.tester.service.views import state as a_state
from tests.tester.tui.stage import Stage, play

TRACK = MachineView(
    "specimen_on_track",
    ("wall_s", "t_s", "track_mm_s", "drag_n"),
    (PlotView("drag", "drag_n", 1.0), PlotView("track", "track_mm_s", 0.1)),
    ("track", "drag"),
    (HandAxis("track", "Track", "0.1 mm/s a step"), HandAxis("lift", "Lift", f"up or down {HOSTILE}")),
    specimen="block",
    moves="the track",
    look=("Switch the chamber off.",),
)
VALUES = (
    Value("drag", "Drag force", "N", 12.5, None, None, 50.0, None, None, 0.0, 60.0, 1, 0.1, "good"),
    Value("track", "Track speed", "mm/s", 0.4, 0.5, None, 10.0, None, None, 0.0, 11.0, 2, 0.1, "good"),
)


async def shown(on: Stage, *, armed: bool = False) -> None:
    """Start a run on the track."""
    on.fake.machine(TRACK)
    await on.until(lambda: on.app.scene.machine == TRACK, "the tables arrive")
    view = replace(a_state("MANUAL" if armed else "RUN"), values=VALUES, manual=ManualView(60.0 if armed else None, ""))
    for number in range(20):
        on.fake.show(view, (0.25 * number, 0.25 * number, 0.4, 12.0 + number % 3))
    await on.show(view)


def test_the_run_screen_shows_its_values_in_their_order_and_its_trends(tmp_path: Path) -> None:
    async def scene(on: Stage) -> None:
        await on.pilot.press("f3")
        await shown(on)
        text = on.text()
        assert text.index("Drag force") < text.index("Track speed") and "0.40" in text and "mm/s" in text
        assert "Drag force 12.5" in text and "Track speed 0.40 mm/s ╌╌ SP 0.50" in text
        assert "Jacket" not in text and "Slip" not in text

    play(scene, tmp_path, (120, 40))


def test_only_axes_of_the_machine_may_be_moved_by_hand(tmp_path: Path) -> None:
    async def scene(on: Stage) -> None:
        await on.pilot.press("f4")
        await shown(on, armed=True)
        listed = on.app.query_one("#manual-axes", OptionList)
        assert [option.id for option in listed.options] == ["track", "lift"]
        assert "Track        0.1 mm/s a step" in on.text() and "Wheel" not in on.text()
        listed.highlighted = 1
        await on.pilot.press("right")
        assert await on.ordered(Jog) == Jog("lift", 1)
        assert not any(isinstance(order.action, Arm) for order in on.fake.orders)

    play(scene, tmp_path, (120, 40))


def test_when_its_service_dies_the_screen_names_what_must_not_move(tmp_path: Path) -> None:
    async def scene(on: Stage) -> None:
        await shown(on)
        text = death_text(on.app.scene)
        assert "the track must not move" in text and "2. Switch the chamber off." in text and "4. 2024" in text

    play(scene, tmp_path)
