"""Device profiles: one TOML file for each type of Modbus device, and their strict reader.

``load_profile("calex_pyrominibus")`` reads a file of this folder, ``load_profile("devices/my_cell.toml")`` a file of
your own, and ``read_profile`` a text from elsewhere. A new device is a new file, not a new class.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import Literal, cast, get_args

from drivers.profiles.model import DeviceProfile, Identity, Kind, LineData, ProfileError, SetupWrite, Switch, Timing
from drivers.profiles.numbers import BIT_READS, LIMITS, SIZES, Number, NumberOrder, Order
from drivers.profiles.registers import RegisterBlock, Signal
from drivers.profiles.table import ProfileTable, read_table

__all__ = [
    "DeviceProfile",
    "ProfileError",
    "RegisterBlock",
    "Signal",
    "Timing",
    "load_profile",
    "profile_names",
    "read_profile",
]  # fmt: skip

_FOLDER = Path(__file__).parent
_WRITE_MANY = 16
"""Function code that writes several registers in one request."""
_WRITE_COILS = {5, 15}
"""Function codes that write coils, one or several."""
_MOST_REGISTERS, _MOST_BITS = 125, 2000
"""Registers, and coils or discrete inputs, in one read (Modbus application protocol V1.1b3, 6.1 to 6.4)."""
_LONGEST_WAIT_MS = 60_000
"""Longest time that a step of the set-up may wait for a value, ms [A]."""
SATURATED_SHARE = 0.98
"""Share of a load cell's range from which a channel counts as saturated, unless its profile states another [A]."""
_FORCES = ("fx", "fy", "fz", "mz", "force")
"""Longitudinal, lateral and normal force (N), moment about the vertical (N m), in the wheel's frame; ``force`` (N) is
the channel of a transmitter with only one: the rig file states which of the forces it measures."""
_FIRST_READ: dict[Kind, tuple[str, ...]] = {"load_cell": _FORCES, "ir_thermometer": ("surface",)}
"""The first read of each kind must hold at least one of these channels."""


