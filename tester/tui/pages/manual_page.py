"""Manual: armed explicitly. A key press is one bounded step, which the service accepts or refuses."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from tester.base.screen import HandAxis
from tester.service.commands import Arm, Jog, Tare
from tester.service.state_view import StateView
from tester.tui.formatting import clean
from tester.tui.host import Keys, View
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.head import EventsPanel
from tester.tui.widgets.panel_base import FAINT, WARNING, Panel, Part, Parts, rows
from tester.tui.widgets.values_panel import value_row

COMMISSIONING = "load cell, scales, directions: c commissions the rig"
SIGN_S = 0.25
"""Period of signs of life, s; a second without one ends manual mode."""
SOON_S = 15.0
"""Time left below which a warning is shown, s."""
HELP = """\
Manual mode moves the rig in bounded steps. A terminal cannot see a key being released: one press is one step, never
more than five a second. Limits and interlocks are those of a run.

m         arm manual mode, or disarm it. It disarms 60 s after the last step, and when this screen is left.
up, down  choose an axis.     right or +, left or -   one step up, one step down.
t         zero (tare) of the load cell: lifted and at rest. Shows the old and the new zero.
F12       STOP also stops manual motion, F9 is a fast stop. A screen that hangs for 1 s ends the mode.
c         commission the rig: directions, scales, load cell, first contact, step by step and recorded. Opens the screen
          of `tester commission RIG --tui` at the first open step, while no run is on.
"""


class ArmedPanel(Panel):
    """Whether manual mode is armed, for how long, and the result of the last tare."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return some lines."""
        state = scene.state
        if state is None:
            return []
        lines: list[Parts] = [[armed_words(state)]]
        if state.manual.tare:
            text = f"Zero: {clean(state.manual.tare)}"
            for at in range(0, len(text), max(width, 1)):
                lines.append([text[at : at + width]])
        return rows(lines[:height])


def armed_words(state: StateView) -> Part:
    """Return whether manual mode is armed, in words."""
    left_s = state.manual.left_s
    if left_s is None:
        busy = state.mode not in ("OFFLINE", "IDLE", "INTERRUPTED")
        return ("not armed: a run has the rig", FAINT) if busy else ("not armed: m arms it", FAINT)
    return f"ARMED, disarms in {left_s:.0f} s", WARNING if left_s < SOON_S else "bold reverse"


class ManualValues(Panel):
    """The values that a person can change in manual mode."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return a row for each value."""
        values = [value for key in scene.machine.by_hand if (value := scene.value(key)) is not None]
        return rows([value_row(value, width, linked=scene.linked) for value in values[:height]])


class ManualPage(View):
    """Manual jogging, zeroing and heating."""

    axes: tuple[HandAxis, ...] = ()
    """The machine's axes, in the order of the list."""

    KEYS: ClassVar[Keys] = (("m", "Arm"), ("↑↓", "Axis"), ("←→", "Step"), ("t", "Tare"), ("a", "Ack"),
                            ("F1", "Help"), ("q", "Detach"))  # fmt: skip
    HELP: ClassVar[str | None] = HELP
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("m", "arm", "Arm", show=False),
        Binding("t", "tare", "Tare", show=False),
        Binding("c", "app.commission", "Commission", show=False),
        Binding("right,plus,equals_sign", "jog(1)", "Step up", show=False),
        Binding("left,minus", "jog(-1)", "Step down", show=False),
    ]

    def compose(self) -> ComposeResult:
        """Lay out values, axes, state."""
        values = ManualValues(id="manual-values", classes="box", title="Values")
        values.border_subtitle = COMMISSIONING
        yield values
        with Horizontal():
            axes = OptionList(id="manual-axes", markup=False)
            axes.border_title = "Axis"
            yield axes
            with Vertical():
                yield ArmedPanel(id="manual-state", classes="box", title="Manual mode")
                yield EventsPanel(id="manual-events", classes="box", title="Events")

    def on_mount(self) -> None:
        """Begin to send signs of life."""
        self.set_interval(SIGN_S, self._give_sign)

    def show(self, scene: ScreenScene) -> None:
        """Show the scene, and the axes of its machine."""
        super().show(scene)
        if scene.machine.hand != self.axes:
            self.axes = scene.machine.hand
            listed = self.query_one("#manual-axes", OptionList)
            words = [(f"{clean(axis.title):<12} {clean(axis.step)}", axis.name) for axis in self.axes]
            listed.set_options([Option(Content(text), id=name) for text, name in words])
            listed.highlighted = 0 if self.axes else None

    def _give_sign(self) -> None:
        """Send a sign of life. The drawing loop calls this, so that a screen that hangs sends none."""
        link = self.host.link
        if self.display and self.host.scene.controls and link is not None and link.client is not None:
            link.client.attend()

    def take_focus(self) -> None:
        """Focus the axes."""
        self.query_one("#manual-axes").focus()

    def leave(self) -> None:
        """Disarm: a hidden screen must not move the rig."""
        if self.armed and self.host.scene.controls:
            self.host.order(Arm(on=False), "manual mode disarmed")

    @property
    def armed(self) -> bool:
        """Return whether manual mode is armed."""
        state = self.host.scene.state
        return state is not None and state.manual.left_s is not None

    def action_arm(self) -> None:
        """Arm manual mode, or disarm it."""
        self.host.order(Arm(on=not self.armed), "manual mode disarmed" if self.armed else "manual mode armed")

    def action_tare(self) -> None:
        """Zero the load cell."""
        self.host.order(Tare(), "zero of the load cell begins")

    def action_jog(self, direction: int) -> None:
        """Take one step of the chosen axis."""
        at = self.query_one("#manual-axes", OptionList).highlighted
        if at is None:
            return
        if not self.armed:
            self.host.say("not armed: m arms manual mode")
            return
        self.host.order(Jog(self.axes[at].name, 1 if direction > 0 else -1))
