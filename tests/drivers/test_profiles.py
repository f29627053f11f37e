"""Device profiles: those that come with the program, and the strictness of their reader."""

from __future__ import annotations

import copy
from pathlib import Path

import pytest

from drivers.profiles import ProfileError, load_profile, profile_names
from drivers.profiles.numbers import Number, NumberOrder
from drivers.profiles.registers import RegisterBlock, Signal

SMALL = """
kind = "load_cell"
title = "a cell"
functions = [3]
[line]
baud = 9600
parity = "E"
[timing]
turnaround_ms = 2
reply_max_ms = 10
retries = 0
[signals]
fz = { address = 7, type = "i32", scale = 0.1, unit = "N" }
status = { address = 4, type = "u16" }
[[reads]]
signals = ["fz", "status"]
period_ms = 20
[status]
broken = 3
invalid = [3]
"""


def write(folder: Path, text: str) -> str:
    path = folder / "own.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("name", profile_names())
def test_every_profile_that_comes_with_the_program_is_complete(name: str) -> None:
    assert load_profile(name).name == name


def test_a_profile_of_ones_own_is_loaded_from_its_path(tmp_path: Path) -> None:
    profile = load_profile(write(tmp_path, SMALL))
    assert (profile.name, profile.kind, profile.line.parity) == ("own", "load_cell", "E")


def test_a_block_spans_its_signals_in_order_of_address(tmp_path: Path) -> None:
    block = load_profile(write(tmp_path, SMALL)).blocks[0]
    assert (block.address, block.count, block.period_s) == (4, 5, 0.02)
    assert block.unpack(bytes.fromhex("0008 AAAA BBBB FFFFFFFE".replace(" ", ""))) == (8, -2)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('kind = "load_cell"', 'kind = "scales"', "kind: must be one of load_cell"),
        ('title = "a cell"', "", "title: is missing"),
        ('title = "a cell"', 'title = "a cell"\ncolour = "red"', "colour: is not a key"),
        ('type = "i32"', 'type = "i33"', "signals: fz: type: must be one of bit, u8, u16, i16"),
        ("address = 7", "address = 70000", "signals: fz: address: must be a whole number 0..65535, not 70000"),
        ("address = 7", "address = 3", "fz overlaps|status overlaps"),
        ("address = 7", 'address = "unknown"', "signals: fz: address: is not known to us"),
        ("address = 7", "address = 500", "span 498 registers, more than 125"),
        ("scale = 0.1", "scale = 0", "signals: fz: scale: must be above 0"),
        ("scale = 0.1", 'scale = "much"', "signals: fz: scale: must be a number"),
        ("functions = [3]", "functions = [4]", "reads: status is read with function 3, and the device knows 4"),
        ('["fz", "status"]', '["fz", "fq"]', "reads 1: signals: 'fq' is not among fz, status"),
        ("reply_max_ms = 10", "reply_max_ms = 1", "timing: reply_max_ms: must be at least turnaround_ms"),
        ("invalid = [3]", "invalid = [99]", "status: invalid: must hold whole numbers 0..31"),
        ("retries = 0", "retries = true", "timing: retries: must be a whole number"),
        ("[line]", "[line", "own.toml"),
    ],
)
def test_a_mistake_is_refused_with_its_place(tmp_path: Path, old: str, new: str, message: str) -> None:
    assert old in SMALL
    with pytest.raises(ProfileError, match=message):
        load_profile(write(tmp_path, SMALL.replace(old, new, 1)))


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(ProfileError, match=r"no device profile 'nonsense' .*simulated_jacket"):
        load_profile("nonsense")


def test_a_profile_of_another_kind_is_refused() -> None:
    with pytest.raises(ProfileError, match="describes a jacket, not a load_cell"):
        load_profile("simulated_jacket").expect("load_cell")


def test_a_profile_is_shared_by_copies() -> None:
    profile = load_profile("simulated_jacket")
    assert copy.deepcopy(profile) is profile


@pytest.mark.parametrize(
    ("order", "data"),
    [
        (NumberOrder("high_first", "high_first"), "0001 86A0 0007"),
        (NumberOrder("low_first", "high_first"), "86A0 0001 0007"),
        (NumberOrder("high_first", "low_first"), "0100 A086 0007"),
        (NumberOrder("low_first", "low_first"), "A086 0100 0007"),
    ],
    ids=["abcd", "cdab", "badc", "dcba"],
)
def test_bytes_come_in_the_order_of_the_profile(order: NumberOrder, data: str) -> None:
    signals = (Signal("fz", 10, "i32", 1.0, "N"), Signal("status", 12, "u16", 1.0, ""))
    block = RegisterBlock(3, 10, 3, 0.0, signals, order)
    raw = bytes.fromhex(data.replace(" ", ""))
    assert block.unpack(raw) == (100_000, 7)
    assert block.pack(100_000, 7) == raw
    assert signals[0].value(raw[:4], order) == 100_000.0
    assert b"".join(word.to_bytes(2, "big") for word in signals[0].words(100_000.0, order)) == raw[:4]


def test_a_value_becomes_registers() -> None:
    assert Signal("sp", 26, "i16", 0.1, "degC").words(-12.34) == (0xFF85,)
    assert Signal("sp", 26, "f32", 1.0, "").words(1.0) == (0x3F80, 0)


def test_an_offset_is_the_value_at_a_count_of_zero() -> None:
    loop = Signal("t", 0, "u16", 0.05, "degC", offset=-250.0)
    assert loop.words(0.0) == (5000,) and loop.value((5000).to_bytes(2, "big")) == 0.0


@pytest.mark.parametrize(("number", "value"), [("i16", 3277.0), ("u16", -0.1), ("f32", 1e39)])
def test_a_value_beyond_its_register_is_refused(number: Number, value: float) -> None:
    with pytest.raises(ValueError, match="does not fit into its register"):
        Signal("sp", 26, number, 0.1, "degC").words(value)


def test_a_value_that_is_no_number_is_refused() -> None:
    with pytest.raises(ValueError, match="finite"):
        Signal("sp", 26, "i16", 0.1, "degC").words(float("nan"))
