"""Bus: devices with the age of their data and their errors, buses with their load, and frames as they arrive."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar
from zipfile import ZIP_DEFLATED, ZipFile

from pydantic_core import to_json
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import Input

from tester import __version__
from tester.base import clock
from tester.base.trouble import in_words
from tester.base.words import decimal
from tester.service.address import AddressError, folder
from tester.service.commands import WatchFrames
from tester.service.protocol import Frame
from tester.service.state_view import BusView as BusState
from tester.service.state_view import DeviceView
from tester.tui.formatting import clean, fit
from tester.tui.host import Keys, View
from tester.tui.own_service import LOG
from tester.tui.screen_scene import STALE_S, ScreenScene
from tester.tui.widgets.panel_base import FAINT, NOTICE, WARNING, Panel, Parts, rows

LOG_BYTES = 1_000_000
"""Number of bytes to include from the end of the service's log."""


def write_bundle(scene: ScreenScene, stamp: str, where: Path = Path()) -> Path:
    """Write ``support-STAMP.zip`` and return its path; raises OSError."""
    path = where / f"support-{stamp}.zip"
    with ZipFile(path, "x", ZIP_DEFLATED) as bundle:
        bundle.writestr("version.txt", f"{__version__}\n")
        bundle.writestr("state.json", to_json(scene.state, indent=1, inf_nan_mode="null"))
        bundle.writestr("plan.json", to_json(scene.plan, indent=1, inf_nan_mode="null"))
        bundle.writestr("events.jsonl", _lines(scene.events))
        bundle.writestr("frames.jsonl", _lines(scene.frames))
        bundle.writestr("trend.jsonl", _lines([scene.machine.trend, *scene.trend]))
        bundle.writestr("serve.log", _log())
    return path


def _lines(things: Iterable[object]) -> bytes:
    return b"\n".join(to_json(one, inf_nan_mode="null") for one in things)


def _log() -> bytes:
    try:
        return (folder() / LOG).read_bytes()[-LOG_BYTES:]
    except (OSError, AddressError) as error:
        return f"no log of a service started by this screen: {in_words(error)}".encode()


HELP = """\
Devices: state, age of the newest data, requests, errors since the run began and per hour. ✘ is a device that does not
answer. Buses: load and errors. Frames: rig time, bus, direction, address, bytes in hex.

f     freeze the frames, and let them run again.
/     show only frames with this text (bus, address in hex, bytes); Esc shows all.
b     support bundle: a zip file with state, events, plan, frames and the service's log, to send for help.
"""


class DevicesPanel(Panel):
    """A table with a row for each device."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the table."""
        devices = scene.state.devices if scene.state is not None else ()
        if not devices:
            return [("no rig is connected: a run or manual mode connects it", FAINT)]
        hourly = f"{'/h':>7}" if width >= HOURLY_FROM else ""
        head = f"  {'device':<11} {'bus':<9} {'at':>3} {'age':>8} {'requests':>9} {'errors':>6}{hourly}  state"
        return rows([[(fit(head, width), "bold")], *(device_row(device, width) for device in devices[: height - 1])])


HOURLY_FROM = 90
"""Width from which the errors per hour are shown next to a drive's state, columns."""


def device_row(one: DeviceView, width: int) -> Parts:
    """Return a device as a row."""
    age = "—" if one.age_s is None else f"{one.age_s:.3f} s"
    hourly = f"{one.errors_per_hour:>7.1f}" if width >= HOURLY_FROM else ""
    text = (
        f"{'✔' if one.online else '✘'} {clean(one.name):<11} {clean(one.bus):<9} {one.address:>3} {age:>8} "
        f"{one.requests:>9} {one.errors:>6}{hourly}  {clean(one.state)} {clean(one.detail)}"
    ).rstrip()
    old = one.age_s is not None and one.age_s > STALE_S
    return [(fit(text, width), WARNING if not one.online else FAINT if old else NOTICE if one.errors else "")]


class BusesPanel(Panel):
    """A table with a row for each bus; the title shows how punctual the scan is."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the table."""
        if scene.state is None:
            return []
        tick = scene.state.tick
        late = f"{1e3 * tick.late_s:.1f} ms late, at most {1e3 * tick.late_max_s:.1f}"
        self.entitle(fit(f"Buses ── scan {tick.rate_hz:g} Hz, {late}, {tick.overruns} overruns", width - 2))
        return rows([[fit(bus_row(bus), width)] for bus in scene.state.buses[:height]])


