"""Kinds of rigs, found by name; a rig file names its kind."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest

from tester.base.source import InvalidSource
from tester.inputs.rig import Rig, WrongKindError
from tester.kinds import (
    PACKAGED,
    UnknownKindError,
    find,
    load_rig,
    load_rig_text,
    packaged_conditions,
    packaged_rigs,
    packaged_text,
)
from tester.kinds.specimen_on_track.context import TrackContext
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.context import AnyContext
from tester.machine.interlock_table import InterlockSheet
from tester.machine.plain.context import PlainContext


@pytest.mark.parametrize("name", PACKAGED)
def test_a_packaged_kind_is_found_by_its_name_and_ships_rigs_of_itself(name: str) -> None:
    kind = find(name)
    assert kind.name == name and kind.rigs
    for rig in kind.rigs:
        assert packaged_rigs()[rig] is kind
        assert isinstance(load_rig(rig), kind.rig()) and load_rig(rig).kind == name


@pytest.mark.parametrize("name", PACKAGED)
def test_modules_named_by_a_packaged_kind_exist(name: str) -> None:
    kind = find(name)
    asked = {one.name: getattr(kind, one.name) for one in fields(kind)}
    assert all(found() is not None for found in asked.values() if callable(found))
    assert isinstance(kind.interlocks(), InterlockSheet) and issubclass(kind.rig(), Rig)


@pytest.mark.parametrize("name", ["wheel", "no.such:kind", "a/path.py", "tester.kinds:PACKAGED"])
def test_an_invalid_kind_is_refused(name: str) -> None:
    with pytest.raises(UnknownKindError):
        find(name)


def test_a_kind_comes_from_an_installed_module_by_its_dotted_name() -> None:
    assert find("tester.kinds.wheel_on_belt:KIND") is find("wheel_on_belt")


def test_a_file_without_a_kind_is_a_wheel_on_a_belt() -> None:
    text = packaged_text()
    old = text.replace(next(line for line in text.splitlines() if line.startswith("kind:")), "")
    assert load_rig_text(old) == load_rig()


def test_a_file_of_an_invalid_kind_is_reported_with_its_place(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(packaged_text().replace("kind: wheel_on_belt ", "kind: wheel_on_bolt "), encoding="utf-8")
    with pytest.raises(InvalidSource, match=r"rig.yaml:10:7: kind: .*did you mean wheel_on_belt\?"):
        load_rig(path)


def test_the_kind_cannot_be_set_for_one_command() -> None:
    with pytest.raises(InvalidSource, match=r"--set kind=x.*only its file sets the kind"):
        load_rig("sim", ["kind=x"])


def test_a_packaged_rig_that_is_none_is_refused_by_name() -> None:
    with pytest.raises(InvalidSource, match="no_rig is no packaged rig of the kind"):
        load_rig("sim", ["like=no_rig"])


def test_a_rig_of_another_kind_is_not_taken_for_this_one() -> None:
    class Other(Rig):
        pass

    with pytest.raises(WrongKindError, match="kind wheel_on_belt"):
        Other.of(load_rig())
    assert RigConfig.of(load_rig()) == load_rig()


def test_conditions_that_ship_are_found_by_name_with_their_kind() -> None:
    for name, kind in packaged_conditions().items():
        assert kind.fits is not None and kind.fits().packaged_points(name).points
    assert set(packaged_conditions()) == {"appendix-a", "appendix-b"}


@pytest.mark.parametrize("context", [Context, TrackContext, PlainContext])
def test_every_gate_has_a_bit_of_its_own(context: type[AnyContext]) -> None:
    bits = list(context.gate_bits.values())
    assert bits and all(bit.bit_count() == 1 for bit in bits) and len(set(bits)) == len(bits)
