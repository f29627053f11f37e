"""The lines on every screen: first the state, second the tabs or the top alarm, last the keys with STOP."""

from __future__ import annotations

from typing import Final

from tester.base.words import conditions_done, counted, decimal, duration
from tester.service.protocol import Event
from tester.service.state_view import Alarm, StateView
from tester.tui.formatting import clean, clock_text, fit
from tester.tui.gone import gone_line
from tester.tui.screen_scene import STALE_S, UNDER_WAY, ScreenScene, mode_words
from tester.tui.widgets.panel_base import ABNORMAL, FAINT, NOTICE, WARNING, Panel, Part, Parts, plain, rows

Tabs = tuple[tuple[str, str, str], ...]
TABS: Tabs = (("f2", "Recipes", "recipes"), ("f3", "Run", "run"), ("f4", "Manual", "manual"),
        ("f5", "Results", "results"), ("f6", "Bus", "bus"), ("f7", "Ring", "ring"),
        ("f8", "Queue", "queue"))  # fmt: skip
"""Key, title, id of each screen."""
RING: Final = "ring"
"""Id of the screen that only a machine with a ring has (tester.base.screen.MachineView)."""
CALM_MODES = frozenset({"RUN", "IDLE", "OFFLINE", "ARMED", "CONNECTING", "MANUAL"})
TRIPPED_MODES = frozenset({"FAST STOP", "LATCHED", "E-STOP"})
ALARM_SIGNS = {"active": "■", "acknowledged": "▣", "returned": "◇"}
ALARM_STYLES = {1: ABNORMAL, 2: WARNING, 3: NOTICE}
STOP_KEYS = " F12 STOP "


class StateLine(Panel):
    """Line 1: mode, accepted risk, alarms, condition, repeat, time left and clock at the end, compound."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the line."""
        state = scene.state
        if state is None:
            why = clean(scene.lost) or "looking for the service"
            return [(" NO LINK ", WARNING), fit(f" {why}", width - 9)]
        parts: Parts = [_mode(scene, state), *_link(scene), *_risk(state), "  ", _count(state.alarms)]
        parts += [fit(piece, width) for piece in _where(scene, state, width)]
        return _cut(parts, width)


def _mode(scene: ScreenScene, state: StateView) -> Part:
    text = f" {'REPLAY' if scene.replayed else clean(mode_words(state), 20)} "
    if not scene.linked:
        return text.replace(" ", "?", 1), FAINT
    if state.mode in TRIPPED_MODES:
        return text, ABNORMAL
    return (text, "bold") if state.mode in CALM_MODES or scene.replayed else (text, WARNING)


def _link(scene: ScreenScene) -> Parts:
    if scene.linked:
        return []
    return [(f" NO LINK {max(scene.age_s, STALE_S if not scene.lost else 0.0):.0f} s ", ABNORMAL)]


def _risk(state: StateView) -> Parts:
    """Return the mark of a rig whose safety keys are looser than they should be."""
    return [(" RISK ACCEPTED ", WARNING)] if state.risk else []


def _count(alarms: tuple[Alarm, ...]) -> Part:
    waiting = [alarm for alarm in alarms if alarm.state != "acknowledged"]
    if not alarms:
        return "□ 0 alarms"
    text = f"{'■' if waiting else '▣'} {counted(len(alarms), 'alarm')}"
    return text, ALARM_STYLES[min(alarm.priority for alarm in alarms)] if waiting else NOTICE


def _where(scene: ScreenScene, state: StateView, width: int) -> list[str]:
    """Return the texts that follow mode and alarms, most important first."""
    progress, run = state.progress, state.run
    pieces: list[str] = []
    if progress.conditions:
        pieces.append(f"  {conditions_done(progress.over, progress.conditions, short=True)}")
    if progress.repeats:
        pieces.append(f"  rep {progress.repeat}/{progress.repeats}")
    if progress.steps and progress.left_s is not None:
        end = f" → {clock_text(progress.finish_utc)}" if progress.finish_utc else ""
        pieces.append(f"  left {duration(progress.left_s)}{end}")
    if scene.view_only:
        pieces.append("  view only")
    elif not scene.controls and not scene.replayed:
        who = clean(state.clients.controller, 40)
        pieces.append(f"  watching, {who} controls" if who else "  watching")
    if run is not None and run.compound and run.outcome == UNDER_WAY:
        pieces.append(f"  {clean(run.compound, 20)} {clean(run.note, 30)}".rstrip())
    return pieces


