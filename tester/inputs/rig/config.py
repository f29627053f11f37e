"""The common content of every rig file: buses, scan rates, lines, and the base of a kind's own sections.

A kind declares its sections as frozen dataclasses and its rig as a subclass of ``Rig``. Units are in the names; keys in
the file have none (tester.base.config_reader). Nothing has a default in the program: a limit always comes from a file
that a person can read, the rig's own or the packaged one of its kind (``Rig.may_lack``).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, make_dataclass
from datetime import date
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Final, Literal, TypeVar

from drivers.axis import AxisConfig
from drivers.canopen.node_config import NodeConfig
from tester.analysis.pressure import area_metadata
from tester.base.config_reader import FURTHER_KEYS, LEFT_OUT, Range, as_text, as_tree
from tester.base.quantities import Quantities
from tester.base.source import Location
from tester.inputs.rig.contact import ContactConfig
from tester.inputs.rig.key_classes import HIGHER, LOWER, Bounded, Free, Held, Inside, class_of
from tester.inputs.rig.parameter import SECTION, Parameter, Values
from tester.inputs.rig.safety_input import SafetyInput
from tester.inputs.rig.section_classes import CONSUMER_HEARTBEAT, DRIVE_HEARTBEAT, NODE

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_POSITIVE = Range(gt=0.0)
_WIRE: Final = Free("which wire: nothing moves before every drive on it has answered with its identity")
_ANSWER: Final = Held("the devices that answer there: nothing moves before all have, with plausible readings")
_TOGETHER: Final = Free("faults of the simulated machine, which campaigns draw from: a real run does not use it")
PAPER: Final = Held("the certificates, and the record of the commissioning")
NOT_REAL: Final = Free("the simulated machine: a real one does not use it")
OneRig = TypeVar("OneRig", bound="Rig")


class WrongKindError(TypeError):
    """A rig of another kind than required; the message names both."""


@dataclass(frozen=True, slots=True)
class ScanConfig:
    """Scan rates: while sliding or moving, while any drive is enabled, with all drives disabled."""

    sliding_hz: Annotated[
        float, "Hz", Range(gt=0.0, le=200.0),
        Bounded(HIGHER, "50 Hz", "a delay of 50 ms is two scans and a half: fewer are one reading"),
    ]  # fmt: skip
    enabled_hz: Annotated[
        float, "Hz", Range(gt=0.0, le=200.0),
        Bounded(HIGHER, "10 Hz", "two setpoints within the 200 ms after which a drive stops"),
    ]  # fmt: skip
    idle_hz: Annotated[
        float, "Hz", Range(gt=0.0, le=200.0),
        Bounded(HIGHER, "5 Hz", "the inputs are too old after 250 ms: at least one scan must read them"),
    ]  # fmt: skip


@dataclass(frozen=True, slots=True)
class CanConfig:
    """The drives' bus. ``interface`` is "sim" or a python-can interface; ``node`` is the PC's own."""

    interface: Annotated[str, _WIRE]
    channel: Annotated[str, _WIRE]
    bitrate: Annotated[Literal[125000, 250000, 500000, 800000, 1000000], _WIRE]
    node: Annotated[int, _WIRE]
    heartbeat_s: Annotated[
        float, "s", _POSITIVE, Bounded(LOWER, "100 ms", "two of the PC's heartbeats within the 200 ms that drives wait")
    ]
    """The PC's heartbeat period."""
    drive_heartbeat_s: Annotated[float, "s", _POSITIVE, DRIVE_HEARTBEAT]
    """The drives' heartbeat period (0x1017)."""
    consumer_heartbeat_s: Annotated[float, "s", _POSITIVE, CONSUMER_HEARTBEAT]
    """How long a drive waits for the PC's heartbeat before it stops (0x1016)."""
    nodes: Annotated[Mapping[str, NodeConfig], Inside(NODE)] = field(default_factory=dict[str, NodeConfig])
    """Further nodes, which measure; ``drive_heartbeat`` is theirs too, unless they state one."""


