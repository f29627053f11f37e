"""Probes of the Modbus lines and of their devices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite, nan
from statistics import median

from drivers.modbus.request import REPLIES
from drivers.profiles.numbers import ORDERS
from drivers.profiles.registers import RegisterBlock, Signal
from tester.doctor.bus_watch import UnitWatch
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, fault, note, ok, warning
from tester.doctor.line_survey import LineSurvey, UnitSurvey
from tester.inputs.rig import LineConfig
from tester.inputs.rig.further_sensors import title_of
from tester.machine.line_speed import needed_s

READINGS_S = 40.0
"""Least rate of readings from a device that is read in every scan, readings a second."""
LATE_S = 0.008
"""An answer that exceeds the profile's longest time by this much was delayed on its way, s [A]."""
LATENCY_TIMER_S = (0.01, 0.02)
"""Delays that a USB adapter's latency timer of 16 ms adds to an answer, s [A]: less or more has another cause."""
FAILED_MOST = 0.01
"""Greatest acceptable share of failed questions on a line [A]."""


def lines(e: Examination) -> Iterator[Finding]:
    """Check that each line works, and report the settings at which its devices answer."""
    for name, line in e.lines.items():
        config = e.rig.lines[name]
        settings = f"{config.baud} baud, parity {config.parity}" if config.framing == "rtu" else config.port
        subject = f"line {name}"
        if line.hears_itself:
            yield note(subject, "the adapter hears itself (RS-485 echo); its echo is removed here and in a run")
        if line.lost:
            yield fault(subject, line.lost, "the adapter, its name in the rig file, whether another program uses it")
        elif line.answers_at is not None:
            actual = line.answers_at
            other = _exchanged_with(e, name)
            if other:
                yield fault(
                    subject,
                    f"answers at the settings of line {other}, which answers at this one's: exchanged adapters",
                    f"exchange the plugs, or lines.{name}.port and lines.{other}.port",
                )
                continue
            what = "baud rate" if actual.baud != config.baud else "parity"
            yield fault(
                subject,
                f"wrong {what}: devices answer at {actual.baud} baud, parity {actual.parity}, not at {settings}",
                f"set lines.{name} to baud: {actual.baud} and parity: {actual.parity}, or the devices",
            )
        elif line.units and not any(unit.there for unit in line.units.values()) and not line.others:
            noise = b"".join(unit.noise for unit in line.units.values())
            what_came = f"{len(noise)} bytes that are no answer" if noise else "silent"
            yield fault(
                subject, f"{what_came} at {settings}",
                "supply of the devices, wires A and B exchanged, terminators, baud rate, parity",
            )  # fmt: skip
        else:
            yield ok(subject, settings)


def _exchanged_with(e: Examination, name: str) -> str:
    """Return the line whose devices appear to be exchanged with this line's; "" if there is none."""
    config, settings = e.rig.lines[name], e.lines[name].answers_at
    for other, line in e.lines.items():
        other_settings = line.answers_at
        if other == name or settings is None or other_settings is None:
            continue
        if _alike(settings, e.rig.lines[other]) and _alike(other_settings, config):
            return other
    return ""


def _alike(one: LineConfig, other: LineConfig) -> bool:
    return (one.baud, one.parity) == (other.baud, other.parity)


def devices(e: Examination) -> Iterator[Finding]:
    """Compare every device with its profile."""
    for line_name, line in e.lines.items():
        if line.lost or line.answers_at is not None:
            continue
        for key, unit in line.units.items():
            name = title_of(e.rig, key)
            if not unit.there:
                yield _silent(e, line_name, line, key, name, unit)
                continue
            refusals = list(_refusals(name, unit))
            yield from refusals
            if not refusals:
                yield from _values(name, unit)
                yield from _settings(name, unit)


def _silent(e: Examination, line_name: str, line: LineSurvey, key: str, name: str, unit: UnitSurvey) -> Finding:
    number = unit.config.unit_id
    alike = [other for other, found in line.looks_like.items() if found == key]
    if alike:
        return fault(
            name, f"nothing answers at unit id {number} of line {line_name}; unit {alike[0]} has its registers",
            f"set devices.{key}.unit_id to {alike[0]}, or the device to {number}",
        )  # fmt: skip
    if unit.noise:
        return fault(
            name, f"unit id {number} of line {line_name} answers with noise: {unit.blocks[0].describe()}",
            "two devices of one unit id, parity, terminators, shielding",
        )  # fmt: skip
    others = [
        other for other, survey in e.lines.items()
        if other != line_name and any(found.config.unit_id != number for found in survey.units.values())
        and number in survey.others
    ]  # fmt: skip
    if others:
        return fault(
            name, f"nothing answers at unit id {number} of line {line_name}; line {others[0]} has a unit {number}",
            f"the device is on another line than in the rig file: change devices.{key}.line, or the plugs",
        )  # fmt: skip
    return fault(name, f"nothing answers at unit id {number} of line {line_name}", "its supply, its plug, its unit id")


