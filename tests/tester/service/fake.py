"""A service without a rig: the real gateway on a real socket, and an owner played by a test.

async with FakeService(folder) as fake:
    client = await Client.connect(fake.address, control=True)
    fake.show(state)                      # a snapshot to everybody
    fake.event("trip", "overload", "trip")
    await client.command(Hold())          # accepted, unless fake.refusals has a reason
    assert fake.orders[-1].action == Hold()
"""

from __future__ import annotations

from contextlib import AsyncExitStack
from pathlib import Path
from types import TracebackType

from pydantic import JsonValue
from pydantic_core import to_json

from tester.base.screen import MachineView
from tester.service.address import Address, UnixAddress
from tester.service.gateway import Gateway
from tester.service.listening import listening
from tester.service.protocol import Accepted, Event, Refused, encode
from tester.service.queries import Queries
from tester.service.results_view import GivenResults
from tester.service.service_link import FROM_GATEWAY, Order, Presence
from tester.service.state_view import PlanView, StateView
from tests.tester.service.views import MACHINE
from tests.tester.service.views import state as a_state


class FakeService:
    """Plays the owner of a rig for the clients under test. ``uid``: the permitted user."""

    def __init__(self, folder: Path, *, service: str = "life-1", uid: int | None = None) -> None:
        """Listen in ``folder`` once entered; the first state is ``tests.tester.service.views.state()``."""
        self.notes: list[bytes] = []
        """Messages for the sender of notices."""
        self.gateway = Gateway(self._hear, service, "0.0", Queries(folder), self.notes.append)
        self.address: Address = UnixAddress(folder / "service.sock")
        self.orders: list[Order] = []
        self.presence = Presence("", 0, 0, False)
        self.refusals: dict[str, str] = {}
        """Command name -> why it is refused."""
        self.results: dict[str, JsonValue] = {}
        """Command name -> the result of its acceptance."""
        self.sequence = 0
        self._uid = uid
        self._stack = AsyncExitStack()

    async def __aenter__(self) -> FakeService:
        """Open the door."""
        self.address = await self._stack.enter_async_context(listening(self.gateway, self.address, self._uid))
        self.machine(MACHINE)
        self.show(a_state())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        await self._stack.aclose()

    def show(self, view: StateView, row: tuple[float | None, ...] | None = None) -> None:
        """Send a snapshot."""
        made = row if row is not None else (0.0,) * len(MACHINE.trend)
        self.gateway.take(b"s" + to_json(view) + b"\t" + to_json(made))

    def machine(self, machine: MachineView) -> None:
        """Send the tables of a kind of machine."""
        self.gateway.take(b"m" + to_json(machine))

    def event(self, kind: str, text: str, severity: str = "info") -> None:
        """Send an event."""
        self.sequence += 1
        event = Event(self.sequence, 1.0, "2024-02-21T14:05:09.000Z", kind, severity, text, "run")
        self.gateway.take(b"e%d " % self.sequence + encode(event))

    def plan(self, plan: PlanView | None) -> None:
        """Send a plan."""
        self.gateway.take(b"p" + to_json(plan))

    def give(self, results: GivenResults) -> None:
        """Send results, as the process that computes them does."""
        self.gateway.results.publish(to_json(results))

    def _hear(self, line: bytes) -> None:
        message = FROM_GATEWAY.validate_json(line)
        self.gateway.take(b"k1")
        if isinstance(message, Presence):
            self.presence = message
            return
        self.orders.append(message)
        name = message.action.command
        if name in self.refusals:
            reply = encode(Refused(message.id, self.refusals[name]))
        else:
            reply = encode(Accepted(message.id, self.results.get(name)))
        self.gateway.take(b"a%d " % message.client + reply)