def profile_names() -> list[str]:
    """Return the names of the profiles that come with the program."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


def load_profile(name: str) -> DeviceProfile:
    """Return the profile of this name, or from this path when it ends in ``.toml``.

    Raises ProfileError, which names the file and the key, for a profile that does not exist, has an unknown, missing
    or wrong key, or marks a register as unknown.
    """
    path = Path(name) if name.endswith(".toml") else _FOLDER / f"{name}.toml"
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        known = ", ".join(profile_names())
        raise ProfileError(f"no device profile {name!r} (there are {known})") from error
    return read_profile(path.stem, text)


def read_profile(name: str, text: str) -> DeviceProfile:
    """Return the profile that a text in TOML describes, under this name; raises ProfileError like ``load_profile``."""
    return _profile(name, read_table(f"{name}.toml", text))


def _profile(name: str, top: ProfileTable) -> DeviceProfile:
    kind = cast(Kind, top.choice("kind", get_args(Kind)))
    title = top.text("title")
    functions = frozenset(_whole(top, "functions", item, 127) for item in top.items("functions"))
    order = NumberOrder(
        cast(Order, top.choice("word_order", get_args(Order), "high_first")),
        cast(Order, top.choice("byte_order", get_args(Order), "high_first")),
    )
    signals = _signals(top.table("signals", required=True))
    blocks = tuple(_block(read, signals, order) for read in top.tables("reads"))
    status = top.table("status")
    status_bits = {key: status.integer(key, 0, 31) for key in status.keys() if key != "invalid"}  # noqa: SIM118
    invalid = sum(1 << _whole(status, "invalid", item, 31) for item in status.items("invalid"))
    status.end()
    _look_at_reads(top, kind, blocks, functions)
    cell = kind == "load_cell"
    profile = DeviceProfile(
        name=name,
        kind=kind,
        title=title,
        functions=functions,
        write_function=top.integer("write_function", 6, 16, 6),
        order=order,
        line=_line(top.table("line", required=True)),
        timing=_timing(top.table("timing", required=True)),
        blocks=blocks,
        invalid_bits=invalid,
        status_bits=status_bits,
        identity=_identity(top.table("identity")) if "identity" in top else None,
        setup=tuple(_setup(write, order, functions) for write in top.tables("setup")),
        writes=_signals(top.table("writes"), functions),
        switches=_switches(top.table("switches"), functions),
        tare=top.flag("tare", cell),
        saturated=top.share("saturated", SATURATED_SHARE if cell else None),
        falls_back_s=top.number("falls_back_s") if "falls_back_s" in top else None,
        standby_c=top.number("standby_c") if "standby_c" in top else None,
    )
    top.end()
    return profile


def _look_at_reads(
    top: ProfileTable, kind: Kind, blocks: Sequence[RegisterBlock], functions: Collection[int]
) -> None:
    """Refuse reads that the device does not know, a first read without the sensor's channels, a name that is read
    twice, and a controller's register with an offset.
    """
    if not blocks:
        raise top.error("reads", "is missing")
    for block in blocks:
        if block.function not in functions:
            expected = f"the device knows {', '.join(map(str, sorted(functions)))}"
            raise top.error("reads", f"{block.signals[0].name} is read with function {block.function}, and {expected}")
    if kind in ("jacket", "chamber") and any(signal.offset for block in blocks for signal in block.signals):
        raise top.error("signals", "a controller's registers have no offset")
    every = [signal.name for block in blocks for signal in block.signals]
    for name in every:
        if every.count(name) > 1:
            raise top.error("reads", f"{name} is in two of them")
    for signal in (signal for block in blocks for signal in block.signals if signal.guards):
        if kind in ("jacket", "chamber") or signal.guards not in every or signal.guards in ("status", signal.name):
            raise top.error("signals", f"{signal.name} guards {signal.guards!r}, which is no channel of a sensor")
    names = {signal.name for signal in blocks[0].signals}
    if kind == "sensor" and names == {"status"}:
        raise top.error("reads", "the first read must hold a channel")
    wanted = _FIRST_READ.get(kind, ())
    if wanted and not names.intersection(wanted):
        raise top.error("reads", f"the first read must hold {' or '.join(wanted)}")


def _whole(table: ProfileTable, key: str, item: object, greatest: int) -> int:
    if isinstance(item, bool) or not isinstance(item, int) or not 0 <= item <= greatest:
        raise table.error(key, f"must hold whole numbers 0..{greatest}, not {item!r}")
    return item


def _signals(table: ProfileTable, functions: Collection[int] | None = None) -> dict[str, Signal]:
    """Return signals by name; ``functions``: function codes of the device if the registers are to be written."""
    found: dict[str, Signal] = {}
    for key in table.keys():  # noqa: SIM118 - not a dictionary
        row = table.table(key)
        scale = row.number("scale", 1.0)
        if scale <= 0.0:
            raise row.error("scale", f"must be above 0, not {scale}")
        number = cast(Number, row.choice("type", get_args(Number)))
        found[key] = Signal(
            name=key,
            address=row.integer("address", 0, 0xFFFF),
            type=number,
            scale=scale,
            unit=row.text("unit", ""),
            offset=row.number("offset", 0.0),
            least=row.number("least", float("-inf")),
            greatest=row.number("greatest", float("inf")),
            sign_bit=row.integer("sign_bit", 0, 31) if "sign_bit" in row else None,
            bit=row.integer("bit", 0, 15) if number == "bit" and "bit" in row else 0,
            guards=row.text("guards", "") if functions is None else "",
            default=row.number("default") if "default" in row else None,
        )
        if functions is not None:
            _writable(row, found[key], functions)
            found[key] = _within_type(row, found[key])
        row.end()
    return found


def _writable(row: ProfileTable, signal: Signal, functions: Collection[int]) -> None:
    """Refuse a count that is coarser than the range, and what no function of the device writes in one request."""
    if signal.type in ("bit", "u8"):
        if signal.type == "u8" or not _WRITE_COILS.intersection(functions):
            raise row.error("type", f"{signal.type}: a device that knows function 5 or 15 writes coils, as bit")
        return
    if signal.type != "f32" and signal.scale > signal.greatest - signal.least:
        raise row.error("scale", f"{signal.scale:g} is coarser than the range, {signal.least:g} to {signal.greatest:g}")
    if signal.size > 1 and _WRITE_MANY not in functions:
        raise row.error(
            "type", f"{signal.type} takes {signal.size} registers, which only function {_WRITE_MANY} writes"
        )


def _within_type(row: ProfileTable, signal: Signal) -> Signal:
    """Return a signal to write whose bounds are not beyond its type; refuse bounds that are."""
    if signal.type == "f32":
        return signal
    low, high = (end * signal.scale + signal.offset for end in LIMITS[signal.type])
    for key, bound in (("least", signal.least), ("greatest", signal.greatest)):
        if isfinite(bound) and not low <= bound <= high:
            raise row.error(key, f"must be {low:g} to {high:g}, which {signal.type} can hold, not {bound:g}")
    return replace(signal, least=max(signal.least, low), greatest=min(signal.greatest, high))


def _block(table: ProfileTable, signals: dict[str, Signal], order: NumberOrder) -> RegisterBlock:
    chosen: list[Signal] = []
    for item in table.items("signals"):
        if not isinstance(item, str) or item not in signals:
            raise table.error("signals", f"{item!r} is not among {', '.join(signals)}")
        chosen.append(signals[item])
    if not chosen:
        raise table.error("signals", "is missing")
    function = table.integer("function", 1, 4, 3)
    of_bits = function in BIT_READS
    chosen.sort(key=lambda signal: (signal.address, signal.bit))
    end, before = 0, chosen[0]
    for signal in chosen:
        if (signal.type in ("bit", "u8")) != of_bits and (of_bits or signal.type == "u8"):
            raise table.error("signals", f"{signal.name} is a {signal.type}, and function {function} reads none")
        shared = signal.type == before.type == "bit" and signal.bit > before.bit and not of_bits
        if signal.address < end and not shared:
            raise table.error("signals", f"{signal.name} overlaps the one before it")
        end, before = signal.address + SIZES[signal.type], signal
    address = chosen[0].address
    what, most = ("bits", _MOST_BITS) if of_bits else ("registers", _MOST_REGISTERS)
    if end - address > most:
        raise table.error("signals", f"span {end - address} {what}, more than {most}")
    period_s = 1e-3 * table.integer("period_ms", 0, 10_000)
    table.end()
    return RegisterBlock(function, address, end - address, period_s, tuple(chosen), order)


def _line(table: ProfileTable) -> LineData:
    baud = table.integer("baud", 300, 10_000_000)
    parity = cast(Literal["N", "E", "O"], table.choice("parity", ("N", "E", "O")))
    stop_bits = cast(Literal[1, 2], table.integer("stop_bits", 1, 2, 1))
    table.end()
    return LineData(baud, parity, stop_bits)


def _timing(table: ProfileTable) -> Timing:
    timing = Timing(
        turnaround_s=1e-3 * table.number("turnaround_ms"),
        reply_max_s=1e-3 * table.number("reply_max_ms"),
        retries=table.integer("retries", 0, 5),
    )
    if not 0.0 <= timing.turnaround_s <= timing.reply_max_s:
        raise table.error("reply_max_ms", "must be at least turnaround_ms, and both at least 0")
    table.end()
    return timing


def _identity(table: ProfileTable) -> Identity:
    address = table.integer("address", 0, 0xFFFF)
    identity = Identity(address, table.integer("function", 3, 4, 3), table.integer("value", 0, 0xFFFF))
    table.end()
    return identity


def _setup(table: ProfileTable, order: NumberOrder, functions: Collection[int]) -> SetupWrite:
    """Return a step of the set-up: a value to write, or with ``write = false`` a value to wait for."""
    number = Signal(
        table.text("name"),
        table.integer("address", 0, 0xFFFF),
        cast(Number, table.choice("type", get_args(Number), "u16")),
        1.0,
        "",
    )
    value = table.number("value")
    least, greatest = LIMITS[number.type]
    if number.type != "f32" and not (value.is_integer() and least <= value <= greatest):
        raise table.error("value", f"must be a whole number {least}..{greatest} for {number.type}, not {value:g}")
    try:
        words = number.words(value, order)
    except ValueError as error:
        raise table.error("value", str(error)) from error
    writes = table.flag("write", True)
    if writes:
        _writable(table, number, functions)
    within_s = 1e-3 * table.integer("within_ms", 0, _LONGEST_WAIT_MS, 0)
    if not writes and not within_s:
        raise table.error("within_ms", "is missing: a step that writes nothing waits for its value")
    read = table.integer("function", 1, 4, 1 if number.type == "bit" else 3)
    if (number.type in ("bit", "u8")) != (read in BIT_READS):
        raise table.error("function", f"{read} does not read a {number.type}")
    mask = table.integer("mask", 1, 0xFFFF) if "mask" in table else 0
    if mask and (writes or number.type not in ("u8", "u16")):
        raise table.error("mask", "is for a step that waits for some bits of a u8 or u16 and writes nothing")
    read_back = table.flag("read_back", True)
    lasts, first = table.flag("lasts", False), table.flag("first", False)
    step = SetupWrite(
        number.name, number.address, words, read_back, within_s, writes, number.type, read, mask, lasts, first
    )
    if within_s and not step.read_back:
        raise table.error("read_back", "must not be false where the step waits for its value")
    table.end()
    return step


def _switches(table: ProfileTable, functions: Collection[int]) -> dict[str, Switch]:
    found: dict[str, Switch] = {}
    for key in table.keys():  # noqa: SIM118 - not a dictionary
        row = table.table(key)
        address, coil = row.integer("address", 0, 0xFFFF), row.flag("coil", False)
        if coil and not _WRITE_COILS.intersection(functions):
            raise row.error("coil", "the device knows no function that writes coils (5, 15)")
        most = 1 if coil else 0xFFFF
        found[key] = Switch(address, row.integer("on", 0, most), row.integer("off", 0, most), coil)
        row.end()
    return found
