"""Messages from a client: ``join``, then commands. The service refuses a command with an unknown key."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from tester.queue.items import LEAST_WAIT_S, MOST_COPIES, MOST_WAIT_S
from tester.service.message_parts import Name, Note, PathText, RecipeText, Reply, Speed, StrictMessage

VERSION = 2
"""Version of this protocol. It increases with any change that an older client cannot ignore."""
MAX_MESSAGE = 400_000
"""Longest message that the service accepts, bytes: the largest recipe, escaped."""


@dataclass(frozen=True, slots=True)
class RecipeCommand(StrictMessage):
    """A message about a recipe.

    ``recipe``: a file on the service's machine or the name of a shipped recipe; with ``text``, which is the recipe
    itself, only its name. ``rig``: "" = the service's.
    """

    recipe: PathText
    text: RecipeText = ""
    rig: PathText = ""
    overrides: Annotated[tuple[Name, ...], Field(max_length=50)] = ()


@dataclass(frozen=True, slots=True)
class Join(StrictMessage):
    """The first message of a client. ``control``: request control, which the client gets if no other client has it.

    ``service`` and ``since``: the service and the last event that the client has seen; it then receives every later
    event.
    """

    name: Name
    version: int = VERSION
    control: bool = False
    service: Name = ""
    since: Annotated[int, Field(ge=0)] = 0
    type: Literal["join"] = "join"


@dataclass(frozen=True, slots=True)
class RunRecipe(RecipeCommand):
    """Start a run. Result: ``{"run": name, "folder": path}``.

    ``recipe``: a file on the service's machine or the name of a shipped recipe; with ``text``, which is the recipe
    itself, only its name. ``rig``: "" = the service's. ``speed``: rig seconds per second, None = as fast as possible;
    simulated rigs only. ``yes``: answer prompts without asking.
    """

    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    speed: Speed | None = 1.0
    yes: bool = False
    operator: Name = ""
    notes: Note = ""
    command: Literal["run"] = "run"


@dataclass(frozen=True, slots=True)
class ResumeRun(StrictMessage):
    """Resume an interrupted run at its first uncommitted repeat. The result is that of ``run``."""

    run: PathText
    speed: Speed | None = 1.0
    yes: bool = False
    reason: Note = ""
    command: Literal["resume"] = "resume"


@dataclass(frozen=True, slots=True)
class Hold(StrictMessage):
    """HOLD: lift, set slip to zero, keep heating. The current repeat is void and is measured again."""

    command: Literal["hold"] = "hold"


@dataclass(frozen=True, slots=True)
class Release(StrictMessage):
    """End HOLD and continue."""

    command: Literal["release"] = "release"


@dataclass(frozen=True, slots=True)
class Acknowledge(StrictMessage):
    """Acknowledge one alarm, or all (``number`` 0), including a latched trip whose cause is gone. Nothing moves."""

    number: Annotated[int, Field(ge=0)] = 0
    command: Literal["ack"] = "ack"


@dataclass(frozen=True, slots=True)
class Stop(StrictMessage):
    """STOP: a controlled stop, or a fast one. Any client may send it. It is never refused, and is idempotent."""

    fast: bool = False
    command: Literal["stop"] = "stop"


@dataclass(frozen=True, slots=True)
class Answer(StrictMessage):
    """Answer the prompt with this number; the answer is recorded. "no" leaves the prompt waiting. A prompt with a unit
    also takes a quantity, such as "89.62 mm".
    """

    number: int
    answer: Reply = "yes"
    command: Literal["answer"] = "answer"


@dataclass(frozen=True, slots=True)
class Arm(StrictMessage):
    """Arm manual mode (connects the rig first), or disarm it. It disarms by itself 60 s after the last step."""

    on: bool = True
    command: Literal["arm"] = "arm"


@dataclass(frozen=True, slots=True)
class Attend(StrictMessage):
    """A sign of life from the screen with which a person moves the rig. After a second without one manual mode ends."""

    command: Literal["attend"] = "attend"


@dataclass(frozen=True, slots=True)
class Jog(StrictMessage):
    """Move an axis by one bounded step, up or down, for one key press. More than five a second are refused.

    ``axis``: a name in the machine's table (``hello``).
    """

    axis: Name
    direction: Literal[-1, 1]
    command: Literal["jog"] = "jog"


@dataclass(frozen=True, slots=True)
class Tare(StrictMessage):
    """Zero the load cell in manual mode; refused in contact or in motion."""

    command: Literal["tare"] = "tare"


@dataclass(frozen=True, slots=True)
class TakeControl(StrictMessage):
    """Take control (``take``; with ``force`` even from another client), or return it."""

    take: bool = True
    force: bool = False
    command: Literal["control"] = "control"


@dataclass(frozen=True, slots=True)
class WatchFrames(StrictMessage):
    """Start or stop ``frames`` messages to this client."""

    on: bool = True
    command: Literal["frames"] = "frames"


@dataclass(frozen=True, slots=True)
class CheckRecipe(RecipeCommand):
    """Check a recipe against the rig. Result: ``{"problems": [{"line", "column", "message"}]}``, empty = valid."""

    command: Literal["check"] = "check"


@dataclass(frozen=True, slots=True)
class ShowPlan(RecipeCommand):
    """Plan a recipe. Result: the output of `tester plan --json`."""

    command: Literal["plan"] = "plan"


@dataclass(frozen=True, slots=True)
class ListRecipes(StrictMessage):
    """List the shipped recipes and those in the service's folder. Result: ``{"recipes": [{"name", "path"}]}``."""

    command: Literal["recipes"] = "recipes"


