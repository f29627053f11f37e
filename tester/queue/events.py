"""Events of the queue's record: everything that ever changed the queue."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, TypeAdapter

from tester.queue.items import End, Hashes, QueueItem


@dataclass(frozen=True, slots=True)
class ItemAdded:
    """A person added an item; it waits at the end. ``copies``: how many times, each as an item of its own."""

    item: QueueItem
    copies: int = 1
    event: Literal["added"] = "added"


@dataclass(frozen=True, slots=True)
class ItemMoved:
    """An item goes before another one, or to the end (0). A skipped item waits again."""

    id: int
    before: int
    by: str
    event: Literal["moved"] = "moved"


@dataclass(frozen=True, slots=True)
class ItemSkipped:
    """A person passes over a waiting item, or stops the item under way and lets the queue continue."""

    id: int
    by: str
    event: Literal["skipped"] = "skipped"


@dataclass(frozen=True, slots=True)
class ItemDropped:
    """A person removed an item."""

    id: int
    by: str
    event: Literal["dropped"] = "dropped"


@dataclass(frozen=True, slots=True)
class ItemAgreed:
    """A person agreed that an item runs although something changed since it was added: ``hashes`` count from now on."""

    id: int
    hashes: Hashes
    by: str
    event: Literal["agreed"] = "agreed"


@dataclass(frozen=True, slots=True)
class ItemTaken:
    """The service begins an item. This is on the disk before anything of its run exists."""

    id: int
    event: Literal["taken"] = "taken"


@dataclass(frozen=True, slots=True)
class ItemBegan:
    """The item's run has a folder."""

    id: int
    run: str
    event: Literal["began"] = "began"


@dataclass(frozen=True, slots=True)
class ItemReturned:
    """The item's run did not begin: the item waits again at its place, and the queue stands; a skipped one stays
    skipped, and the queue continues.
    """

    id: int
    reason: str
    event: Literal["returned"] = "returned"


@dataclass(frozen=True, slots=True)
class ItemEnded:
    """The item's run ended. ``stands``: the queue stands whatever the item chose, e.g. after a trip."""

    id: int
    end: End
    reason: str
    run: str
    stands: bool = False
    event: Literal["ended"] = "ended"


@dataclass(frozen=True, slots=True)
class QueueStarted:
    """A person started the queue. ``until_utc``: no item begins that may not have ended by then; "" for no limit."""

    by: str
    until_utc: str = ""
    event: Literal["started"] = "started"


@dataclass(frozen=True, slots=True)
class QueueStood:
    """The queue begins no further item before a person starts it. ``by``: "" for the service itself."""

    reason: str
    by: str = ""
    event: Literal["stood"] = "stood"


QueueEvent: TypeAlias = (
    ItemAdded
    | ItemMoved
    | ItemSkipped
    | ItemDropped
    | ItemAgreed
    | ItemTaken
    | ItemBegan
    | ItemReturned
    | ItemEnded
    | QueueStarted
    | QueueStood
)


@dataclass(frozen=True, slots=True)
class QueueLine:
    """An event on record: its number from 1, when it was written, and what it is."""

    n: int
    utc: str
    what: Annotated[QueueEvent, Field(discriminator="event")]


QUEUE_LINE: TypeAdapter[QueueLine] = TypeAdapter(QueueLine)
