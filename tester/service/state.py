"""The state view: everything a screen shows, as plain values. One object goes out four times a second.

Units are in the names, or in ``unit`` beside a value. What is unknown is None, never NaN and never an old value:
``age_s`` and ``quality`` say how far a value can be believed. Texts come from recipes, people and devices: whoever
shows one takes it as it is, never as markup.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from tester.base.screen import Check, Gate, SoakView, Value

MODES = (
    "OFFLINE",
    "INTERRUPTED",
    "CONNECTING",
    "IDLE",
    "ARMED",
    "RUN",
    "HOLD",
    "STOPPING",
    "COOLDOWN",
    "FAST STOP",
    "LATCHED",
    "E-STOP",
    "MANUAL",
)
"""Values of ``StateView.mode``; a client shows one it does not know as it is. OFFLINE: no rig is connected, a run
connects it. INTERRUPTED: the same, and the store holds a run that was cut off; shown until somebody acknowledges it."""


@dataclass(frozen=True, slots=True)
class ProgressView:
    """Where the run is. ``share``: of the whole rig time, 0..1, corrected by the durations measured so far.

    ``step`` counts through ``PlanView.steps``. ``over`` of the run's ``conditions`` are over, with a value or without,
    in earlier stretches of a resumed run too. ``left_s``: whole rig seconds of work to the end, None once a trip or a
    stop has given the run up; the sum of ``step_left_s``, of the present step, and of what the plan's list shows of
    the later ones. Neither it nor the share moves in a hold. ``finish_utc``: the wall clock then at the run's speed,
    "" at full speed.
    """

    step: int = 0
    steps: int = 0
    title: str = ""
    phase: str = ""
    over: int = 0
    conditions: int = 0
    repeat: int = 0
    repeats: int = 0
    revolutions: float = 0.0
    revolutions_wanted: float = 0.0
    burst: int = 0
    share: float = 0.0
    elapsed_s: float = 0.0
    left_s: float | None = None
    step_left_s: float = 0.0
    finish_utc: str = ""


AlarmState = Literal["active", "acknowledged", "returned"]
"""Cause there and not acknowledged; cause there, acknowledged; cause gone, not acknowledged (ISA-18.2)."""


@dataclass(frozen=True, slots=True)
class Alarm:
    """One alarm. ``priority`` 1 (trip) to 3. ``first_up``: the first of those that stopped the run.

    ``value``, ``limit``: what was seen and what is allowed, None where it is no number. ``consequence`` says
    what happens next, ``command`` which command answers it ("ack", "release", "").
    """

    number: int
    name: str
    priority: Literal[1, 2, 3]
    state: AlarmState
    text: str
    value: float | None
    limit: float | None
    unit: str
    consequence: str
    command: str
    first_up: bool
    t_s: float
    utc: str


@dataclass(frozen=True, slots=True)
class PromptView:
    """A question that waits for a person; answered with the command ``answer``."""

    number: int
    text: str
    t_s: float
    utc: str


@dataclass(frozen=True, slots=True)
class DeviceView:
    """One device on a bus. ``kind``: drive, or what a device on a line is. ``state``: the drive's CiA 402 state.

    ``age_s``: of its newest data. Errors are counted since the run began: time-outs, CRC, exceptions, emergencies.
    """

    name: str
    kind: str
    bus: str
    address: int
    state: str
    online: bool
    age_s: float | None
    requests: int
    errors: int
    errors_per_hour: float
    detail: str


@dataclass(frozen=True, slots=True)
class BusView:
    """One bus: ``load_percent`` None where nobody can know it (a serial line of a real rig)."""

    name: str
    kind: Literal["can", "modbus"]
    load_percent: float | None
    errors: int
    detail: str


@dataclass(frozen=True, slots=True)
class DiskView:
    """Space where runs are stored, in bytes. ``needed``: the estimate of the run under way, 0 without one.

    ``free`` is None where the disk does not say.
    """

    free: int | None
    needed: int
    low: bool


@dataclass(frozen=True, slots=True)
class RunView:
    """The run under way, or the last one. ``outcome``: running, done, incomplete, stopped, tripped, failed,
    rig unreachable. ``exit``: the exit code that `tester run` would give, None while it runs.

    ``speed``: rig seconds per second, None = as fast as it goes. ``missing``: conditions without a value, in words.
    """

    name: str
    folder: str
    recipe: str
    compound: str
    note: str
    operator: str
    seed: int | None
    simulated: bool
    speed: float | None
    started_utc: str
    outcome: str
    reason: str
    exit: int | None
    missing: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ManualView:
    """Manual mode: armed for ``left_s`` more seconds, or not (None). ``tare``: the newest tare in words."""

    left_s: float | None
    tare: str


@dataclass(frozen=True, slots=True)
class TickView:
    """How punctual the scan is, in real time only: worst lateness and overruns since the run began.

    ``late_s``: the worst of the last one to two seconds.
    """

    rate_hz: float
    late_max_s: float
    overruns: int
    late_s: float = 0.0


@dataclass(frozen=True, slots=True)
class ClientsView:
    """Who is connected. ``controller``: the name of the client that controls, "" if none; ``controller_id`` its id."""

    controller: str
    controller_id: int
    viewers: int


@dataclass(frozen=True, slots=True)
class StateView:
    """The whole state. ``t_s``: rig seconds of the run; ``wall_s``: seconds since the service started.

    ``mode_text`` says why the rig is in its mode. ``interrupted``: runs in the store that were cut off and can be
    resumed, by name. ``preflight``: what a person should look at before starting. ``risk``: the rig's safety keys that
    are looser than they should be, in words; "" where none is.
    """

    mode: str
    mode_text: str
    mode_since_s: float
    t_s: float
    wall_s: float
    utc: str
    rig: str
    simulated: bool
    run: RunView | None
    progress: ProgressView
    values: tuple[Value, ...]
    gates: tuple[Gate, ...]
    soak: SoakView | None
    alarms: tuple[Alarm, ...]
    prompt: PromptView | None
    manual: ManualView
    devices: tuple[DeviceView, ...]
    buses: tuple[BusView, ...]
    disk: DiskView
    tick: TickView
    clients: ClientsView
    interrupted: tuple[str, ...]
    preflight: tuple[Check, ...]
    alone: str = ""
    """What the rig's devices do by themselves once the service is gone."""
    risk: str = ""

    def value(self, key: str) -> Value | None:
        """Return the value with this key, None where the rig has none."""
        return next((value for value in self.values if value.key == key), None)


StepState = Literal["done", "now", "later"]


@dataclass(frozen=True, slots=True)
class PlanStep:
    """One step: its number from 1, seconds as estimated before the run, once it is done the measured ones.

    ``expected_s``: what it is expected to take by what the run has shown so far, whole seconds. The kind
    ``standstill`` is no step of the plan: the way to standstill behind each part.
    """

    number: int
    kind: str
    title: str
    state: StepState
    estimated_s: float
    measured_s: float | None
    expected_s: float


@dataclass(frozen=True, slots=True)
class PlanView:
    """The steps around the present one. ``first``: number of the first listed; ``total``: how many there are.

    ``beyond_s``: what the steps behind the last listed are expected to take, whole seconds.
    """

    name: str
    total: int
    first: int
    steps: tuple[PlanStep, ...]
    estimated_s: float
    beyond_s: float = 0.0