def _refusals(name: str, unit: UnitSurvey) -> Iterator[Finding]:
    """Report registers of the profile that the device lacks, or that the device is of another type."""
    profile = unit.profile
    wrong = f"is it a {profile.title}? Correct the profile of the device in the rig file, or the device"
    identity = unit.configuration.get("device type")
    if identity is not None and identity.ok and profile.identity is not None:
        value = int.from_bytes(identity.data[:2], "big")
        if value != profile.identity.value:
            yield fault(
                name, f"wrong device or profile: its type register holds {value}, {profile.name} has"
                f" {profile.identity.value}", wrong,
            )  # fmt: skip
            return
    asked = [(f"registers {answer.question.address} to {answer.question.address + answer.question.count - 1}", answer)
             for answer in unit.blocks] + list(unit.configuration.items())  # fmt: skip
    refused = [f"{what}: {answer.describe()}" for what, answer in asked if answer.exception]
    if refused:
        yield fault(name, f"wrong profile: it refuses registers of {profile.name} ({'; '.join(refused)})", wrong)
    for what, answer in asked:
        if not answer.there:
            yield warning(name, f"{what}: {answer.describe()}", "supply, terminators, shielding, baud rate")


def _values(name: str, unit: UnitSurvey) -> Iterator[Finding]:
    """Report a device's readings, whether they are plausible, and the device's status."""
    for block, answer in zip(unit.profile.blocks, unit.blocks, strict=False):
        if not answer.ok:
            continue
        wrong: list[str] = []
        shown: list[str] = []
        for signal, value in decoded(block, answer.data):
            if signal.name == "status":
                yield from _status(name, unit, int(value))
            else:
                text = f"{signal.name} {value:.4g} {signal.unit}".rstrip()
                shown.append(text)
                if not signal.least <= value <= signal.greatest:
                    wrong.append(f"{text} is outside {signal.least:g} to {signal.greatest:g}")
        if wrong:
            yield from _implausible(name, unit, block, answer.data, wrong)
        elif shown:
            yield ok(name, f"unit {unit.config.unit_id}: {', '.join(shown)}: look whether that can be")


def decoded(block: RegisterBlock, data: bytes) -> list[tuple[Signal, float]]:
    """Return the signals of a block of registers with their values, in their units; NaN if a value is not finite."""
    values = list(zip(block.signals, block.unpack(data), strict=True))
    status = next((int(value) for signal, value in values if signal.name == "status"), 0)
    values_by_signal: list[tuple[Signal, float]] = []
    for signal, counts in values:
        count = float(counts)
        if signal.sign_bit is not None and status >> signal.sign_bit & 1:
            count = -count
        value = count * signal.scale + signal.offset
        values_by_signal.append((signal, value if isfinite(value) else nan))
    return values_by_signal


def _implausible(name: str, unit: UnitSurvey, block: RegisterBlock, data: bytes, wrong: list[str]) -> Iterator[Finding]:
    for order in ORDERS if any(signal.size > 1 for signal in block.signals) else ():
        turned = decoded(replace(block, order=order), data)
        if order != block.order and all(
            signal.name == "status" or signal.least <= value <= signal.greatest for signal, value in turned
        ):
            values = ", ".join(f"{signal.name} {value:.4g} {signal.unit}" for signal, value in turned
                               if signal.name != "status")  # fmt: skip
            kind = "word order" if order.bytes == block.order.bytes else "byte order"
            yield fault(
                name, f"wrong {kind}: {'; '.join(wrong)}; in another order they are plausible ({values})",
                f'a profile with word_order = "{order.words}", byte_order = "{order.bytes}"; or the device set',
            )  # fmt: skip
            return
    yield fault(name, f"implausible: {'; '.join(wrong)}", "the sensor, its cable; scale and type in its profile")


def _status(name: str, unit: UnitSurvey, status: int) -> Iterator[Finding]:
    bits = [meaning for meaning, bit in unit.profile.status_bits.items() if status >> bit & 1]
    if status & unit.profile.invalid_bits:
        why = ", ".join(bits) or hex(status)
        yield fault(name, f"reports an invalid reading: {why}", "the sensor, its cable")
    elif bits:
        yield note(name, f"status: {', '.join(bits)}")


def _settings(name: str, unit: UnitSurvey) -> Iterator[Finding]:
    """Compare the registers that every connection writes with the rig file and the profile."""
    profile = unit.profile
    wanted: dict[str, tuple[int, ...]] = {write.name: write.words for write in profile.setup}
    for key, signal in profile.writes.items():
        value = unit.config.parameters.get(key, signal.default)
        if value is not None:
            wanted[key] = signal.words(value, profile.order)
    differ = [
        f"{key} {' '.join(map(str, held))} instead of {' '.join(map(str, words))}"
        for key, words in wanted.items()
        if key in unit.configuration and unit.configuration[key].ok
        and (held := _words(unit.configuration[key].data)) != words
    ]  # fmt: skip
    if differ:
        yield note(name, f"registers that differ from the rig file, every connect writes them: {'; '.join(differ)}")


def _words(data: bytes) -> tuple[int, ...]:
    return tuple(int.from_bytes(data[at : at + 2], "big") for at in range(0, len(data), 2))


