"""The messages between the service and its clients: JSON objects, one in each WebSocket message (docs/protocol.md).

A client sends ``join`` first and receives ``hello``. From then on the service sends ``snapshot`` (four a second, only
the newest counts), ``plan`` and ``queue`` (likewise), ``event`` (numbered, never dropped), ``machine`` when a run uses
another kind of rig and, to a client that watches them, ``frames``. Each command is answered by ``accepted`` or
``refused``. ``goodbye`` gives the reason why the service closes the connection.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, JsonValue, TypeAdapter, ValidationError
from pydantic_core import from_json

from tester.base.screen import MachineView
from tester.queue.view import QueueView
from tester.service.commands import VERSION, ClientMessage, Command, Join, Stop
from tester.service.results_view import GivenResults
from tester.service.state_view import PlanView, StateView

SNAPSHOT_S = 0.25
"""Period of snapshots, s of wall time."""
TREND_ROWS = 2400
"""Number of rows in the trend: ten minutes of snapshots."""
EVENTS_KEPT = 2000
"""Number of events kept for clients that reconnect."""


@dataclass(frozen=True, slots=True)
class Event:
    """An event. ``seq`` counts from 1 in one instance of the service, without gaps.

    ``severity``: debug, info, warning, alarm, trip. ``kind``: mode, trip, alarm, step, condition, repeat, prompt,
    command, run, tare, wear, emergency, heat, rest, control ...
    """

    seq: int
    t_s: float
    utc: str
    kind: str
    severity: str
    text: str
    run: str
    type: Literal["event"] = "event"


@dataclass(frozen=True, slots=True)
class Hello:
    """The first message: the present state of everything.

    ``service`` identifies this instance of the service: ``since`` counts only within it. ``events``: those after
    ``since``, or the last 200; ``complete`` is False when some of them are no longer kept. ``client``: this client's
    number; ``control``: whether it is the controller. ``machine``: the tables of the kind of rig; ``trend``: rows of
    its columns, oldest first; None is a missing value. ``queue``: the queue of the rig; ``results``: of the newest run.
    """

    version: int
    service: str
    software: str
    client: int
    control: bool
    machine: MachineView
    state: StateView
    plan: PlanView | None
    events: tuple[Event, ...]
    complete: bool
    trend: tuple[tuple[float | None, ...], ...]
    queue: QueueView | None = None
    results: GivenResults | None = None
    type: Literal["hello"] = "hello"


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state, four times a second; a slow client receives only the newest.

    ``row``: the present row of the trend.
    """

    state: StateView
    row: tuple[float | None, ...]
    type: Literal["snapshot"] = "snapshot"


@dataclass(frozen=True, slots=True)
class MachineMessage:
    """The tables of another kind of rig, which the run uses. The trend begins again."""

    machine: MachineView
    type: Literal["machine"] = "machine"


@dataclass(frozen=True, slots=True)
class PlanMessage:
    """The plan, at the start of a run and whenever a step begins. ``plan`` is None if there is no plan."""

    plan: PlanView | None
    type: Literal["plan"] = "plan"


@dataclass(frozen=True, slots=True)
class QueueMessage:
    """The queue of the rig: after every change, and every ten seconds while it goes; a slow client receives only the
    newest.
    """

    queue: QueueView
    type: Literal["queue"] = "queue"


@dataclass(frozen=True, slots=True)
class ResultsMessage:
    """The results of the newest run: after each repeat and condition, and every two seconds while a repeat grows; a
    slow client receives only the newest.
    """

    results: GivenResults
    type: Literal["results"] = "results"


@dataclass(frozen=True, slots=True)
class Frame:
    """One frame on a bus: rig seconds, bus, direction (whether the PC sent it), CAN id or unit, bytes in hex."""

    t_s: float
    bus: str
    sent: bool
    ident: int
    data: str


@dataclass(frozen=True, slots=True)
class Frames:
    """Frames since the last message of this kind. ``dropped``: number of frames left out; a log for people, not a
    record.
    """

    frames: tuple[Frame, ...]
    dropped: int
    type: Literal["frames"] = "frames"


