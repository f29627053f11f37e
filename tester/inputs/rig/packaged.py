"""Packaged rig files, with a laboratory's own interlocks: what a file takes from one, and the file for a real machine.

A key that a file lacks takes the packaged value where its kind allows that (``Rig.may_lack``); some keys it must state
itself (``Rig.stated``).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from copy import deepcopy
from functools import cache
from importlib.resources import files

from tester.base.source import Tree, Value, load_tree
from tester.inputs.rig.config import Rig
from tester.inputs.rig.parameter import SECTION, key_line

Place = tuple[str, ...]
"""Place of a key: the names of its sections, and its own."""


def packaged_name(kind: type[Rig], like: str = "") -> str:
    """Return the name of a packaged rig: the requested one, or the first where there is none of that name."""
    return like if like in kind.packaged else next(iter(kind.packaged))


@cache
def packaged_text(kind: type[Rig], like: str = "") -> str:
    """Return the text of a packaged file, with a line for each parameter that its section ``interlocks`` lacks."""
    package, _, file = kind.packaged[packaged_name(kind, like)].partition(":")
    text = (files(package) / file).read_text(encoding="utf-8")
    tree = load_tree(text, file)
    section = tree.data.get(SECTION) if isinstance(tree.data, dict) else None
    new = (
        [key_line(parameter) for parameter in kind.parameters if parameter.key not in section]
        if isinstance(section, dict)
        else []
    )
    if not new:
        return text
    lines, place = text.splitlines(), tree.keys[(SECTION,)][0]
    return "\n".join([*lines[:place], *new, *lines[place:]]) + "\n"


@cache
def packaged_tree(kind: type[Rig], like: str = "") -> Tree:
    """Return a packaged file as data, for readers that do not change it."""
    return new_tree(kind, like)


def new_tree(kind: type[Rig], like: str = "") -> Tree:
    """Return a packaged file as data that the caller may change."""
    name = packaged_name(kind, like)
    text = packaged_text(kind, like)
    return load_tree(text, kind.packaged[name].replace(":", "/"))


def lacking(kind: type[Rig], tree: Tree) -> tuple[Place, ...]:
    """Return the missing keys that a file may lack, in the packaged file's order; of a missing section, its keys."""
    return tuple(_lacking(kind, _packaged(kind, tree), _section(tree.data), ()))


def complete(kind: type[Rig], tree: Tree) -> tuple[Place, ...]:
    """Write the packaged values of the missing keys that a file may lack into a tree.

    Returns the missing keys that it must state itself, of sections that it has (``Rig.stated``).
    """
    packaged, stated = _packaged(kind, tree), _section(tree.data)
    for place in tuple(_lacking(kind, packaged, stated, ())):
        value, section = packaged, stated
        for key in place[:-1]:
            if section.get(key) is None:
                section[key] = {}
            value, section = _section(value[key]), _section(section[key])
        section[place[-1]] = deepcopy(value[place[-1]])
    return tuple(_unstated(kind, packaged, stated))


def _unstated(kind: type[Rig], packaged: Value, stated: Value) -> Iterator[Place]:
    for place in (tuple(key_path.split(".")) for key_path in kind.stated):
        due, present = packaged, stated
        for key in place:
            due = due.get(key) if isinstance(due, dict) else None
            present = present.get(key) if isinstance(present, dict) else None
        if isinstance(due, dict) and isinstance(present, dict):
            yield from ((*place, key) for key in due if key not in present)


def like(tree: Tree) -> str:
    """Return the packaged rig that a file names in ``like``, "" for the first of its kind."""
    named = _section(tree.data).get("like")
    return named if isinstance(named, str) else ""


def _packaged(kind: type[Rig], tree: Tree) -> dict[str, Value]:
    """Return the packaged file that a file is like; the caller must not change it."""
    return _section(packaged_tree(kind, like(tree)).data)


def _section(value: Value) -> dict[str, Value]:
    """Return a section; an empty one for anything else, which is refused where it is read."""
    return value if isinstance(value, dict) else {}


def _lacking(kind: type[Rig], packaged: Mapping[str, Value], own: Mapping[str, Value], above: Place) -> Iterator[Place]:
    for key, value in packaged.items():
        place = (*above, key)
        inner = own.get(key)
        if isinstance(value, dict):
            if inner is None and _leads_to_some(kind, place) and (key not in own or _may_lack(kind, place)):
                inner = dict[str, Value]()  # a section that is missing, or present but empty
            if isinstance(inner, dict) and not _by_hand(kind, place, inner):
                yield from _lacking(kind, value, inner, place)
        elif key not in own and _may_lack(kind, place):
            yield place


def _may_lack(kind: type[Rig], place: Place) -> bool:
    """Return whether a file may lack a key, or a section above it."""
    return any(
        len(parts) <= len(place) and _alike(parts, place) for parts in (pattern.split(".") for pattern in kind.may_lack)
    )


