"""The sledge's twin: a spring, a weight and a law of friction between the drive and the load cell; and its fault."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import copysign, inf
from typing import Annotated

from sim.faults.kinds import Expected, Exposure, FaultKind
from sim.faults.scene import Effect, Scene
from sim.noise import NormalStream, normal
from sim.physics.laws import make
from sim.plain_twin import PlainTwin, plain_machine
from sim.rig import SimRig
from tester.base.config_reader import Range
from tester.inputs.rig.plain_rig import PlainSim

POSITIVE = Range(gt=0.0)


@dataclass(frozen=True, slots=True)
class SledgeSim(PlainSim):
    """The section ``sim`` of the rig file."""

    stiffness_n_per_mm: Annotated[float, "N/mm", POSITIVE] = 5.0  # of the spring [A]
    weight_n: Annotated[float, "N", POSITIVE] = 20.0
    air_c: Annotated[float, "degC"] = 23.0
    cell_rms_n: Annotated[float, "N", Range(ge=0.0)] = 0.02  # noise of the load cell [A]
    cell_zero_n: Annotated[float, "N"] = 0.5  # what the zero takes off [A]
    scatter: Annotated[float, "1", Range(ge=0.0)] = 0.02  # of the friction, from repeat to repeat [A]


class SledgePlant:
    """A sledge that sticks until the spring is drawn out far enough, and then slides at the law's friction."""

    def __init__(self, parameters: SledgeSim, seed: int) -> None:
        """Put a sledge of the first compound down, the spring slack."""
        self.parameters = parameters
        self.force_n = 0.0
        self.jammed = False
        self.ambient_c = parameters.air_c
        self._seed, self._law, self._repeat, self._specimen = seed, make("paper", "1#"), 1.0, 0
        self._noise = NormalStream(seed, "sledge cell")

    def advance(self, dt: float, speeds: Mapping[str, float]) -> None:
        """Draw the spring, as far as friction holds the sledge."""
        p, speed_mm_s = self.parameters, speeds["pull"]
        mu = self._repeat * self._law.mu(p.air_c, p.weight_n, 1e-3 * abs(speed_mm_s))
        limit_n = inf if self.jammed else mu * p.weight_n
        drawn_n = self.force_n + p.stiffness_n_per_mm * speed_mm_s * dt
        self.force_n = drawn_n if abs(drawn_n) <= limit_n else copysign(limit_n, drawn_n)

    @property
    def cell_n(self) -> float:
        """What the load cell in the spring shows."""
        p = self.parameters
        return self.force_n + p.noise * (p.cell_zero_n + p.cell_rms_n * self._noise.next())

    def install(self, specimen: int, compound: str) -> None:
        """Glue rubber under the sledge and put it down; the spring is slack."""
        self._law, self._specimen, self.force_n = make("paper", compound), specimen, 0.0

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Draw what friction differs by, and start the noise anew."""
        place = (self._specimen, condition, repeat, attempt)
        self._repeat = 1.0 + self.parameters.scatter * normal(self._seed, "sledge repeat", *place)
        self._noise = NormalStream(self._seed, "sledge cell", *place)


def plant_of(rig: SimRig) -> SledgePlant:
    """Return the sledge on its wires."""
    assert isinstance(rig, PlainTwin) and isinstance(rig.plant, SledgePlant)
    return rig.plant


class Jam(Effect):
    """The sledge is caught on the plate."""

    def begin(self, scene: Scene, now: float) -> None:
        """Catch it."""
        plant_of(scene.rig).jammed = True

    def end(self, scene: Scene, now: float) -> None:
        """Let it go."""
        plant_of(scene.rig).jammed = False


JAM = FaultKind("sledge jams", Jam, Exposure.MOVING, Expected.TRIP, 10.0, note="when the spring is drawn that far")


MACHINE = plain_machine(
    SledgePlant,
    {"load_cell": {"fx": "cell_n"}},
    (JAM,),
    log_columns=("speed_mm_s", "force_n"),
    log_row=lambda rig: (rig.axes["pull"].axis.value, plant_of(rig).force_n),
    log_decimals=(3, 3),
)
