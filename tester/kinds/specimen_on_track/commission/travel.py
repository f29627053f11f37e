"""The travel of a linear track: each end switch opens the safety chain, and the soft ends are far enough before them.

A switch is tried by hand, without power. Then the track goes to each soft end at its greatest speed, where a person
measures what is left to the switch. A switch that opens on the way ends the move.
"""

from __future__ import annotations

from functools import partial
from typing import Any, Final

from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, choose, press, wait
from tester.machine.commission.quiet_seat import JogSeat
from tester.machine.commission.stages import in_stages, measured_twice
from tester.machine.devices import INPUT_SAFETY_CHAIN

SEEN_S: Final = 1.0
"""Time for an input to arrive after a person has moved a switch, s [A]: inputs come every 100 ms."""
ENDS: Final = ("low", "high")
LATE_S: Final = 0.25
"""From a track beyond its end to its stop, s [A]: two scans, and an axis that comes late."""
MARGIN_MM: Final = 1.0
"""What a ruler and the switch itself are uncertain by, mm [A]."""
SLOWER: Final = 1.3
"""A move may last this much longer than its way takes at its speed [A]."""


def travel(seat: JogSeat, notes: Notes) -> Dialogue:
    """Try switches and ends; raises StepRefused."""
    rig = TrackConfig.of(seat.believed)
    if not rig.linear:
        notes.text = "a disc has no ends"
        return
    trial = _TravelTrial(seat, rig, notes)
    switches = (partial(trial.switch, end) for end in ENDS)
    ends = (stage for end in ENDS for stage in (partial(trial.go, end), partial(trial.left, end)))
    yield from in_stages(notes, *switches, *ends, trial.middle, trial.conclude)


class _TravelTrial:
    """The stages of the trial."""

    def __init__(self, seat: JogSeat, rig: TrackConfig, notes: Notes) -> None:
        """Move nothing yet."""
        self.seat, self.rig, self.notes = seat, rig, notes
        self.drive = seat.jogging.drive("track")
        self.mm = 1e3 * rig.metres
        """mm in the drive's unit of length."""
        self.ends_mm = {"low": rig.limits.travel_low_mm, "high": rig.limits.travel_high_mm}
        self.left_mm: dict[str, float] = {}

    @property
    def needed_mm(self) -> float:
        """Least way from a soft end to its switch, mm: tripped beyond the end, the track still has to stop."""
        rig = self.rig
        speed = 1e3 * rig.limits.track_speed_m_s
        stop_mm = speed * speed / (2.0 * self.mm * rig.axes.track.quick_stop_deceleration)
        return rig.interlocks.beyond_mm + speed * LATE_S + stop_mm + MARGIN_MM

    def switch(self, end: str) -> Dialogue:
        """Let the person work a switch by hand: the safety chain has to open, and to close again."""
        text = f"hold the end switch at the {end} end of the travel by hand; is it held?"
        yield from choose(f"switch {end} held", text, "yes")
        yield from wait(SEEN_S)
        if self._closed():
            raise StepRefused(
                f"the end switch at the {end} end does not open the safety chain (input 16 of the track's drive,"
                " 0x60FD): its wires, or a switch that sticks. A track that passes its end would hit the stop"
            )
        yield from choose(f"switch {end} free", f"let the end switch at the {end} end go; is it free?", "yes")
        yield from wait(SEEN_S)
        if not self._closed():
            raise StepRefused(
                f"the safety chain stays open after the end switch at the {end} end was let go: reset the chain, or"
                " look for another contact that is open"
            )

    def _closed(self) -> bool:
        return bool(self.seat.devices.io.inputs & INPUT_SAFETY_CHAIN)

    def go(self, end: str) -> Dialogue:
        """Move to a soft end."""
        yield from self._move(end, self.ends_mm[end])

    def _move(self, where: str, to_mm: float) -> Dialogue:
        seat, speed = self.seat, self.rig.limits.track_speed_m_s / self.rig.metres
        text = f"track: arm raised, hands off, guard closed; it goes to {to_mm:g} mm at {self.mm * speed:g} mm/s"
        yield from press(f"travel {where}", text, seat.guarded)
        way = to_mm / self.mm - self.drive.actual
        jog = seat.jogging.begin("track", way, speed, most_s=1.0 + SLOWER * abs(way) / speed, opens=True)
        yield lambda now_s: jog.over
        at_mm = self.mm * self.drive.actual
        if jog.opened:
            inside = at_mm - self.needed_mm if to_mm > self._middle_mm else at_mm + self.needed_mm
            raise StepRefused(
                f"end of the travel: the safety chain opened at {at_mm:.1f} mm, before limits.travel_{where} of"
                f" {to_mm:g} mm. Unless the emergency stop was pressed: the travel is"
                f" shorter, or the zero of the drive's position differs from the file. In the rig file:"
                f" limits.travel_{where}: {inside:.0f} mm"
            )
        if not abs(at_mm - to_mm) <= self.rig.interlocks.beyond_mm:
            raise StepRefused(f"the track came to {at_mm:.1f} mm, asked for {to_mm:g} mm: something holds it")

    def left(self, end: str) -> Dialogue:
        """Ask for the way that is left to the switch."""
        needed = self.needed_mm
        text = f"track at its {end} end: how far is it from here until the end switch acts?"
        left = yield from measured_twice(
            f"left {end}", text, "mm", lambda mm: "" if needed <= mm else f"at least {needed:.1f} mm are needed"
        )
        self.left_mm[end] = left
        if not left >= needed:
            sign = -1.0 if end == "high" else 1.0
            right = self.ends_mm[end] + sign * (needed - left)
            raise StepRefused(
                f"end of the travel: {left:g} mm from limits.travel_{end} to its switch, at least {needed:.1f} mm are"
                f" needed to stop before it. In the rig file: limits.travel_{end}: {right:.0f} mm"
            )

    @property
    def _middle_mm(self) -> float:
        return 0.5 * (self.ends_mm["low"] + self.ends_mm["high"])

    def middle(self) -> Dialogue:
        """Move back to the middle of the travel."""
        yield from self._move("middle", self._middle_mm)

    def conclude(self) -> Dialogue:
        """Record what was found."""
        left: dict[str, Any] = {f"left_{end}_mm": mm for end, mm in self.left_mm.items()}
        self.notes.values = {**left, "needed_mm": self.needed_mm}
        self.notes.text = "both end switches open the safety chain; " + ", ".join(
            f"{mm:g} mm from the {end} end to its switch" for end, mm in self.left_mm.items()
        )
        yield from ()
