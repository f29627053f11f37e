"""The event log, newest last, and the alarms as a list."""

from __future__ import annotations

from tester.service.protocol import Event
from tester.tui.formatting import clean, clock_text, fit
from tester.tui.scene import ScreenScene
from tester.tui.widgets.head import ALARM_STYLES, alarm_words
from tester.tui.widgets.panel import ABNORMAL, FAINT, NOTICE, Panel, Parts, rows

SIGNS = {"debug": " ", "info": " ", "warning": "!", "alarm": "■", "trip": "■"}
STYLES = {"debug": FAINT, "info": "", "warning": NOTICE, "alarm": NOTICE, "trip": ABNORMAL}


class EventsPanel(Panel):
    """Alarms first, then as many events as there is room for."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return a row an alarm and a row an event."""
        lines: list[Parts] = []
        for alarm in scene.alarms()[: height // 2]:
            style = ALARM_STYLES[alarm.priority] if alarm.state != "acknowledged" else NOTICE
            lines.append([(fit(alarm_words(alarm), width), style)])
        newest = [event for event in scene.events if event.severity != "debug"][-(height - len(lines)) :]
        return rows(lines + [event_row(event, width) for event in newest])


def event_row(event: Event, width: int) -> Parts:
    """Return an event: local time of day, sign, what."""
    when = clock_text(event.utc, seconds=True)
    text = fit(f"{when} {SIGNS.get(event.severity, ' ')} {clean(event.text)}", width)
    return [(text, STYLES.get(event.severity, ""))]
