"""Nonsense values of keys, drawn by seed, and the response of a real rig's file and of `--set`."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from math import inf, nan
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

import yaml

from tester import kinds
from tester.base import clock
from tester.base.source import InvalidSource, Tree
from tester.inputs.rig.config import NOT_REAL, Rig
from tester.inputs.rig.packaged import new_tree
from tester.inputs.rig.rig_files import checked, load
from tester.inputs.rig.rig_keys import Place, RigKey, values_of
from tester.kinds import load_rig
from tester.machine.commission.commission_step import sections_sha256
from tester.machine.commission.record import DONE, CommissionRecord, record_path
from tester.run.preconditions import unmeasured

RIGS = ("sim", "grosch", "pin-on-disc")
"""The packaged rigs whose keys are used."""
SHARES = (2, 1, 1)
"""The wheel appears as often as the two tracks together."""
OTHER_MAKER = 0x123
"""Vendor of the drives of a real rig."""
FACTORS = (0.0, -1.0, 1e-6, 1e-4, 1e-2, 0.1, 10.0, 1e2, 1e4, 1e6)
"""Factors of a number; 0 counts as 1."""
NUMBERS = (inf, nan, 1e9)
"""Further nonsense in place of a number."""
TEXTS = ("nonsense", "", "sim")
"""Nonsense in place of a text, beside the values that the key has elsewhere."""


@dataclass(frozen=True, slots=True)
class Nonsense:
    """A value for a key of the real rig that resembles a packaged one."""

    rig: str
    key: RigKey
    place: Place
    value: Any
    stated: Any
    """The value in the file."""

    @property
    def text(self) -> str:
        """Return the key and the value, as for ``--set``."""
        value = yaml.safe_dump(self.value, default_flow_style=True, width=10_000).removesuffix("...\n").strip()
        return f"{'.'.join(self.place)}={value}"

    @property
    def class_name(self) -> str:
        """Return the class of the key."""
        return type(self.key.classes[0]).__name__.lower()

    def in_file(self) -> str:
        """Return why the file of a real rig with the value is refused, "" if it is accepted."""
        tree = _tree(self.rig)
        _put(tree, self.place, self.value)
        return _refusal(self.rig, tree)

    def at_start(self) -> str:
        """Return why a run does not start with an accepted file and the earlier commissioning; "" if it starts."""
        tree = _tree(self.rig)
        _put(tree, self.place, self.value)
        with TemporaryDirectory(prefix="keys-") as folder:
            _commission(self.rig, Path(folder))
            return unmeasured(load(type(_real(self.rig)[1]), tree), Path(folder))

    def by_override(self) -> str:
        """Return why ``--set``, or a client's override, is refused on a real rig, "" if it is accepted."""
        return _refusal(self.rig, _tree(self.rig), self.text)


def drawn(count: int, seed: int) -> Iterator[Nonsense]:
    """Yield nonsense: every key of every rig is equally likely, except keys that only a simulated machine uses."""
    random = Random(f"nonsense {seed}")
    while count:
        (rig,) = random.choices(RIGS, SHARES)
        key, place, value = random.choice(keys(rig))
        nonsense = _nonsense(random, rig, place, value)
        if nonsense != value:
            yield Nonsense(rig, key, place, nonsense, value)
            count -= 1


@cache
def keys(rig: str) -> tuple[tuple[RigKey, Place, Any], ...]:
    """Return every key of a real rig that resembles a packaged one, with its place and its value."""
    return tuple(
        (key, place, value)
        for key, place, value in values_of(_real(rig)[1])
        if NOT_REAL not in key.classes and place != ("kind",)  # another kind's name selects another reader of the file
    )


def _nonsense(random: Random, rig: str, place: Place, value: Any) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return random.choice((0, -1, 1, 10, 7 * value, 1000 * value, 2**31, 2**40))
    if isinstance(value, float):
        return random.choice((*((value or 1.0) * factor for factor in FACTORS), *NUMBERS))
    if isinstance(value, tuple):
        numbers: tuple[Any, ...] = value
        if any(isinstance(one, str) for one in numbers):
            return random.choice(([], [random.choice(TEXTS)], list(numbers[:1]), [*numbers, *numbers]))
        factor = random.choice(FACTORS)
        return [factor * number for number in numbers]
    if isinstance(value, str):
        elsewhere = {other for _, at, other in keys(rig) if at[-1] == place[-1] and isinstance(other, str)}
        return random.choice((*TEXTS, *sorted(elsewhere)))
    return {"nonsense": random.choice((1e9, "nonsense"))}


def _put(tree: Tree, place: Place, value: Any) -> None:
    section: Any = tree.data
    for key in place[:-1]:
        section = section.setdefault(key, {})
    section[place[-1]] = value


def _commission(name: str, runs: Path) -> None:
    """Record the required steps of commissioning as done with the earlier file."""
    rig = _real(name)[1]
    part = kinds.find(rig.kind).commissions
    record = CommissionRecord(record_path(runs, rig.name), clock.utc_now, "the builder")
    for step in part().steps if part is not None else ():
        if step.required:
            record.add(rig.name, "", sections_sha256(rig, step.sections), step.name, DONE, "")


def _refusal(rig: str, tree: Tree, *overrides: str) -> str:
    try:
        load(type(_real(rig)[1]), tree, overrides)
    except InvalidSource as error:
        return "; ".join(map(str, error.problems))
    return ""


def _tree(rig: str) -> Tree:
    """Return the file of a real rig as mutable data."""
    return deepcopy(_real(rig)[0])


@cache
def _real(rig: str) -> tuple[Tree, Rig]:
    """Return the file of a real rig that resembles a packaged one, and the rig."""
    packaged = load_rig(rig)
    tree = new_tree(type(packaged), rig)
    data: Any = tree.data
    data |= {"simulated": False, "rig": "a real machine", "like": rig}
    data["can"] |= {"interface": "socketcan", "channel": "can0"}
    for name, line in data["lines"].items():
        line["port"] = f"/dev/{name}"
    for axis in data["axes"].values():
        if axis != {"manual": True}:
            axis["vendor_id"] = OTHER_MAKER
    del data["sim"]
    return tree, checked(type(packaged), deepcopy(tree))