def _leads_to_some(kind: type[Rig], place: Place) -> bool:
    """Return whether a section has keys that a file without it may lack. An axis or a device is never completed."""
    return _may_lack(kind, place) or any(
        len(parts) > len(place) and "*" not in parts[: len(place)] and _alike(parts, place)
        for parts in (pattern.split(".") for pattern in kind.may_lack)
    )


def _alike(parts: list[str], place: Place) -> bool:
    return all(part in ("*", key) for part, key in zip(parts, place, strict=False))


def _by_hand(kind: type[Rig], place: Place, section: Mapping[str, Value]) -> bool:
    """Return whether a section is that of an axis without a drive."""
    return place[0] == "axes" and place[-1] in kind.manual and section.get("manual") is True


def resolve(kind: type[Rig], tree: Tree) -> None:
    """Write the file's common values into every axis: its name and the heartbeats; ``manual`` becomes None."""
    if not isinstance(tree.data, dict):
        return  # the reader reports it
    axes, can = tree.data.get("axes"), tree.data.get("can")
    if not isinstance(axes, dict) or not isinstance(can, dict):
        return
    nodes = can.get("nodes")
    for name, node in nodes.items() if isinstance(nodes, dict) else ():
        if isinstance(node, dict):
            node.setdefault("name", name)
            node.setdefault("heartbeat", can.get("drive_heartbeat", ""))
    for name, axis in axes.items():
        if not isinstance(axis, dict):
            continue
        # Set by a person: the axis has no drive.
        if name in kind.manual and axis.get("manual") is True and len(axis) == 1:
            axes[name] = None
            continue
        axis.setdefault("name", name)
        for key, source in (("heartbeat", "drive_heartbeat"), ("consumer_heartbeat", "consumer_heartbeat")):
            if source in can:
                axis.setdefault(key, can[source])


HEADER = """\
# A rig: the machine's sizes, limits, buses, devices, loops and interlocks. No number of a test is here.
#
# Every number below is the simulated rig's. Go through all of them before the first run: [A] marks an engineering
# assumption, the axes' increments and the devices' profiles are those of your drives and transmitters. Limits and
# interlocks are operational; what must hold when this software fails is up to the drives, the limits that devices have
# of their own and the machine's hard-wired emergency stop.
#
# A number may stand bare: it then counts in the unit that the comment names. With a unit (1100 mm/s) it is converted.
# An unknown key is an error. `tester rig show --rig THIS_FILE` checks the file and prints it with everything resolved.
#
# Sources: "paper" is Polymers 2024, 16(5), 596, doi 10.3390/polym16050596; "CiA 301/402" are the CANopen and drive
# profiles.

"""

REPLACED = (
    (r"^rig: simulated ", "rig: "),
    (r"^simulated: true$", "simulated: false"),
    (r"^  interface: sim  ", "  interface: socketcan  "),
    (r'^  channel: ""  ', "  channel: can0  "),
    (r"# sim, or a python-can interface", "# a python-can interface"),
)
"""(text of the packaged file, its replacement for a real machine); each must occur exactly once."""
PORT = re.compile(r"^    port: sim( *# sim, )?", re.MULTILINE)
"""A line's port in the packaged file, the first with a comment that names the simulation."""

FIRST_KEY = "rig: "
SIMULATION = "# The simulated rig's physics."
"""From here on the packaged file describes the simulation only."""


def hardware_text(kind: type[Rig], like: str = "") -> str:
    """Return the commented file for a real machine; raises ValueError if the packaged file has lost a marked place."""
    text = packaged_text(kind, like)
    text = HEADER + text[_place(text, "\n" + re.escape(FIRST_KEY)) + 1 :]
    text = text[: _place(text, re.escape(SIMULATION))].rstrip() + "\n"
    for packaged, own in (*REPLACED, *((re.escape(before), after) for before, after in kind.real)):
        _place(text, packaged)
        text = re.sub(packaged, lambda _, own=own: own, text, count=1, flags=re.MULTILINE)
    ports = iter(range(len(text)))
    return PORT.sub(lambda found: _port(next(ports), found[1]), text)


def _port(number: int, comment: str | None) -> str:
    """Return the line of a real port; the comment behind it stays in its column."""
    named = f"    port: /dev/ttyUSB{number}"
    return named + (" " * (len("    port: sim") + len(comment) - len(named) - len("# sim, ")) + "# " if comment else "")


def _place(text: str, marked: str) -> int:
    """Return the beginning of a pattern that must occur exactly once."""
    places = [match.start() for match in re.finditer(marked, text, re.MULTILINE)]
    if len(places) != 1:
        raise ValueError(f"the packaged rig file holds {marked!r} {len(places)} times, not once")
    return places[0]
