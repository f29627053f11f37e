"""What a recipe for the sledge may say: grids over one axis, the speed."""

from tester.base.axes import Axes, Axis, Setpoint
from tester.inputs.recipe.plain_recipe import PlainPart

AXES = Axes(
    (
        Axis("speed", "mm/s", "speed_mm_s", "mm/s", 1.0, "speed_mm_s", "Speed /mm·s⁻¹", "Speed mm/s", "", None, True, 1,
             gt=0.0, limit="sledge.speed"),
    ),
    blocks="speed",
)  # fmt: skip


class SledgePart(PlainPart):
    """The sledge's part of the recipe reader."""

    kind = "sledge"
    axes = AXES

    def pace(self, setpoint: Setpoint) -> tuple[float, float]:
        """Return blocks of 5 mm a second, and metres a second."""
        speed_mm_s = setpoint.number("speed")
        return speed_mm_s / 5.0, 1e-3 * speed_mm_s


PART = SledgePart()