@dataclass(frozen=True, slots=True)
class Accepted:
    """The service has accepted a command; ``result`` is the command's result (docs/protocol.md)."""

    id: int
    result: JsonValue = None
    type: Literal["accepted"] = "accepted"


@dataclass(frozen=True, slots=True)
class Refused:
    """The service has refused a command, with the reason. Nothing has changed."""

    id: int
    reason: str
    type: Literal["refused"] = "refused"


@dataclass(frozen=True, slots=True)
class Goodbye:
    """The last message: why the service closes the connection. ``ended``: whether the service ended on request."""

    reason: str
    ended: bool = False
    type: Literal["goodbye"] = "goodbye"


ServerMessage: TypeAlias = Annotated[
    Hello | Snapshot | Event | PlanMessage | ResultsMessage | QueueMessage | MachineMessage | Frames
    | Accepted | Refused | Goodbye,
    Field(discriminator="type"),
]

# -- as text ---------------------------------------------------------------------------------------------------------

SERVER: TypeAdapter[ServerMessage] = TypeAdapter(ServerMessage)
CLIENT: TypeAdapter[ClientMessage] = TypeAdapter(ClientMessage)


class BadMessageError(Exception):
    """A message does not follow this protocol; the text gives place and reason."""


def to_server(text: str | bytes) -> Join | Command:
    """Return a client's message. Raises BadMessageError."""
    try:
        return CLIENT.validate_json(text)
    except ValidationError as error:
        raise BadMessageError(_words(error)) from None


def stop_in(text: str | bytes) -> Command | None:
    """Return the STOP in a message of any version, whatever else the message holds; None if there is none.

    STOP is never refused: another error in the message is no reason to let a machine run on.
    """
    match _json(text):
        case {"action": {"command": "stop", **options}, **rest}:
            number = rest.get("id")
            return Command(number if isinstance(number, int) else 0, Stop(fast=options.get("fast") in (True, "true")))
        case _:
            return None


def id_in(text: str | bytes) -> int:
    """Return the id of an otherwise invalid command, so that its refusal reaches the sender; 0 if it has no id."""
    match _json(text):
        case {"id": int(number)}:
            return number
        case _:
            return 0


def foreign_join(text: str | bytes) -> str:
    """Return why a client of another version is refused, and what to do; "" for any other message.

    A join without a version is one of version 1.
    """
    match _json(text):
        case {"type": "join", **rest} if (version := rest.get("version", 1)) != VERSION:
            newer = isinstance(version, int) and version > VERSION
            return (
                f"this client speaks version {version!r:.20} of the protocol, the service version {VERSION}: install "
                f"the same version of friction-tester at both ends (here the {'service' if newer else 'client'} is the "
                "older one; docs/protocol.md lists the changes). STOP works all the same"
            )
        case _:
            return ""


def _json(text: str | bytes) -> JsonValue:
    try:
        value: JsonValue = from_json(text)
    except ValueError:
        return None
    return value


def from_server(text: str | bytes) -> ServerMessage:
    """Return a message of the service, ignoring unknown keys. Raises BadMessageError."""
    try:
        return SERVER.validate_json(text)
    except ValidationError as error:
        raise BadMessageError(_words(error)) from None


def encode(message: Join | Command | ServerMessage) -> bytes:
    """Return a message as JSON in UTF-8; numbers that are not finite become null."""
    if isinstance(message, Join | Command):
        return CLIENT.dump_json(message)
    return SERVER.dump_json(message)


def schema() -> dict[str, JsonValue]:
    """Return the JSON Schema of both directions, the content of docs/protocol.schema.json."""
    ways, shared = TypeAdapter.json_schemas([("server", "validation", SERVER), ("client", "validation", CLIENT)])
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": f"friction-tester service protocol, version {VERSION}",
        "description": "server: a message of the service; client: a message to it",
        "server": dict(ways["server", "validation"]),
        "client": dict(ways["client", "validation"]),
        "$defs": shared["$defs"],
    }


def _words(error: ValidationError) -> str:
    """Return the first error of a message and its place in one line, without quoting the message."""
    first = error.errors(include_url=False, include_input=False, include_context=False)[0]
    at = ".".join(str(piece) for piece in first["loc"])
    reason = str(first["msg"]).removeprefix("Value error, ")
    return f"{at}: {reason}" if at else reason
