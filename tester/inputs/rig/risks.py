"""Values of a rig that a person must accept, and those that only its file sets (tester.inputs.rig.key_classes)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from typing import Final

from drivers.canopen.dictionary import PRODUCT_CODE, VENDOR_ID
from tester.inputs.rig.config import Rig
from tester.inputs.rig.key_classes import Ceiling, Held
from tester.inputs.rig.rig_keys import Place, RigKey, value_at, values_of

_SAID_ONCE = {"heartbeat": "drive_heartbeat", "consumer_heartbeat": "consumer_heartbeat"}
"""Keys of an axis that the section ``can`` sets for all: their risk is reported once."""


@dataclass(frozen=True, slots=True)
class Risk:
    """A value of a rig that needs a person's acceptance."""

    location: Place
    compared: str
    """The value and what it is compared with, in words."""
    because: str

    @property
    def key(self) -> str:
        """Return the key as in the rig file."""
        return ".".join(self.location)

    def __str__(self) -> str:
        """Return key, value and limit."""
        return f"{self.key} {self.compared}"


def counts_as_simulated(rig: Rig) -> bool:
    """Return whether a rig is harmless: it is simulated in this process, or behind a door.

    All drives of a rig behind a door must report the simulator's identity (0x1018). The identity is compared at every
    connect, before anything moves: with other drives on the wire the run does not begin.
    """
    ids = {(drive.vendor_id, drive.product_code) for drive in rig.drives().values()}
    return rig.simulated or ids == {(VENDOR_ID, PRODUCT_CODE)}


def loosened(rig: Rig, than: Rig, *, packaged: bool = False) -> tuple[Risk, ...]:
    """Return the safety keys that are looser in one rig than in another; axes that only one has are left out.

    ``packaged``: the other is the packaged rig, from which a machine's own values may differ (``Bounded.own``).
    """
    risks: list[Risk] = []
    for ceiling, place, value in _bounded(rig):
        to_hardest = packaged and ceiling.bound.own
        limit = ceiling.limit if to_hardest else _number(value_at(than, place))
        if limit is not None and ceiling.looser(value, limit):
            beyond_too = ceiling.looser(value, ceiling.limit) and limit != ceiling.limit
            hardest = f" and than {ceiling.bound.hardest}" if beyond_too else ""
            compared = f"{ceiling.text(value)} is looser than {ceiling.text(limit)}{hardest}"
            risks.append(Risk(place, compared, ceiling.bound.because))
    return tuple(risks)


def beyond(rig: Rig) -> tuple[Risk, ...]:
    """Return the safety keys that are looser than their hardest values."""
    return tuple(
        Risk(place, f"{ceiling.text(value)} is looser than {ceiling.text(ceiling.limit)}", ceiling.bound.because)
        for ceiling, place, value in _bounded(rig)
        if ceiling.looser(value, ceiling.limit)
    )


def apart(rig: Rig, than: Rig) -> tuple[Risk, ...]:
    """Return the held keys that differ from another rig's by more than their share (``Held.within``)."""
    risks: list[Risk] = []
    for key, place, value in values_of(rig):
        key_class = key.classes[0] if key.classes else None
        if isinstance(key_class, Held) and key_class.within < inf:
            number, expected = _number(value), _number(value_at(than, place))
            if number is None or expected is None:
                continue
            if not abs(number - expected) <= key_class.within * expected:
                unit = f" {key.unit}".removesuffix(" 1").rstrip()
                share = f"is not within {100.0 * key_class.within:.0f} % of {expected:g}{unit}"
                risks.append(Risk(place, f"{number:g}{unit} {share}", f"held against {key_class.against}"))
    return tuple(risks)


def redescribed(rig: Rig, than: Rig) -> tuple[Risk, ...]:
    """Return the keys that describe the machine and differ between two rigs, also if only one of them has the key."""
    ours, theirs = _described(rig), _described(than)
    risks: list[Risk] = []
    for place in {**ours, **theirs}:
        value, key = ours.get(place, _NOTHING)
        expected, other = theirs.get(place, _NOTHING)
        classes = (key or other).classes
        if value != expected:
            against = f"held against {classes[0].against}" if classes and isinstance(classes[0], Held) else "no class"
            risks.append(Risk(place, f"{_text(value)} replaces {_text(expected)}", against))
    return tuple(risks)


_NOTHING: Final = (None, RigKey((), "", ()))


def _described(rig: Rig) -> dict[Place, tuple[object, RigKey]]:
    return {place: (value, key) for key, place, value in values_of(rig) if key.described}


def _text(value: object) -> str:
    return "nothing" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _bounded(rig: Rig) -> Iterator[tuple[Ceiling, Place, float]]:
    """Yield every bound of a safety key that a rig has, with its place and its value (1 and 0 for a switch)."""
    for key, place, value in values_of(rig):
        number = _number(value)
        if number is None or (place[0] == "axes" and number == value_at(rig, ("can", _SAID_ONCE.get(place[-1], "")))):
            continue  # a value that `can` sets for all axes is reported once, there
        for ceiling in key.ceilings:
            yield ceiling, place, number


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) else None
