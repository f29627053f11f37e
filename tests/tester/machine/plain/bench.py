"""A plain machine with two drives and a sensor on its simulated wires, for the tests of ``tester.machine.plain``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, ClassVar

from sim import machines
from sim.plain_twin import PlainTwin, plain_machine
from sim.wires.can_wire import CanWire
from tester.base.axes import Axes, Axis, Setpoint
from tester.base.quantities import BURST, GATE, KEY, TIME, Channel, Quantities, Roles
from tester.base.source import load_tree
from tester.inputs.recipe.plain_recipe import PlainPart
from tester.inputs.recipe.plan import Plan
from tester.inputs.rig.config import NOT_REAL, OwnDevice, section_of
from tester.inputs.rig.parameter import Parameter
from tester.inputs.rig.plain_rig import PlainRig, PlainSim
from tester.inputs.rig.rig_files import checked
from tester.machine.plain.context import PlainContext
from tester.machine.plain.control import PlainControl
from tester.machine.plain.devices import PlainDevices
from tester.machine.plain.image import PlainReadings
from tester.machine.plain.rows import plain_table
from tester.machine.plain.runs import PlainRuns
from tester.machine.prompts import Prompts
from tester.machine.rig_ports import Ports
from tester.machine.run import Run
from tester.machine.run_parts import RunSetup
from tester.run.simulated import spec_of
from tester.store.recorder import NullRecorder
from tests.tester.inputs.recipe.texts import load_recipe

TABLE = plain_table()
Interlocks: Any = section_of("Interlocks", TABLE.parameters, __name__)
RIG = Path(__file__).with_name("bench.yaml").read_text(encoding="utf-8")
RECIPE = """
recipe: bench
specimens: [{compound: A}, {compound: B, note: worn}]
measure: {repeats: 2, min_valid: 2, window: 10 rev}
grids: [{name: speed, speed: [10 mm/s, 40 mm/s]}]
"""


@dataclass(slots=True)
class BenchReadings(PlainReadings):
    """A force, a constant load and a way."""

    force_n: float = float("nan")
    load_n: float = 10.0
    way_mm: float = 0.0

    def update(self, dt: float) -> None:
        """Count the way of the left drive."""
        speed = self.drives["left"]
        self.way_mm += abs(speed) * dt if speed == speed else 0.0
        self.slid_m = 1e-3 * self.way_mm
        self.force_n = self.sensors["cell"][0]


QUANTITIES = Quantities(
    (
        Channel(TIME, "s", "Time", "now"),
        Channel("force_n", "N", "Force", "readings.force_n", 1),
        Channel("load_n", "N", "Load", "readings.load_n", 2),
        Channel("way_mm", "mm", "Way", "readings.way_mm"),
        Channel(GATE, "", "Gates", "gate", whole=True),
        Channel(BURST, "", "Burst", "burst", whole=True),
        Channel(KEY, "", "Repeat", "repeat_key", whole=True),
    ),
    Roles(friction=("force_n",), normal="load_n", turn="way_mm", block=4.0),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class BenchRig(PlainRig):
    """The bench's rig file."""

    packaged: ClassVar[Mapping[str, str]] = {"bench": "tests.tester.machine.plain:bench.yaml"}
    own: ClassVar[Mapping[str, OwnDevice]] = {"cell": OwnDevice("cell", "load_cell")}
    quantities: ClassVar[Quantities] = QUANTITIES
    parameters: ClassVar[tuple[Parameter, ...]] = TABLE.parameters

    interlocks: Interlocks
    sim: Annotated[PlainSim, NOT_REAL] = field(default_factory=PlainSim)


class BenchPart(PlainPart):
    """One axis."""

    kind = "bench"
    axes = Axes(
        (Axis("speed", "mm/s", "speed_mm_s", "mm/s", 1.0, "speed_mm_s", "Speed", "Speed", "", None, True, gt=0.0),),
        blocks="speed",
    )

    def pace(self, setpoint: Setpoint) -> tuple[float, float]:
        """Return blocks of 4 mm a second, and m/s."""
        return setpoint.number("speed") / 4.0, 1e-3 * setpoint.number("speed")


class BenchPlant:
    """A force set by a test."""

    ambient_c = 21.0

    def __init__(self, parameters: PlainSim | None = None, seed: int = 0) -> None:
        self.force_n = 5.0
        self.installed: list[tuple[int, str]] = []
        self.repeats: list[tuple[int, int, int]] = []

    def advance(self, dt: float, speeds: Mapping[str, float]) -> None:
        """Change nothing."""

    def install(self, specimen: int, compound: str) -> None:
        self.installed.append((specimen, compound))

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        self.repeats.append((condition, repeat, attempt))


MACHINE = plain_machine(BenchPlant, {"cell": {"fx": "force_n"}}, (), ("force_n",), lambda rig: (0.0,), (3,))


class BenchRuns(PlainRuns):
    """Left goes at the speed, right at half of it, back."""

    plant = f"{__name__}:MACHINE"
    part = BenchPart()
    table = TABLE

    def readings(self, rig: PlainRig) -> BenchReadings:
        return BenchReadings()

    def speeds(self, setpoint: Setpoint, readings: PlainReadings) -> dict[str, float]:
        speed = setpoint.number("speed")
        return {"left": speed, "right": -0.5 * speed}


def bench_rig(text: str = RIG) -> BenchRig:
    """Return the rig; raises InvalidSource."""
    return checked(BenchRig, load_tree(text, "bench.yaml"))


def bench_plan(text: str = RECIPE) -> Plan:
    """Return the plan of a recipe."""
    part = BenchRuns.part
    return part.expand(load_recipe(text, part).recipe, bench_rig())


class Bench:
    """A run on the wires, ticked by hand."""

    def __init__(
        self, plan: Plan | None = None, rig: BenchRig | None = None, can_wire: type[CanWire] = CanWire,
        runs: BenchRuns | None = None,
    ) -> None:
        """Nothing is sent yet."""
        self.rig = rig or bench_rig()
        twin = machines.find(BenchRuns.plant).world(spec_of(self.rig), self.rig.plant, 1, can_wire)
        assert isinstance(twin, PlainTwin) and isinstance(twin.plant, BenchPlant)
        self.twin, self.plant = twin, twin.plant
        self.prompts = Prompts(automatic=True)
        self.run: Run = (runs or BenchRuns()).build(RunSetup(
            self.rig, plan or bench_plan(), Ports(twin.can, dict(twin.lines)), twin, NullRecorder(), self.prompts
        ))  # fmt: skip
        self.now = 0.0

    @property
    def ctx(self) -> PlainContext:
        return self.run.engine.ctx

    @property
    def control(self) -> PlainControl:
        return self.run.engine.control

    @property
    def devices(self) -> PlainDevices:
        return self.run.engine.devices

    def until(self, holds: Callable[[Bench], bool], at_most_s: float = 120.0) -> Bench:
        """Tick until something holds; raises TimeoutError."""
        end = self.now + at_most_s
        while not holds(self):
            if self.now > end:
                raise TimeoutError(f"not within {at_most_s:g} s")
            self.twin.advance(self.now)
            due = self.run.tick(self.now)
            self.now = max(round(min(due, self.twin.urgent_s), 6), self.now + 1e-3)
        return self

    def sliding(self) -> Bench:
        """Tick until samples count."""
        return self.until(lambda b: b.ctx.burst > 0)