def _cut(parts: Parts, width: int) -> Parts:
    """Return as many whole parts as fit into ``width``."""
    kept: Parts = []
    used = 0
    for part in parts:
        used += len(plain([part]))
        if used > width:
            break
        kept.append(part)
    return kept


class TabLine(Panel):
    """Line 2: the screens, or the top alarm until it is acknowledged."""

    current = "recipes"
    tabs: Tabs = TABS

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the line."""
        gone = gone_line(scene)
        if gone:
            return [(fit(f" ■ {gone}", width).ljust(width), ABNORMAL if scene.gone == "died" else NOTICE)]
        alarm = scene.top_alarm()
        if alarm is not None:
            key = " [r resume] " if alarm.command == "release" else " [a acknowledge] "
            text = fit(f" {alarm_words(alarm)}", width - len(key))
            return [(text.ljust(width - len(key)) + key, ALARM_STYLES[alarm.priority])]
        parts: Parts = []
        for key, title, name in self.tabs:
            if name == RING and not scene.machine.ring:
                continue
            label = f" {key.upper()} {title} "
            parts.append((label, "bold reverse") if name == self.current else label)
        return _cut(parts, width)


def alarm_words(alarm: Alarm) -> str:
    """Return an alarm as a line: name, value, limit, meaning, consequence."""
    text = f"{ALARM_SIGNS[alarm.state]} P{alarm.priority} {clean(alarm.name)}"
    if alarm.value is not None:
        limit = f" (limit {decimal(alarm.limit, 1)})" if alarm.limit is not None else ""
        text += f" {decimal(alarm.value, 1)} {clean(alarm.unit)}{limit}"
    gone = ", gone by itself" if alarm.state == "returned" else ""
    then = f"; {clean(alarm.consequence)}" if alarm.consequence else ""
    return f"{text}: {clean(alarm.text)}{gone}{then}"


class KeyLine(Panel):
    """The last line: the keys that work on this screen, and always STOP."""

    keys: tuple[tuple[str, str], ...] = ()

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the line; STOP comes first, in case there is no room for the other keys."""
        stop: Part = (STOP_KEYS, "bold reverse") if not scene.view_only else " view only: `tester stop` "
        room = width - len(plain([stop]))
        parts: Parts = []
        for key, label in self.keys:
            text = f"  {key} {label}"
            if len(text) > room:
                break
            parts += ["  " if parts else " ", (key, "bold"), f" {label}"]
            room -= len(text)
        return [*parts, " ", stop] if room else [*parts, stop]


SIGNS = {"debug": " ", "info": " ", "warning": "!", "alarm": "■", "trip": "■"}
STYLES = {"debug": FAINT, "info": "", "warning": NOTICE, "alarm": NOTICE, "trip": ABNORMAL}


class EventsPanel(Panel):
    """The alarms, then as many events as there is room for."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return a row for each alarm and each event."""
        lines: list[Parts] = []
        for alarm in scene.alarms()[: height // 2]:
            style = ALARM_STYLES[alarm.priority] if alarm.state != "acknowledged" else NOTICE
            lines.append([(fit(alarm_words(alarm), width), style)])
        newest = [event for event in scene.events if event.severity != "debug"][-(height - len(lines)) :]
        return rows(lines + [event_row(event, width) for event in newest])


def event_row(event: Event, width: int) -> Parts:
    """Return an event as a row: local time of day, sign, text."""
    when = clock_text(event.utc, seconds=True)
    text = fit(f"{when} {SIGNS.get(event.severity, ' ')} {clean(event.text)}", width)
    return [(text, STYLES.get(event.severity, ""))]