@dataclass(frozen=True, slots=True)
class LineConfig:
    """One Modbus line: a serial port, ``host:port`` (framing "socket"), or "sim"."""

    port: Annotated[str, _ANSWER]
    baud: Annotated[int, _ANSWER]
    parity: Annotated[Literal["N", "E", "O"], _ANSWER]
    framing: Annotated[Literal["rtu", "ascii", "socket"], _ANSWER]
    stop_bits: Annotated[Literal[1, 2], _ANSWER] = field(default=1, metadata=LEFT_OUT)
    rts: Annotated[Literal["", "high", "low"], _ANSWER] = field(default="", metadata=LEFT_OUT)
    """Level of the RTS line while the port sends, for an adapter whose direction it switches; "" = not used."""

    @property
    def settings(self) -> str:
        """Return the settings of the characters, for people."""
        return f"{self.baud} baud, parity {self.parity}" + (", 2 stop bits" if self.stop_bits == 2 else "")


HEAT_OFF: Final = {
    "fallback": "the controller falls back to a setpoint of its own without heat (falls_back_s of its profile)",
    "relay": "a watchdog relay, hard-wired, takes the heater's supply",
}
"""Possible values of ``heat_off``, with their meaning for the machine."""


@dataclass(frozen=True, slots=True)
class DeviceConfig:
    """One Modbus device: its profile in drivers/profiles, its line and its address there."""

    profile: Annotated[str, _ANSWER]
    line: Annotated[str, _ANSWER]
    unit_id: Annotated[int, _ANSWER]
    channels: Annotated[Mapping[str, str], _ANSWER] = field(default_factory=dict[str, str])
    """Other names for channels of the profile, where two sensors of a kind are on the rig."""
    simulated: Annotated[Mapping[str, str | float], Free("a real device measures")] = field(
        default_factory=dict[str, str | float]
    )
    """Simulated values of channels: a quantity of the plant by name, or a number in the channel's unit."""
    part_of: Annotated[str, _ANSWER] = field(default="", metadata=LEFT_OUT)
    """The machine's own device that contains this one: a load cell of several transmitters."""
    heat_off: Annotated[str, Held("the heat that must end in the commissioning when the PC is silent")] = field(
        default="", metadata=LEFT_OUT
    )
    """Safeguard of a controller that heats and has no lease: it removes the heat when the PC is silent
    (``HEAT_OFF``)."""
    parameters: Annotated[
        Mapping[str, float], FURTHER_KEYS,
        Held("the hub's sensor, with which a thermometer must agree at each start with a cold wheel"),
    ] = field(default_factory=dict[str, float])  # fmt: skip
    """Values written to a sensor at every connect, by the profile's names (``emissivity``), in its units."""


@dataclass(frozen=True, slots=True)
class OwnDevice:
    """A device of a kind of machine: its name for people, its profile's kind, whether a rig can lack it."""

    title: str
    profile: str
    optional: bool = False
    channels: tuple[str, ...] = ()
    """Channels that it must measure, by the names of its profile's channels."""
    joined: bool = False
    """Whether it may be several transmitters, which measure the channels together (``DeviceConfig.part_of``)."""
    stale: Parameter | None = None
    """The interlock parameter that limits the age of its readings; None: its driver's own limit."""
    shown: str = ""
    """Its name on screens during a run; "" is its title."""


@dataclass(frozen=True, slots=True)
class ShareConfig:
    """What some devices and axes of a rig have in common: one fault of it spoils all of them alike."""

    shared: Annotated[Literal["supply", "ground", "line", "adapter", "clock", "temperature"], _TOGETHER]
    members: Annotated[tuple[str, ...], _TOGETHER]
    """Keys of ``devices`` and ``axes``; of an axis the readings of its drive."""