def units(e: Examination) -> Iterator[Finding]:
    """Report units that answer but are not in the rig file."""
    for name, line in e.lines.items():
        for number, answer in line.others.items():
            if number not in line.looks_like:
                yield warning(
                    f"line {name}", f"unit {number} answers ({answer.describe()}) and is not in the rig file",
                    "a device that no run reads: add it to the rig file, or take it off the line",
                )  # fmt: skip


def ages(e: Examination) -> Iterator[Finding]:
    """Report rate, reliability and age of each device's readings, and compare them with the limits."""
    for name, why in e.watch.lines_lost.items():
        yield fault(f"line {name}", f"lost while it was watched: {why}", "the adapter and its cable")
    surveyed = {key: unit for line in e.lines.values() for key, unit in line.units.items()}
    exchange_s = {key: max(watch.took_s[:REPLIES], default=0.0) for key, watch in e.watch.units.items()}
    for key, watch in e.watch.units.items():
        name, unit = title_of(e.rig, key), surveyed[key]
        if not watch.readings and watch.exceptions:
            continue  # its refusal has already been reported
        if not watch.readings:
            yield fault(name, f"no reading in {e.watch.seconds:.0f} s", "its supply, its plug")
            continue
        yield from _errors(name, watch)
        yield from _reply_time(e, name, unit, watch)
        others_s = sum(
            taken_s for other, taken_s in exchange_s.items()
            if other != key and surveyed[other].config.line == unit.config.line
        )  # fmt: skip
        yield _age(e, key, unit, watch, needed_s(unit.profile.blocks[0].period_s, exchange_s[key], others_s))


def _errors(name: str, watch: UnitWatch) -> Iterator[Finding]:
    share = watch.failed / watch.questions
    if watch.failed > 1 and share > FAILED_MOST:
        yield warning(
            name,
            f"{100 * share:.1f} % of {watch.questions} questions failed: {watch.silences} without an answer,"
            f" {watch.noises} with noise, {watch.exceptions} exceptions",
            "terminators, shielding, a common ground, wires A and B, another program on the line",
        )


def _reply_time(e: Examination, name: str, unit: UnitSurvey, watch: UnitWatch) -> Iterator[Finding]:
    usual_s, timing = median(watch.delays_s), unit.profile.timing
    rate = watch.readings / e.watch.seconds
    text = f"answers after {1e3 * usual_s:.1f} ms, {rate:.0f} readings/s"
    if usual_s > timing.reply_max_s + LATE_S:
        late_s, most = usual_s - timing.turnaround_s, f"{1e3 * timing.reply_max_s:g} ms"
        late = f"{text}; {unit.profile.name} takes at most {most}: late by {1e3 * late_s:.0f} ms"
        if _by_timer(e, unit, watch):
            late += ", as by the latency timer of a USB adapter (16 ms)"
        yield warning(name, late, _quicker(e, unit, watch))
    if unit.profile.blocks[0].period_s == 0.0 and rate < READINGS_S:
        yield warning(
            name, f"{text}: less than {READINGS_S:g} readings/s",
            f"a higher baud rate, a line of its own; {_quicker(e, unit, watch)}",
        )  # fmt: skip


def _by_timer(e: Examination, unit: UnitSurvey, watch: UnitWatch) -> bool:
    """Return whether the delay of a device's answers is that of a USB serial adapter's latency timer."""
    least_s, most_s = LATENCY_TIMER_S
    late_s = median(watch.delays_s) - unit.profile.timing.turnaround_s
    return e.rig.lines[unit.config.line].framing == "rtu" and least_s <= late_s <= most_s


def _quicker(e: Examination, unit: UnitSurvey, watch: UnitWatch) -> str:
    """Return what makes a device's answers come sooner."""
    if _by_timer(e, unit, watch):
        return "set the adapter's latency timer to 1 ms, or its low-latency flag; or use an adapter without one"
    return "the device's own reply delay, or what is between it and this computer: a gateway, a radio link"


def _age(e: Examination, key: str, unit: UnitSurvey, watch: UnitWatch, age_s: float) -> Finding:
    """Compare the age of readings with the limit, as a run does when it connects (tester.machine.line_speed)."""
    name, (_, limit_s) = title_of(e.rig, key), e.rig.stale_limits().get(unit.config.part_of or key, ("", None))
    text = f"{watch.readings} readings, at most {1e3 * watch.oldest_s:.0f} ms old when the next came"
    if limit_s is None:
        return ok(name, text)
    allowed = f"the rig file allows {1e3 * limit_s:g} ms"
    if age_s > limit_s:
        return fault(
            name, f"{text}; two readings take {1e3 * age_s:.0f} ms, {allowed}: a run refuses the line as too slow",
            f"a higher baud rate, a line of its own; {_quicker(e, unit, watch)}",
        )  # fmt: skip
    if watch.oldest_s > limit_s:
        remedy = "remove the causes of late or lost answers, as above; the limit stays the rig file's"
        return warning(name, f"{text}: {allowed}", remedy)
    return ok(name, f"{text} ({allowed})")
