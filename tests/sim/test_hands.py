"""Actions of a person, or of a run in another process, at a simulated machine."""

from __future__ import annotations

import inspect
import shlex

import pytest

from sim import hands, machines
from sim.hands import COUNT, FLAG, TEXT, VALUES, Argument, Verb, durometer
from sim.machines.specimen_on_track.rig import TrackRig
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.plain_twin import PlainTwin
from sim.rig import SimRig

OF_THE_CONSOLE = {"fault", "faults", "clear", "catalogue", "speed", "idle", "state", "end", "help", "?"}
RIGS = {"specimen_on_track": TrackRig, "wheel_on_belt": WheelRig}
EVERY = Verb(
    "do", "do", "all sorts of arguments at once",
    (
        Argument("number", COUNT), Argument("rubber", TEXT), Argument("new", FLAG), Argument("track", "dry|wet"),
        Argument("load_n", "N"), Argument("held", VALUES),
    ),
)  # fmt: skip
VALUES_OF_EVERY = (3, "NR 50 phr", False, "wet", 0.1 + 0.2, {"slip": -0.1, "temperature": 23.0})


class Machine:
    """Keeps the actions."""

    def __init__(self) -> None:
        self.done: dict[str, object] = {}

    def do(self, **values: object) -> None:
        self.done = values


def test_a_line_carries_every_value_over_exactly() -> None:
    machine = Machine()
    word, *words = shlex.split(EVERY.line(*VALUES_OF_EVERY))
    EVERY.act(machine, words)
    assert word == "do" and tuple(machine.done.values()) == VALUES_OF_EVERY
    assert list(machine.done) == [argument.name for argument in EVERY.arguments]


@pytest.mark.parametrize("text", ["20 N", "20N", "2e1 N"])
def test_a_person_may_write_a_quantity_in_several_ways(text: str) -> None:
    machine = Machine()
    Verb("hang", "do", "", (Argument("load_n", "N"),)).act(machine, text.split())
    assert machine.done == {"load_n": 20.0}


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ("", "NUMBER is missing"),
        ("-1 x yes wet 1 N", "NUMBER is a whole number, not '-1'"),
        ("1 x maybe wet 1 N", "expected yes|no, not 'maybe'"),
        ("1 x yes oily 1 N", "expected dry|wet, not 'oily'"),
        ("1 x yes wet 1", "expected LOAD_N N: a number in N"),
        ("1 x yes wet 1 kg", "expected LOAD_N N: a number in N"),
        ("1 x yes wet nan N", "LOAD_N N: 'nan' is not a number"),
        ("1 x yes wet much N", "LOAD_N N: 'much' is not a number"),
        ("1 x yes wet 1 N slip", "slip: '' is not a number"),
    ],
)
def test_unreadable_lines_are_refused_and_nothing_is_done(words: str, why: str) -> None:
    machine = Machine()
    with pytest.raises(ValueError, match="^" + why.replace("|", r"\|").replace("?", r"\?") + "$"):
        EVERY.act(machine, words.split())
    assert machine.done == {}


def test_a_word_too_many_is_refused_with_the_form() -> None:
    with pytest.raises(ValueError, match="'now' is too much; the form is 'raise'"):
        Verb("raise", "do", "").act(Machine(), ["now"])


@pytest.mark.parametrize("kind", machines.names())
def test_every_verb_of_a_machine_is_a_method_of_its_rig_with_these_arguments(kind: str) -> None:
    verbs = machines.find(kind).verbs
    _fits(RIGS[kind], verbs)


def test_a_plain_machine_has_the_verbs_of_its_twin() -> None:
    _fits(PlainTwin, (hands.SPECIMEN, hands.REPEAT))


def _fits(rig: type[SimRig], verbs: tuple[Verb, ...]) -> None:
    assert verbs and len({verb.word for verb in verbs}) == len({verb.method for verb in verbs}) == len(verbs)
    for verb in verbs:
        assert verb.word not in OF_THE_CONSOLE and verb.about
        taken = [name for name in inspect.signature(getattr(rig, verb.method)).parameters if name != "self"]
        assert [argument.name for argument in verb.arguments] == taken, verb.word


def test_a_hardness_that_is_read_is_its_piece_s_and_on_the_scale() -> None:
    assert durometer(1, 2, 64.0) == durometer(1, 2, 64.0) != durometer(1, 3, 64.0)
    assert all(0.0 <= durometer(seed, 1, shore_a) <= 100.0 for seed in range(20) for shore_a in (0.0, 100.0))