@dataclass(frozen=True, slots=True)
class CalibrationConfig:
    """The last days on which the certificates of the sensors are valid, as 2027-01-31; "" if unknown.

    A kind declares a text for each certificate, by ``certificates``. The list before a start shows them; ``overdue`` is
    the reaction of a start after the end of one: "warn", or "refuse".
    """

    certificates: ClassVar[tuple[str, ...]] = ()
    overdue: Annotated[str, PAPER] = "warn"

    def __post_init__(self) -> None:
        """Raise ValueError for a text that is no date, and for an unknown ``overdue``."""
        self.ends()
        if self.overdue not in ("warn", "refuse"):
            raise ValueError(f'overdue: expected warn or refuse, got "{self.overdue}"')

    def ends(self) -> dict[str, date | None]:
        """Return the last day of each certificate by its name; raises ValueError for a text that is no date."""
        names = {name: name.replace("_", " ") for name in self.certificates}
        return {words: _day(words, getattr(self, name)) for name, words in names.items()}

    def over(self, today: date) -> str:
        """Return the certificates that ended before a day, "" for none."""
        return ", ".join(f"{name} ended {end}" for name, end in self.ends().items() if end is not None and end < today)


def _day(name: str, text: str) -> date | None:
    try:
        return date.fromisoformat(text) if text else None
    except ValueError:
        raise ValueError(f'{name}: expected a date such as 2027-01-31, or "", got "{text}"') from None


def section_of(name: str, parameters: tuple[Parameter, ...], module: str) -> Any:
    """Return the class of a section with a field for each parameter: a kind's ``interlocks``."""
    return make_dataclass(
        name,
        [
            (parameter.name, Annotated[(float, parameter.unit, parameter.bounds, *class_of(parameter))])
            for parameter in parameters
        ],
        frozen=True,
        slots=True,
        namespace={"__module__": module, "__doc__": "A section of the rig file: a field for each parameter."},
    )


def values_of(section: DataclassInstance, parameters: tuple[Parameter, ...]) -> Values:
    """Return the values of such a section, by parameter."""
    return {parameter: float(getattr(section, parameter.name)) for parameter in parameters}