@dataclass(frozen=True, slots=True)
class ListRuns(StrictMessage):
    """List the stored runs. Result: ``{"runs": [...]}``, each as `tester runs --json` prints it."""

    command: Literal["runs"] = "runs"


Revision = Annotated[int, Field(ge=0)]
ItemNumber = Annotated[int, Field(ge=1)]
Clock = Annotated[str, Field(pattern=r"^([01]?\d|2[0-3]):[0-5]\d$")]


@dataclass(frozen=True, slots=True)
class QueueAdd(StrictMessage):
    """Add an item to the end of the queue, if it is valid on the service's rig.

    Options as of ``run``; the recipe is frozen now. ``after``: ends after which the queue continues. ``copies``: how
    many times, each an item of its own; on a simulated rig each has the next seed. ``answer_within_s``: wall time after
    which an item with an unanswered question is stopped, None = never. Then the queue stands, or with ``unanswered`` =
    ``skip`` continues if the next item asks nothing of a person. Result: ``{"id", "ids", "revision"}``.
    """

    recipe: PathText
    text: RecipeText = ""
    overrides: Annotated[tuple[Name, ...], Field(max_length=50)] = ()
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    speed: Speed | None = 1.0
    yes: bool = False
    operator: Name = ""
    notes: Note = ""
    after: tuple[Literal["done", "short", "failed"], ...] = ("done", "short")
    copies: Annotated[int, Field(ge=1, le=MOST_COPIES)] = 1
    answer_within_s: Annotated[float, Field(ge=LEAST_WAIT_S, le=MOST_WAIT_S, allow_inf_nan=False)] | None = None
    unanswered: Literal["stand", "skip"] = "stand"
    command: Literal["queue_add"] = "queue_add"


@dataclass(frozen=True, slots=True)
class QueueMove(StrictMessage):
    """Move an item before another one, or to the end (0); a skipped item waits again. ``revision``: of the queue that
    the sender saw; refused if it has changed since.
    """

    id: ItemNumber
    revision: Revision
    before: Annotated[int, Field(ge=0)] = 0
    command: Literal["queue_move"] = "queue_move"


