"""What changed between two states of an item's surroundings, in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, cast

from tester.base.source import InvalidSource, load_tree
from tester.queue.items import Hashes

NAMED: Final = 6
"""Greatest number of keys named in a difference; further ones are counted."""


def differences(then: Hashes, now: Hashes, rig_then: str, rig_now: str) -> list[str]:
    """Return what differs, a text each; empty for the same hashes. ``rig_then``, ``rig_now``: texts of the rig, ""
    where the text is not kept.
    """
    found: list[str] = []
    if then.rig != now.rig:
        keys = rig_differences(rig_then, rig_now)
        more = f"; and {len(keys) - NAMED} more" if len(keys) > NAMED else ""
        found.append(f"the rig file changed ({'; '.join(keys[:NAMED]) or 'in comments or order only'}{more})")
    if then.calibration != now.calibration:
        found.append("the calibration changed")
    return [*found, *_materials(dict(then.materials), dict(now.materials))]


def rig_differences(then: str, now: str) -> list[str]:
    """Return the keys of two texts of a rig whose values differ, in words."""
    if not then:
        return ["its earlier text is not kept"]
    try:
        before, after = (dict(_flat(load_tree(text, "rig.yaml").data)) for text in (then, now))
    except InvalidSource as error:
        return [f"a text cannot be read: {error.problems[0].message}"]
    keys = [*before, *(key for key in after if key not in before)]
    return [
        f"{key}: {after.get(key, 'not there')}, was {before.get(key, 'not there')}"
        for key in keys
        if before.get(key) != after.get(key)
    ]


def _flat(value: object, key: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for name, inner in cast("dict[object, object]", value).items():
            yield from _flat(inner, f"{key}.{name}" if key else f"{name}")
    else:
        yield key, str(value)


def _materials(then: dict[str, str], now: dict[str, str]) -> Iterator[str]:
    for name in [*then, *(name for name in now if name not in then)]:
        before, after = then.get(name), now.get(name)
        if before == after:
            continue
        if not after:
            yield f"the file of {name} is gone" if before else f"{name} is not used any more"
        elif not before:
            yield f"a file now describes {name}"
        else:
            yield f"the file of {name} changed"
