"""The air at the specimen: the chamber reaches a set point and stands by, and a second thermometer agrees."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan
from typing import Any, Final

from drivers.temperature_controller import CHAMBER_RENEW_S
from tester.inputs.rig import Rig
from tester.kinds.specimen_on_track.commission.seats import TrackSeat, jog_seat
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, choose, mean_of
from tester.machine.commission.lease import LEASE_MORE_S, left_alone
from tester.machine.commission.quiet_seat import JogSeat
from tester.machine.commission.stages import in_stages, measured_twice
from tester.machine.rig_ports import Ports

WARMER_K: Final = 5.0
"""The set point is this much above the air around the rig [A]: any chamber reaches it within minutes."""
REACHED_K: Final = 0.5
STAYS_S: Final = 20.0
"""Reached: so near to the set point, for so long [A]."""
AT_MOST_S: Final = 600.0
FOLLOWS_K, FOLLOWS_S = 1.0, 100.0
"""A chamber that heats has warmed the air by so much after this time [A]: half a kelvin a minute is enough."""
OFFSET_K: Final = 2.0
"""Greatest difference of two thermometers [A]: 1 K of sensors and layers of the air on either side."""
STANDBY_S: Final = 5.0
"""Time for a chamber's output to end in standby, s [A]."""
AVERAGE_S: Final = 5.0


def air_seat(rig: Rig, ports: Ports, hands: Any) -> TrackSeat | JogSeat:
    """Connect the rig: armed if there is a chamber to be commanded."""
    return TrackSeat(rig, ports, hands) if TrackConfig.of(rig).chamber else jog_seat(rig, ports, hands)


def set_point_c(rig: TrackConfig) -> float:
    """Return the air's temperature of the first steps, degC."""
    if not rig.chamber:
        return rig.ambient_c
    return min(max(rig.ambient_c + WARMER_K, rig.limits.air_low_c), rig.limits.air_high_c)


def air(seat: TrackSeat | JogSeat, notes: Notes) -> Dialogue:
    """Temper the air if there is a chamber, and compare the thermometers; raises StepRefused."""
    if isinstance(seat, TrackSeat):
        r = seat.ctx.readings
        yield from in_stages(
            notes, _close, lambda: _temper(seat, notes), lambda: _compare(notes, "air", lambda: r.air_c),
            lambda: _stand_by(seat, notes),
        )  # fmt: skip
        return
    sensors = {"air": seat.devices.thermometer, "pyrometer": seat.devices.pyrometer}

    def compare(name: str, sensor: Any) -> Callable[[], Dialogue]:
        return lambda: _compare(notes, name, lambda: sensor.values[0] if sensor.valid else nan)

    yield from in_stages(notes, *(compare(name, one) for name, one in sensors.items() if one is not None))


def _close() -> Dialogue:
    text = "a second thermometer's sensor beside the specimen, the chamber closed; done?"
    yield from choose("chamber closed", text, "yes")


def _temper(seat: TrackSeat, notes: Notes) -> Dialogue:
    """Bring the air to the set point."""
    wanted_c, r = set_point_c(seat.rig), seat.ctx.readings
    began_c, began_s, near_s = r.air_c, inf, inf
    seat.ctx.demand.chamber_c = wanted_c
    text = f"asked for {wanted_c:.1f} degC"

    def reached(now_s: float) -> bool:
        nonlocal began_s, near_s
        began_s = min(began_s, now_s)
        near = abs(r.air_c - wanted_c) <= REACHED_K
        near_s = min(near_s, now_s) if near else inf
        if now_s - began_s > FOLLOWS_S and not near and not abs(r.air_c - began_c) >= FOLLOWS_K:
            raise StepRefused(
                f"chamber: {text}, its air was at {began_c:.1f} degC and is at {r.air_c:.1f} degC after"
                f" {FOLLOWS_S:g} s: it does not heat, or its sensor is not in its air"
            )
        if now_s - began_s > AT_MOST_S:
            raise StepRefused(f"chamber: {text}, its air is at {r.air_c:.1f} degC after {AT_MOST_S / 60:g} min")
        return now_s - near_s >= STAYS_S

    yield reached
    took_s = seat.ctx.now - began_s
    notes.read("set point reached", {"set_point_c": wanted_c, "air_c": r.air_c, "took_s": took_s})
    notes.values |= {"set_point_c": wanted_c, "took_s": round(took_s, 1)}


def _compare(notes: Notes, name: str, reading: Callable[[], float]) -> Dialogue:
    """Compare a temperature with what a second instrument shows."""
    shown = yield from mean_of(reading, AVERAGE_S)
    where = "of the track at rest and cold, where the pyrometer looks" if name == "pyrometer" else "beside the specimen"
    text = f"{name}: the rig reads {shown:.1f} degC; what does a second thermometer show {where}?"
    read = yield from measured_twice(
        f"second {name}", text, "degC", lambda c: "" if abs(c - shown) <= OFFSET_K else f"{c - shown:+.1f} K off"
    )
    offset = shown - read
    notes.read(f"{name}: second thermometer", {"shown_c": shown, "read_c": read})
    if not abs(offset) <= OFFSET_K:
        raise StepRefused(
            f"thermometer offset: the {name} reads {offset:+.1f} K against the second instrument, at most"
            f" {OFFSET_K:g} K: the sensor's type and wires at its device, its place in the air, or a lens"
        )
    notes.values[f"{name}_offset_k"] = offset
    notes.values[f"{name}_c"] = shown
    notes.text = "; ".join([*([notes.text] if notes.text else []), f"{name} {offset:+.2f} K off a second thermometer"])


def _stand_by(seat: TrackSeat, notes: Notes) -> Dialogue:
    """Put the chamber in standby: its output has to end."""
    seat.ctx.demand.chamber_c = nan
    r, began_s = seat.ctx.readings, inf

    def off(now_s: float) -> bool:
        nonlocal began_s
        began_s = min(began_s, now_s)
        if now_s - began_s > STANDBY_S:
            raise StepRefused(f"chamber: in standby it still gives {r.chamber_percent:g} % of its output")
        return now_s - began_s >= 1.0 and r.chamber_percent == 0.0

    yield off
    values = notes.values
    notes.text = f"{values['set_point_c']:g} degC reached in {values['took_s']:.0f} s; {notes.text}; standby"


def lease(seat: JogSeat, notes: Notes) -> Dialogue:
    """Send the running chamber nothing: its own lease must end its output; raises StepRefused."""
    chamber = seat.devices.chamber
    if chamber is None:
        notes.text = "no chamber"
        return

    def trial() -> Dialogue:
        asked_c = chamber.measured_c  # as it is: hardly any output
        ended = yield from left_alone(
            "chamber", chamber, chamber.ends_s, asked_c, lambda renews: None, notes, LEASE_MORE_S + CHAMBER_RENEW_S
        )
        notes.values = {"ended": ended}
        notes.text = f"chamber: {ended}"

    yield from in_stages(notes, trial)