@dataclass(frozen=True, slots=True)
class QueueSkip(StrictMessage):
    """Pass over a waiting item, or stop the item under way in a controlled way and let the queue go on. ``revision`` as
    of ``queue_move``.
    """

    id: ItemNumber
    revision: Revision
    command: Literal["queue_skip"] = "queue_skip"


@dataclass(frozen=True, slots=True)
class QueueDrop(StrictMessage):
    """Remove an item that does not run. ``revision`` as of ``queue_move``."""

    id: ItemNumber
    revision: Revision
    command: Literal["queue_drop"] = "queue_drop"


@dataclass(frozen=True, slots=True)
class QueueStart(StrictMessage):
    """Start the queue. ``agree``: items that run although something has changed since they were added. ``until``: the
    next such time of day of the service; an item that may last longer does not begin, and the queue then stands.
    """

    agree: Annotated[tuple[ItemNumber, ...], Field(max_length=200)] = ()
    until: Clock | Literal[""] = ""
    command: Literal["queue_start"] = "queue_start"


@dataclass(frozen=True, slots=True)
class QueueStand(StrictMessage):
    """Let the queue begin no further item; the running item continues."""

    reason: Note = ""
    command: Literal["queue_stand"] = "queue_stand"


@dataclass(frozen=True, slots=True)
class QueueList(StrictMessage):
    """Return the queue as in the message ``queue``."""

    command: Literal["queue_list"] = "queue_list"


@dataclass(frozen=True, slots=True)
class QueueCheck(StrictMessage):
    """Return until when the queue runs alone between two times of day of the service, such as 18:00 and 08:00, when it
    needs a person, and an order that would run longer.
    """

    start: Clock
    end: Clock
    command: Literal["queue_check"] = "queue_check"


@dataclass(frozen=True, slots=True)
class AddNote(StrictMessage):
    """Write a note, or tags (a minus takes one back), on the run under way. Once accepted it is on record."""

    run: Name
    text: Note = ""
    tags: Annotated[tuple[Name, ...], Field(max_length=20)] = ()
    command: Literal["note"] = "note"


@dataclass(frozen=True, slots=True)
class ExcludeRepeat(StrictMessage):
    """Leave a committed repeat of the run under way out of its mean (``repeat`` 0: each of the condition), or include
    it again. Once accepted it is on record. Result: ``{"repeats": number}``.
    """

    run: Name
    condition: Annotated[int, Field(ge=1)]
    reason: Note
    repeat: Annotated[int, Field(ge=0)] = 0
    include: bool = False
    command: Literal["exclude"] = "exclude"


RunEdit: TypeAlias = AddNote | ExcludeRepeat
"""Decisions of people on the run under way; they move nothing and need no control."""
QueueEdit: TypeAlias = QueueAdd | QueueMove | QueueDrop | QueueStand
"""Changes of the queue that begin nothing; they need no control."""
QueueOrder: TypeAlias = QueueEdit | QueueSkip | QueueStart
RigAction: TypeAlias = (
    RunRecipe | ResumeRun | Hold | Release | Acknowledge | Stop | Answer | Arm | Jog | Tare | QueueOrder | RunEdit
)
"""Commands for the rig's owner; all but ``stop``, changes of the queue, notes and exclusions require control."""
QueueQuery: TypeAlias = QueueList | QueueCheck
"""Questions that the gateway answers from the newest queue."""
Query: TypeAlias = CheckRecipe | ShowPlan | ListRecipes | ListRuns
"""Questions that a separate process answers, without involving the rig."""
Action: TypeAlias = Annotated[
    RigAction | TakeControl | WatchFrames | Attend | Query | QueueQuery, Field(discriminator="command")
]


@dataclass(frozen=True, slots=True)
class Command(StrictMessage):
    """A command. ``id`` is a number that the client chooses; the answer contains it."""

    id: int
    action: Action
    type: Literal["command"] = field(default="command")


ClientMessage: TypeAlias = Annotated[Join | Command, Field(discriminator="type")]
