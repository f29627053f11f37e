"""What a client may send: ``join``, then commands. A key that nobody knows refuses the command that has it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import Annotated, ClassVar, Literal, TypeAlias

from pydantic import AfterValidator, ConfigDict, Field

from tester.base.plain import plain_text

VERSION = 2
"""Of this protocol. A change that an older client cannot ignore raises it."""
MAX_MESSAGE = 400_000
"""Longest message that the service takes, bytes: a recipe of the greatest size, escaped."""

_STRICT = ConfigDict(extra="forbid")
"""Commands with a key that nobody knows are refused: a misspelt option must not be ignored."""

_PLAIN = AfterValidator(partial(plain_text, where=""))
Name = Annotated[str, Field(max_length=200), _PLAIN]
PathText = Annotated[str, Field(max_length=4096), _PLAIN]
Note = Annotated[str, Field(max_length=2000), _PLAIN]
RecipeText = Annotated[str, Field(max_length=262_144)]


@dataclass(frozen=True, slots=True)
class Join:
    """The first message of a client. ``control``: it wants to be the controller, if nobody is.

    ``service`` and ``since``: what it saw last, to be given every event after that.
    """

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    name: Name
    version: int = VERSION
    control: bool = False
    service: Name = ""
    since: Annotated[int, Field(ge=0)] = 0
    type: Literal["join"] = "join"


@dataclass(frozen=True, slots=True)
class RunRecipe:
    """Start a run. Result: ``{"run": name, "folder": path}``.

    ``recipe``: a file on the service's machine or the name of a shipped recipe; or ``text``, the recipe itself, which
    ``recipe`` then names. ``rig``: "" = the service's. ``speed``: rig seconds per second, None = as fast as it goes;
    simulated rigs only. ``yes``: prompts are answered without asking. ``experiment``: free fields, stored.
    """

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    recipe: PathText
    text: RecipeText = ""
    rig: PathText = ""
    overrides: Annotated[tuple[Name, ...], Field(max_length=50)] = ()
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    speed: Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)] | None = 1.0
    yes: bool = False
    operator: Name = ""
    notes: Note = ""
    command: Literal["run"] = "run"


@dataclass(frozen=True, slots=True)
class ResumeRun:
    """Go on with an interrupted run at its first uncommitted repeat. Result as of ``run``."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    run: PathText
    speed: Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)] | None = 1.0
    yes: bool = False
    reason: Note = ""
    command: Literal["resume"] = "resume"


@dataclass(frozen=True, slots=True)
class Hold:
    """HOLD: lift, slip to zero, heat held; the current repeat is void and done again."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    command: Literal["hold"] = "hold"


@dataclass(frozen=True, slots=True)
class Release:
    """End HOLD and go on."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    command: Literal["release"] = "release"


@dataclass(frozen=True, slots=True)
class Acknowledge:
    """Acknowledge one alarm, or all (``number`` 0); a latched trip too, once its cause is gone. Nothing moves by it."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    number: Annotated[int, Field(ge=0)] = 0
    command: Literal["ack"] = "ack"


@dataclass(frozen=True, slots=True)
class Stop:
    """STOP: a controlled stop, or a fast one. From any client, never refused, idempotent."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    fast: bool = False
    command: Literal["stop"] = "stop"


@dataclass(frozen=True, slots=True)
class Answer:
    """Answer the prompt with this number, by its word; the answer is recorded. "no" leaves it waiting."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    number: int
    answer: Literal["yes", "no"] = "yes"
    command: Literal["answer"] = "answer"


@dataclass(frozen=True, slots=True)
class Arm:
    """Arm manual mode (connects the rig first), or disarm it. Disarms by itself 60 s after the last step."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    on: bool = True
    command: Literal["arm"] = "arm"


@dataclass(frozen=True, slots=True)
class Attend:
    """A sign of life of the screen that moves the rig by hand: a second without one ends manual mode."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    command: Literal["attend"] = "attend"


@dataclass(frozen=True, slots=True)
class Jog:
    """One bounded step by hand, up or down: a key press. More than five a second are refused.

    ``axis``: a name of the machine's table (``hello``).
    """

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    axis: Name
    direction: Literal[-1, 1]
    command: Literal["jog"] = "jog"


@dataclass(frozen=True, slots=True)
class Tare:
    """Zero the load cell in manual mode; refused in contact or moving."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    command: Literal["tare"] = "tare"


@dataclass(frozen=True, slots=True)
class TakeControl:
    """Take control (``take``; ``force``: also from a client that has it), or give it back."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    take: bool = True
    force: bool = False
    command: Literal["control"] = "control"


@dataclass(frozen=True, slots=True)
class WatchFrames:
    """Have ``frames`` messages sent to this client, or no more."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    on: bool = True
    command: Literal["frames"] = "frames"


@dataclass(frozen=True, slots=True)
class CheckRecipe:
    """Check a recipe against the rig. Result: ``{"problems": [{"line", "column", "message"}]}``, empty = valid."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    recipe: PathText
    text: RecipeText = ""
    rig: PathText = ""
    overrides: Annotated[tuple[Name, ...], Field(max_length=50)] = ()
    command: Literal["check"] = "check"


@dataclass(frozen=True, slots=True)
class ShowPlan:
    """Plan a recipe. Result: what `tester plan --json` prints."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    recipe: PathText
    text: RecipeText = ""
    rig: PathText = ""
    overrides: Annotated[tuple[Name, ...], Field(max_length=50)] = ()
    command: Literal["plan"] = "plan"


@dataclass(frozen=True, slots=True)
class ListRecipes:
    """List the shipped recipes and those beside the service. Result: ``{"recipes": [{"name", "path"}]}``."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    command: Literal["recipes"] = "recipes"


@dataclass(frozen=True, slots=True)
class ListRuns:
    """List the stored runs. Result: ``{"runs": [...]}`` with what `tester runs --json` prints of each."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    command: Literal["runs"] = "runs"


RigAction: TypeAlias = RunRecipe | ResumeRun | Hold | Release | Acknowledge | Stop | Answer | Arm | Jog | Tare
"""What the rig's owner does; everything but ``stop`` is for the controller alone."""
Query: TypeAlias = CheckRecipe | ShowPlan | ListRecipes | ListRuns
"""What is worked out beside the rig, by a process of its own."""
Action: TypeAlias = Annotated[RigAction | TakeControl | WatchFrames | Attend | Query, Field(discriminator="command")]


@dataclass(frozen=True, slots=True)
class Command:
    """A command: ``id`` is the client's own number and comes back with the answer."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    id: int
    action: Action
    type: Literal["command"] = field(default="command")


ClientMessage: TypeAlias = Annotated[Join | Command, Field(discriminator="type")]
