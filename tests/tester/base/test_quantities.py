"""A table of channels: order, look-ups, refusals."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass

import pytest

from tester.base.quantities import BURST, GATE, KEY, TIME, Channel, Figure, Quantities, Roles

FORCE = Channel("force_n", "N", "Force", "readings.force_n", mean=2)
LOAD = Channel("load_n", "N", "Load", "readings.load_n", mean=1)
WAY = Channel("way_mm", "mm", "Way", "readings.way_mm")
SPEED = Channel("speed_m_s", "m/s", "Speed", "", column="speed_mm_s", shown_unit="mm/s", scale=1e3)
FIRST = Channel(TIME, "s", "Time", "now")
LAST = tuple(Channel(name, "", name, name, whole=True) for name in (GATE, BURST, KEY))
ROLES = Roles(friction=("force_n",), normal="load_n", turn="way_mm", block=10.0)


def table(*channels: Channel, roles: Roles = ROLES) -> Quantities:
    """A table of these channels between the first and the last ones."""
    return Quantities((FIRST, *channels, *LAST), roles)


def test_samples_are_in_the_order_of_the_table() -> None:
    made = table(FORCE, LOAD, WAY)
    assert made.names == (TIME, "force_n", "load_n", "way_mm", GATE, BURST, KEY)
    assert [made.index(name) for name in made.names] == list(range(7))


def test_means_are_in_the_order_of_their_places() -> None:
    assert [one.name for one in table(FORCE, LOAD, WAY).averaged] == ["load_n", "force_n"]


def test_values_computed_for_screens_are_not_recorded() -> None:
    made = table(FORCE, LOAD, WAY, SPEED)
    assert "speed_m_s" not in made.names
    assert made["speed_m_s"] is SPEED


def test_a_value_is_shown_in_its_display_unit() -> None:
    assert SPEED.scaled(0.25) == 250.0
    assert SPEED.read_as == "mm/s"
    assert SPEED.measured_column == "measured_speed_mm_s"
    assert FORCE.scaled(0.25) == 0.25
    assert FORCE.measured_column == "measured_force_n"


@pytest.mark.parametrize(
    ("channels", "roles", "message"),
    [
        ((FORCE, FORCE, LOAD, WAY), ROLES, "one name"),
        ((FORCE, LOAD), ROLES, "way_mm"),
        ((FORCE, WAY), ROLES, "load_n"),
        ((FORCE, LOAD, WAY), Roles(("force_n",), "load_n", "way_mm", temperature="air_c"), "air_c"),
    ],
)
def test_a_table_that_lacks_a_channel_is_refused(channels: tuple[Channel, ...], roles: Roles, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        table(*channels, roles=roles)


def test_a_table_begins_with_the_time_and_ends_with_the_repeat() -> None:
    with pytest.raises(ValueError, match="begins with time_s"):
        Quantities((FORCE, LOAD, WAY, FIRST, *LAST), ROLES)


def test_a_copy_of_an_engine_keeps_the_table() -> None:
    made = table(FORCE, LOAD, WAY)
    assert deepcopy(made) is made


@dataclass
class Limits:
    """Of a rig."""

    load_n: float
    travel_mm: tuple[float, float] | None


@dataclass
class Rig:
    """The part of it that a figure reads."""

    limits: Limits


def test_a_figure_is_a_key_of_the_rig() -> None:
    rig = Rig(Limits(500.0, (1.0, 30.0)))
    assert Figure("limits.load_n", 1.1, 5.0).of(rig) == 1.1 * 500.0 + 5.0
    assert Figure("limits.travel_mm.1", otherwise=20.0).of(rig) == 30.0
    assert Figure("limits.travel_mm.1", otherwise=20.0).of(Rig(Limits(500.0, None))) == 20.0
    assert Figure(offset=2.0).of(rig) == 2.0


def test_a_figure_of_no_key_of_the_rig_is_an_error() -> None:
    with pytest.raises(AttributeError):
        Figure("limits.speed").of(Rig(Limits(500.0, None)))
