"""Packaged rig files, with a laboratory's own interlocks, and the commented file for a real machine made from one."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files

from tester.base.source import Tree, load_tree
from tester.inputs.rig.config import Rig
from tester.inputs.rig.parameter import SECTION, key_line


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
    return load_tree(packaged_text(kind, like), kind.packaged[name].replace(":", "/"))


HEADER = """\
# A rig: the machine's sizes, limits, buses, devices, loops and interlocks. No number of a test is here.
#
# Every number below is the simulated rig's. Go through all of them before the first run: [A] marks an engineering
# assumption, the axes' increments and the devices' profiles are those of your drives and transmitters. Limits and
# interlocks are operational; what must hold when this software fails is up to the drives, the jacket controller's own
# limit and the machine's hard-wired emergency stop.
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
