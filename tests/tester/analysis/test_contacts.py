"""Contacts in a run's samples: touches, averages after them, the rubber's memory."""

from __future__ import annotations

from array import array
from math import nan

import pytest

from tester.analysis.contacts import PER_CONTACT, ContactFinder, PressedContact, Remembered
from tester.base.quantities import TIME
from tests.tester.analysis.pressed_rubber import ROLES, Pressed


def found(
    columns: dict[str, list[float]], block: int = 10**9, mounted_s: tuple[float, ...] = ()
) -> list[PressedContact]:
    """Return the contacts in samples that come in blocks."""
    finder = ContactFinder(ROLES, mounted_s)
    for begin in range(0, len(columns[TIME]), block):
        finder.add({name: values[begin : begin + block] for name, values in columns.items()})
    return finder.ended()


def delayed(rig: Pressed, from_s: float, by_s: float) -> dict[str, list[float]]:
    """Return the samples with a pause of ``by_s`` before the first at or after ``from_s``."""
    return dict(rig.columns, **{TIME: [at_s + (by_s if at_s >= from_s else 0.0) for at_s in rig.columns[TIME]]})


@pytest.fixture(scope="module")
def twice() -> Pressed:
    """Return rubber that was pressed with 100 N and then with 200 N, without noise."""
    rig = Pressed(noise=0.0)
    rig.press(100.0, 10.0)
    rig.press(200.0, 10.0)
    return rig


def test_each_touch_begins_a_contact_where_the_force_passes_ten_newtons(twice: Pressed) -> None:
    contacts = found(twice.columns)
    assert [contact.repeat_key for contact in contacts] == [1, 2]
    for contact in contacts:
        assert 10.0 <= contact.touch_n < 20.0
        assert contact.touch_mm == pytest.approx(10.0 + twice.true_depth_mm(contact.touch_n, 25.0), abs=0.1)
        loaded = contact.loaded
        assert len(loaded.since_s) and loaded.since_s.min() > 2.0
        assert loaded.force_n.min() > 30.0 and loaded.deeper_mm.min() > 0.5


@pytest.mark.parametrize("block", [7, 50, 333])
def test_blocks_of_any_length_give_the_same_contacts(twice: Pressed, block: int) -> None:
    whole, parts = found(twice.columns), found(twice.columns, block)
    assert len(whole) == 2 and parts == whole


def test_rubber_remembers_a_load_and_forgets_it(twice: Pressed) -> None:
    first, second = found(twice.columns)
    assert first.remembered.once_n == pytest.approx(0.0, abs=0.5)
    assert first.loaded.once_n[-1] == pytest.approx(100.0 * (1.0 + 0.57 + 0.1), rel=0.15)
    assert 5.0 < second.remembered.once_n < first.loaded.once_n[-1]
    assert first.loaded.twice_n[-1] > 0.0


def test_new_rubber_remembers_nothing(twice: Pressed) -> None:
    between_s = found(twice.columns)[1].at_s - 1.0
    assert found(twice.columns, mounted_s=(0.0, between_s))[1].remembered.once_n == pytest.approx(0.0, abs=0.5)


def test_an_interruption_ends_a_contact(twice: Pressed) -> None:
    cut_s = found(twice.columns)[0].at_s + 5.0
    contacts = found(delayed(twice, cut_s, 3600.0))
    assert contacts[0].loaded.since_s.max() < 5.1
    assert contacts[1].remembered.once_n < 40.0


@pytest.mark.parametrize("channel", ["load", "depth", "surface"])
def test_unknown_values_are_in_no_average(twice: Pressed, channel: str) -> None:
    unknown = dict(twice.columns, **{channel: [nan] * len(twice.columns[channel])})
    assert found(unknown) == []


def test_a_touch_after_a_pause_of_the_samples_does_not_count(twice: Pressed) -> None:
    touch_s = found(twice.columns)[0].at_s
    assert [contact.repeat_key for contact in found(delayed(twice, touch_s, 0.5))] == [2]


def test_a_long_contact_is_thinned_evenly_over_the_logarithm_of_time() -> None:
    since_s = [2.0 + 0.5 * n for n in range(5000)]
    rows = array("d", [value for one in since_s for value in (one, 100.0, 1.0, 25.0, 0.0, 0.0, 0.0, 1.0)])
    thinned = PressedContact(0.0, 10.0, 10.0, 25.0, Remembered(), rows).thinned().since_s.tolist()
    assert len(thinned) <= PER_CONTACT and (thinned[0], thinned[-1]) == (since_s[0], since_s[-1])
    assert sum(one < 52.0 for one in thinned) > len(thinned) / 3
