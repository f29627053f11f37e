"""The sledge's rig file, and its interlock: a spring that is drawn too far."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

from lab_sledge.image import QUANTITIES, SledgeReadings
from lab_sledge.twin import SledgeSim
from tester.base.config_reader import Range
from tester.base.quantities import Quantities
from tester.inputs.rig.config import NOT_REAL, OwnDevice, section_of
from tester.inputs.rig.key_classes import LOWER, Bounded, Held
from tester.inputs.rig.parameter import Parameter
from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.interlock_table import InterlockSheet
from tester.machine.plain.rows import ABOUT, STALE_SENSOR_S, PlainInputs, plain_table
from tester.machine.row import FAST, LOADED, REPAIR, Interlock
from tester.machine.watches import at_most

SPRING_N = Parameter(
    "spring_n", "N", "40 N", "the spring pulls at most this: a sledge that slides needs half of it [A]",
    hardest="60 N", because="at 60 N the spring is drawn by 12 mm: a sledge that comes loose jumps that far",
)  # fmt: skip


OVERDRAWN: Interlock[PlainInputs[SledgeReadings]] = Interlock(
    name="spring overdrawn",
    cause="the spring is drawn too far: the sledge sticks or has jammed",
    watch=at_most("pull > {}, or unknown", lambda v: abs(v.readings.force_n), SPRING_N),
    when=LOADED,
    unseen=True,
    reaction=FAST,
    reset=REPAIR,
)
TABLE = plain_table(OVERDRAWN)
SHEET = InterlockSheet(TABLE.rows, TABLE.operation, ABOUT)
Interlocks: Any = section_of("Interlocks", TABLE.parameters, __name__)


@dataclass(frozen=True, slots=True)
class SledgeSection:
    """What the laboratory has built."""

    weight_n: Annotated[float, "N", Range(gt=0.0, le=50.0), Held("a balance")]
    """Of the sledge with its rubber: the load."""
    speed_mm_s: Annotated[float, "mm/s", Range(gt=0.0, le=50.0), Bounded(LOWER, "50 mm/s", "the plate ends after 4 s")]
    """No recipe pulls faster."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SledgeRig(PlainRig):
    """A rig of this kind."""

    packaged: ClassVar[Mapping[str, str]] = {"sledge": "lab_sledge:rig.yaml"}
    own: ClassVar[Mapping[str, OwnDevice]] = {"load_cell": OwnDevice("load cell", "load_cell", stale=STALE_SENSOR_S)}
    quantities: ClassVar[Quantities] = QUANTITIES
    parameters: ClassVar[tuple[Parameter, ...]] = TABLE.parameters

    sledge: SledgeSection
    interlocks: Interlocks
    sim: Annotated[SledgeSim, NOT_REAL] = field(default_factory=SledgeSim)
