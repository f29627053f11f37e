"""A kind's drawing of its machine: existing values, inside the picture."""

from __future__ import annotations

import pytest

from tester.base.quantities import Quantities
from tester.base.screen import MachineView, Shape
from tester.kinds.specimen_on_track.quantities import QUANTITIES as OF_TRACK
from tester.kinds.specimen_on_track.screen import MACHINE as TRACK
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES as OF_WHEEL
from tester.kinds.wheel_on_belt.served.screen import MACHINE as WHEEL

KINDS = pytest.mark.parametrize(("machine", "table"), [(WHEEL, OF_WHEEL), (TRACK, OF_TRACK)], ids=["wheel", "track"])
COUNTS = {"box": (5,), "circle": (3,), "text": (2,), "line": tuple(range(4, 40, 2))}
"""How many numbers a shape of each form has."""


def extent(shape: Shape) -> tuple[float, float, float, float]:
    """Return a shape's left, top, right and bottom."""
    at = shape.points
    if shape.form == "box":
        return at[0], at[1], at[0] + at[2], at[1] + at[3]
    if shape.form == "circle":
        return at[0] - at[2], at[1] - at[2], at[0] + at[2], at[1] + at[2]
    return min(at[::2]), min(at[1::2]), max(at[::2]), max(at[1::2])


@KINDS
def test_every_place_is_that_of_one_value_that_the_kind_shows(machine: MachineView, table: Quantities) -> None:
    assert machine.drawing is not None
    keys = [anchor.key for anchor in machine.drawing.anchors]
    shown = {channel.screen.key for channel in table.shown if channel.screen is not None}
    assert set(keys) <= shown and len(keys) == len(set(keys))
    assert {plot.key for plot in machine.plots} <= set(keys)


@KINDS
def test_shapes_and_places_are_inside_the_drawing(machine: MachineView, table: Quantities) -> None:
    drawing = machine.drawing
    assert drawing is not None and drawing.text
    for shape in drawing.shapes:
        assert len(shape.points) in COUNTS[shape.form], shape
        left, top, right, bottom = extent(shape)
        assert 0.0 <= left <= right <= drawing.width and 0.0 <= top <= bottom <= drawing.height, shape
    for anchor in drawing.anchors:
        assert 0.0 <= anchor.x <= drawing.width and 12.0 <= anchor.y <= drawing.height - 12.0, anchor
