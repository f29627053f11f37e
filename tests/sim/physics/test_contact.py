"""Load against depth and rate of engagement."""

from __future__ import annotations

import pytest

from sim.physics.contact import ContactModel
from sim.physics.parameters import ContactParameters


@pytest.fixture
def contact() -> ContactModel:
    return ContactModel(ContactParameters())


@pytest.mark.parametrize(("load_n", "stiffness"), [(100.0, 125.0), (200.0, 145.0), (300.0, 160.0), (400.0, 172.0)])
def test_stiffness_is_the_stated_one(contact: ContactModel, load_n: float, stiffness: float) -> None:
    depth, h = contact.depth_mm(load_n), 1e-5
    slope = (contact.load_n(depth + h, 0.0) - contact.load_n(depth - h, 0.0)) / (2.0 * h)
    assert slope == pytest.approx(stiffness, rel=0.01)


def test_depth_is_the_inverse_of_load(contact: ContactModel) -> None:
    assert contact.load_n(contact.depth_mm(250.0), 0.0) == pytest.approx(250.0)
    assert contact.depth_mm(0.0) == 0.0


def test_damping_adds_load_while_the_press_goes_in(contact: ContactModel) -> None:
    depth = contact.depth_mm(200.0)
    assert contact.load_n(depth, 2.0) - contact.load_n(depth, 0.0) == pytest.approx(0.8)


def test_belt_never_pulls(contact: ContactModel) -> None:
    assert contact.load_n(0.001, -20.0) == 0.0


@pytest.mark.parametrize("rate_mm_s", [-20.0, 0.0, 20.0])
def test_out_of_contact_there_is_no_load(contact: ContactModel, rate_mm_s: float) -> None:
    assert contact.load_n(0.0, rate_mm_s) == contact.load_n(-3.0, rate_mm_s) == 0.0