@dataclass(frozen=True, slots=True, kw_only=True)
class Rig:
    """A rig: the software's whole knowledge of the machine, without any test.

    A kind's subclass adds its sections and defines the members declared here without a value.
    """

    packaged: ClassVar[Mapping[str, str]]
    """Packaged rig files of the kind, by the names that ``--rig`` takes: ``package:file``. The first completes a file
    of the kind and is compared with it, unless the file's key ``like`` names another."""
    may_lack: ClassVar[tuple[str, ...]] = ("scan", "can.heartbeat", "can.drive_heartbeat", "can.consumer_heartbeat")
    """Keys, or whole sections, that a file may lack: they take the value of the packaged file, and ``tester check``
    lists them. ``*`` matches one key. Every other key is known only to the builders of the machine."""
    stated: ClassVar[tuple[str, ...]] = ()
    """Sections whose keys must all be in the file, although their class, which others share, has defaults."""
    manual: ClassVar[tuple[str, ...]] = ()
    """Axes that a person may set instead of a drive: ``manual: true``."""
    own: ClassVar[Mapping[str, OwnDevice]] = {}
    """Devices of the kind by their keys in ``devices``; any other is a further sensor
    (tester.inputs.rig.further_sensors)."""
    parameters: ClassVar[tuple[Parameter, ...]] = ()
    """Parameters of the section ``interlocks``. One missing in the packaged file has its default there."""
    watched: ClassVar[tuple[str, ...]] = ()
    """Channels of further sensors that the kind's interlocks watch: a rig file must have them."""
    quantities: ClassVar[Quantities]
    """The kind's table of channels, without those of further sensors
    (tester.inputs.rig.further_sensors.quantities_on)."""
    real: ClassVar[tuple[tuple[str, str], ...]] = ()
    """(text of the packaged file, its replacement for a real machine), beside those common to all kinds
    (tester.inputs.rig.packaged); each must occur exactly once."""

    rig: Annotated[str, Held("the rig's past runs, whose evidence goes by this name")]
    """Name of the rig."""
    kind: Annotated[str, Held("the sections of the file: only the file sets it")]
    """Kind of the machine."""
    like: Annotated[str, Held("the build of the machine: safety keys are compared with that rig's")] = ""
    """Name of the packaged rig of the same build; "" is the first of its kind."""
    simulated: Annotated[bool, Held("the wires, which are all simulated or all real")]
    scan: ScanConfig
    can: CanConfig
    lines: Mapping[str, LineConfig] = field(default_factory=dict[str, LineConfig])
    devices: Mapping[str, DeviceConfig] = field(default_factory=dict[str, DeviceConfig])
    safety_inputs: Mapping[str, SafetyInput] = field(default_factory=dict[str, SafetyInput], metadata=LEFT_OUT)
    shares: Mapping[str, ShareConfig] = field(default_factory=dict[str, ShareConfig], metadata=LEFT_OUT)
    """What fails together, besides the devices of a line (tester.inputs.rig.further_sensors.shares_of)."""
    contact: ContactConfig | None = field(default=None, metadata=LEFT_OUT)
    """Area under the load, unless a recipe states another."""

    @classmethod
    def of(cls: type[OneRig], rig: Rig) -> OneRig:
        """Return a rig as one of this kind; raises WrongKindError."""
        if not isinstance(rig, cls):
            raise WrongKindError(f"{rig.rig} is a rig of the kind {rig.kind}: it cannot be used as {cls.__module__}")
        return rig

    @property
    def name(self) -> str:
        """Return the name of the rig."""
        return self.rig

    @property
    def ambient_c(self) -> float:
        """Return the temperature of the air around the rig, degC: of the simulated rig's air, else as stated in the
        file."""
        raise NotImplementedError

    def in_air(self: OneRig, ambient_c: float) -> OneRig:
        """Return a rig whose file states this temperature of the air around a real one, degC."""
        raise NotImplementedError

    def certificates(self) -> CalibrationConfig:
        """Return the section ``calibration``: the days on which the certificates of the sensors end."""
        return getattr(self, "calibration", CalibrationConfig())

    def stale_limits(self) -> Mapping[str, tuple[str, float]]:
        """Return the key and the value, s, of the greatest age of a device's reading, by its name in ``devices``."""
        return {
            name: (f"{SECTION}.{own.stale.key}", self.values()[own.stale])
            for name, own in self.own.items()
            if own.stale is not None
        }

    def drives(self) -> Mapping[str, AxisConfig]:
        """Return the axes that have a drive on the bus, by name."""
        raise NotImplementedError

    @property
    def area_metadata(self) -> dict[str, str]:
        """Return the area of ``contact`` as a run's metadata; a run's own counts before it."""
        return area_metadata(self.contact.area, self.contact.source) if self.contact is not None else {}

    @property
    def plant(self) -> Any:
        """Return the section ``sim``: parameters of the simulated machine, as the kind's twin takes them
        (sim.machines)."""
        return getattr(self, "sim", None)

    @property
    def faults(self) -> tuple[str, ...]:
        """Return the lines of a fault script (sim.faults.language) in the file, for a simulated rig."""
        return getattr(self.plant, "faults", ())

    def values(self) -> Values:
        """Return the values of the section ``interlocks``, by parameter."""
        section: DataclassInstance = getattr(self, SECTION)
        return values_of(section, self.parameters)

    def settled(self: OneRig) -> OneRig:
        """Return the rig with the values that follow from its file."""
        return self

    def problems(self) -> Iterator[tuple[Location, str]]:
        """Yield contradictions between the kind's sections, with their places."""
        yield from ()

    @property
    def tree(self) -> dict[str, object]:
        """Return the configuration with everything resolved, as data for a file."""
        return as_tree(self)

    @property
    def text(self) -> str:
        """Return the configuration with everything resolved, as YAML: a run stores it, and it reads back as this
        rig."""
        return as_text(self)
