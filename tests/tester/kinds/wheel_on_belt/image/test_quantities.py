"""The wheel's table of channels: complete, and every figure of it is one of the packaged rig."""

from __future__ import annotations

import pytest

from tester.base.quantities import Channel
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.machine.sampler import values_at
from tests.tester.kinds.wheel_on_belt.bench import make_bench

SCAN = make_bench().ctx


@pytest.mark.parametrize("channel", QUANTITIES.recorded, ids=lambda one: one.name)
def test_a_channel_is_read_from_a_field_of_the_scan(channel: Channel) -> None:
    (value,) = values_at([channel.source])(SCAN)
    assert isinstance(value, int | float)


@pytest.mark.parametrize("channel", QUANTITIES.shown, ids=lambda one: one.name)
def test_ends_and_limit_of_a_bar_are_figures_of_the_rig(channel: Channel) -> None:
    rig, screen = load_rig(), channel.screen
    assert screen is not None
    assert screen.low.of(rig) < screen.high.of(rig)
    assert screen.limit is None or screen.low.of(rig) < screen.limit.of(rig) < screen.high.of(rig)


def test_places_on_screens_and_among_means_are_given_once() -> None:
    ranks = [one.screen.rank for one in QUANTITIES.shown if one.screen is not None]
    assert ranks == list(range(1, len(ranks) + 1))
    assert [one.mean for one in QUANTITIES.averaged] == list(range(1, len(QUANTITIES.averaged) + 1))


def test_setpoints_are_channels() -> None:
    wanted = {one.screen.setpoint for one in QUANTITIES.shown if one.screen is not None} - {""}
    assert wanted <= set(QUANTITIES.names)