def bus_row(one: BusState) -> str:
    """Return a bus as a row."""
    load = f"{decimal(one.load_percent, 1)} %" if one.load_percent is not None else "load unknown"
    return f"{clean(one.name):<9} {one.kind:<7} {load:>12}  {one.errors} errors  {clean(one.detail)}"


class FramesPanel(Panel):
    """The newest frames, or those at the moment of freezing."""

    frozen: tuple[Frame, ...] | None = None
    wanted = ""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return a row for each frame."""
        source = self.frozen if self.frozen is not None else scene.frames
        lines = [frame_row(frame) for frame in source]
        if self.wanted:
            lines = [line for line in lines if self.wanted in line.lower()]
        seen = f"{scene.frames_seen} seen, {scene.frames_dropped} not shown"
        head = f"{'FROZEN' if self.frozen is not None else 'live'}, {seen}" + (
            f", with {self.wanted}" if self.wanted else ""
        )
        shown: list[Parts] = [[fit(line, width)] for line in lines[-max(height - 1, 0) :]]
        return rows([[(fit(clean(head), width), NOTICE if self.frozen is not None else "bold")], *shown])


def frame_row(frame: Frame) -> str:
    """Return a frame as a row."""
    return f"{frame.t_s:12.4f} {clean(frame.bus):<8} {'>' if frame.sent else '<'} {frame.ident:4X}  {clean(frame.data)}"


class BusPage(View, can_focus=True):
    """The traffic on the wires."""

    KEYS: ClassVar[Keys] = (("f", "Freeze"), ("/", "Filter"), ("b", "Bundle"), ("space", "Hold"), ("a", "Ack"),
                            ("F1", "Help"), ("q", "Detach"))  # fmt: skip
    HELP: ClassVar[str | None] = HELP
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f", "freeze", "Freeze", show=False),
        Binding("slash", "filter", "Filter", show=False),
        Binding("escape", "unfilter", "All", show=False),
        Binding("b", "bundle", "Bundle", show=False),
    ]

    def __init__(self, *, id: str) -> None:  # noqa: A002 - as in Textual
        """Request no frames yet."""
        super().__init__(id=id)
        self._epoch = 0

    def compose(self) -> ComposeResult:
        """Lay out the tables."""
        yield DevicesPanel(id="devices", classes="box", title="Devices")
        yield BusesPanel(id="buses", classes="box")
        yield Input(id="filter", placeholder="frames with this text", compact=True, max_length=40)
        yield FramesPanel(id="frames", classes="box", title="Frames")

    def enter(self) -> None:
        """Request the frames."""
        super().enter()
        self._epoch = self.host.scene.epoch
        self._watch(on=True)

    def show(self, scene: ScreenScene) -> None:
        """Request the frames again after a reconnection."""
        if scene.epoch != self._epoch:
            self._epoch = scene.epoch
            self._watch(on=True)
        super().show(scene)

    def leave(self) -> None:
        """Stop the frames, which cost time and are no longer visible."""
        self._watch(on=False)

    def _watch(self, *, on: bool) -> None:
        if self.host.link is not None and self.host.link.client is not None and not self.host.options.view_only:
            self.host.order(WatchFrames(on))

    def action_freeze(self) -> None:
        """Freeze the frames, or show new ones again."""
        panel = self.query_one(FramesPanel)
        panel.frozen = tuple(self.host.scene.frames) if panel.frozen is None else None
        panel.redraw()

    def action_filter(self) -> None:
        """Ask for the text that filters the frames."""
        entry = self.query_one("#filter", Input)
        entry.add_class("-open")
        entry.focus()

    def action_unfilter(self) -> None:
        """Show all frames."""
        entry = self.query_one("#filter", Input)
        entry.value = ""
        entry.remove_class("-open")
        self.focus()

    def on_input_changed(self, event: Input.Changed) -> None:
        """Filter while the text is typed."""
        panel = self.query_one(FramesPanel)
        panel.wanted = event.value.strip().lower()
        panel.redraw()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Move the focus out of the field."""
        event.stop()
        self.focus()

    def action_bundle(self) -> None:
        """Write the support bundle, and show its path."""
        try:
            path = write_bundle(self.host.scene, clock.local_stamp())
        except OSError as error:
            self.host.say(f"no bundle: {in_words(error)}", problem=True)
        else:
            self.host.say(f"support bundle: {path}", lasting=True)
