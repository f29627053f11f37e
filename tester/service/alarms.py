"""The alarm list: active, acknowledged, returned but not acknowledged (ISA-18.2), three priorities, first-up marked.

An alarm has a name and lasts as long as its cause. It leaves the list once the cause is gone *and* it has been
acknowledged; one of priority 3 leaves with its cause, acknowledged or not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from tester.service.state_view import Alarm

Priority = Literal[1, 2, 3]


@dataclass(frozen=True, slots=True)
class Cause:
    """The cause of an alarm in words and figures. ``consequence``: what happens next; ``command``: the command that
    answers the alarm.
    """

    name: str
    priority: Priority
    text: str
    consequence: str = ""
    command: str = "ack"
    value: float | None = None
    limit: float | None = None
    unit: str = ""


class AlarmList:
    """The alarms of a rig. ``tell`` is called with each change: kind, text, severity."""

    def __init__(self, utc: Callable[[], str], tell: Callable[[str, str, str], None]) -> None:
        """Begin without alarms."""
        self._utc = utc
        self._tell = tell
        self._alarms: dict[str, Alarm] = {}
        self._count = 0

    def __len__(self) -> int:
        """Return the number of alarms in the list."""
        return len(self._alarms)

    def listed(self) -> tuple[Alarm, ...]:
        """Return the list: unacknowledged alarms first, then by priority, then the oldest."""
        return tuple(sorted(self._alarms.values(), key=_urgency))

    def raise_(self, cause: Cause, t_s: float) -> None:
        """Raise an alarm; if it is already active, update its words and figures without a report."""
        old = self._alarms.get(cause.name)
        if old is not None and old.state != "returned":
            if (old.text, old.value) != (cause.text, cause.value):
                self._alarms[cause.name] = replace(old, text=cause.text, value=cause.value, limit=cause.limit)
            return
        self._count += 1
        first = cause.priority == 1 and not any(a.priority == 1 for a in self._alarms.values())
        self._alarms[cause.name] = Alarm(
            self._count, cause.name, cause.priority, "active", cause.text, cause.value, cause.limit, cause.unit,
            cause.consequence, cause.command, first, t_s, self._utc(),
        )  # fmt: skip
        self._tell("alarm", f"{cause.name}: {cause.text}", "warning" if cause.priority > 1 else "alarm")

    def clear(self, name: str) -> None:
        """Record that a cause is gone."""
        alarm = self._alarms.get(name)
        if alarm is None or alarm.state == "returned":
            return
        self._tell("alarm", f"{name}: gone", "info")
        if alarm.state == "acknowledged" or alarm.priority == 3:
            del self._alarms[name]
        else:
            self._alarms[name] = replace(alarm, state="returned")

    def set(self, on: bool, cause: Cause, t_s: float) -> None:
        """Raise the alarm if ``on``, else clear it."""
        if on:
            self.raise_(cause, t_s)
        elif cause.name in self._alarms:
            self.clear(cause.name)

    def acknowledge(self, number: int, by: str) -> int:
        """Acknowledge an alarm by its number (0: all); return how many were acknowledged."""
        count = 0
        for name, alarm in list(self._alarms.items()):
            if number not in (0, alarm.number) or alarm.state == "acknowledged":
                continue
            count += 1
            self._tell("alarm", f"{name}: acknowledged by {by}", "info")
            if alarm.state == "returned":
                del self._alarms[name]
            else:
                self._alarms[name] = replace(alarm, state="acknowledged")
        return count


def _urgency(alarm: Alarm) -> tuple[bool, int, bool, int]:
    return alarm.state == "acknowledged", alarm.priority, not alarm.first_up, alarm.number
