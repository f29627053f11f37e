"""Softening, relaxation and deformation recover the parameters of the simulated contact, over many seeds."""

from __future__ import annotations

from math import isnan
from statistics import fmean

import pytest

from tester.analysis.contacts import ContactFinder, PressedContact
from tester.analysis.deformation import LEAST_CONTACTS, PressedPart, RubberStiffness, WithU, by_condition, stiffness_of
from tests.tester.analysis.pressed_rubber import ROLES, Pressed, pressed

SEEDS = range(12)


def contacts_of(rig: Pressed) -> list[PressedContact]:
    finder = ContactFinder(ROLES, ())
    finder.add(rig.columns)
    return finder.ended()


def stiffness(contacts: list[PressedContact]) -> RubberStiffness:
    found = stiffness_of(contacts)
    assert found is not None
    return found


def holds(found: WithU, truth: float) -> bool:
    return abs(found.value - truth) <= found.expanded


@pytest.fixture(scope="module")
def judged() -> list[tuple[Pressed, list[PressedContact], RubberStiffness]]:
    """Return the rubber of every seed with its fit."""
    rigs = [pressed(seed) for seed in SEEDS]
    listed = [contacts_of(rig) for rig in rigs]
    return [(rig, contacts, stiffness(contacts)) for rig, contacts in zip(rigs, listed, strict=True)]


def test_the_softening_put_in_is_found(judged: list[tuple[Pressed, list[PressedContact], RubberStiffness]]) -> None:
    found = [rubber.softening_per_k for _, _, rubber in judged]
    assert sum(holds(one, 0.004) for one in found) >= len(SEEDS) - 1
    assert fmean(one.value for one in found) == pytest.approx(0.004, rel=0.05)
    assert max(one.expanded for one in found) < 0.001


def test_the_relaxation_put_in_is_found(judged: list[tuple[Pressed, list[PressedContact], RubberStiffness]]) -> None:
    found = [rubber.relaxation for _, _, rubber in judged]
    assert sum(holds(one, 0.03) for one in found) >= len(SEEDS) - 1
    assert fmean(one.value for one in found) == pytest.approx(0.03, rel=0.2)
    assert max(one.expanded for one in found) < 0.03


def test_the_deformation_at_each_load_and_temperature_is_found(
    judged: list[tuple[Pressed, list[PressedContact], RubberStiffness]],
) -> None:
    held: list[bool] = []
    for rig, contacts, rubber in judged:
        for repeat, inside in by_condition(contacts, {key: key for key in range(1, 25)}).items():
            found = rubber.at(inside)
            contact, places = inside[0]
            averages = contact.loaded.at(places)
            lost_n = float((0.03 * (averages.once_n + 0.03 * averages.twice_n)).mean())
            truth = rig.true_depth_mm(found.load_n, found.body_c, lost_n)
            held.append(holds(found.depth_mm, truth))
            assert contact.repeat_key == repeat and found.contacts == 1
            assert found.depth_mm.expanded < 0.2
            assert found.stiffness_n_mm.value == pytest.approx(found.load_n / found.depth_mm.value)
    assert fmean(held) >= 0.93


@pytest.mark.parametrize(("softening", "relaxation"), [(0.0, 0.0), (0.008, 0.0), (0.0, 0.05)])
def test_another_kind_of_rubber_is_distinguished(softening: float, relaxation: float) -> None:
    found = [stiffness(contacts_of(pressed(seed, softening, relaxation))) for seed in range(3)]
    assert sum(holds(one.softening_per_k, softening) for one in found) >= 2
    assert sum(holds(one.relaxation, relaxation) for one in found) >= 2


def test_a_contact_with_one_moment_in_a_condition_counts_for_no_more_than_that(
    judged: list[tuple[Pressed, list[PressedContact], RubberStiffness]],
) -> None:
    _, contacts, rubber = judged[0]
    (whole, *_), (other, *_) = (by_condition(contacts, {key: key}).get(key, []) for key in (1, 2))
    moment = PressedPart(other.contact, other.places[:1])
    alone, both, one = (rubber.at(parts) for parts in ([whole], [whole, moment], [moment]))
    share = 1.0 / (len(whole.places) + 1)
    for name in ("load_n", "body_c"):
        of = (getattr(found, name) for found in (alone, one, both))
        first, second, together = of
        assert together == pytest.approx((1.0 - share) * first + share * second)
    depth = (1.0 - share) * alone.depth_mm.value + share * one.depth_mm.value
    assert both.depth_mm.value == pytest.approx(depth) and len(whole.places) > 10


def test_too_few_contacts_show_nothing() -> None:
    assert stiffness_of(contacts_of(pressed(1))[: LEAST_CONTACTS - 1]) is None


def test_one_temperature_shows_no_softening() -> None:
    rig = Pressed(3)
    for _ in range(6):
        rig.press(100.0, 12.0)
        rig.press(250.0, 12.0)
    rubber = stiffness(contacts_of(rig))
    assert isnan(rubber.softening_per_k.value)


def test_short_contacts_show_no_relaxation() -> None:
    rig = Pressed(3)
    for core_c in (25.0, 60.0):
        rig.core_c = core_c
        for _ in range(3):
            rig.press(100.0, 4.0)
            rig.press(250.0, 4.0)
    rubber = stiffness(contacts_of(rig))
    assert isnan(rubber.relaxation.value) and not isnan(rubber.softening_per_k.value)
