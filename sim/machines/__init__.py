"""Kinds of simulated machines, found by name: a folder here each, or ``package.module:OBJECT`` of another package.

A kind's package has a ``MACHINE`` (``SimulatedMachine``). Only ``tester.run`` looks a machine up, by the name in a kind
of rig: no name comes from a rig file or a client.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules

from sim.faults.language import FaultLanguage
from sim.hands import Verb
from sim.rig import RigSpec, SimRig


class UnknownMachineError(LookupError):
    """A kind of machine without a simulation; the message names the kinds that have one."""


@dataclass(frozen=True, slots=True)
class SimulatedMachine:
    """The parts of a kind of machine that its simulation needs."""

    world: Callable[..., SimRig]
    """``world(spec, parameters, seed, can_wire)``: the rig with a wiring (``sim.rig.RigSpec``), with the kind's own
    parameters (the rig file's section ``sim``), all random numbers from ``seed`` (an integer), on a bus of this class.
    """
    language: Callable[[RigSpec], FaultLanguage]
    """The language of the fault scripts for a rig with this wiring; called only when faults are scripted."""
    log_columns: tuple[str, ...]
    log_row: Callable[..., tuple[float, ...]]
    """``log_row(rig)``: true values for a log of its state, one for each column, each with its number of decimals."""
    log_decimals: tuple[int, ...]
    verbs: tuple[Verb, ...] = ()
    """What a person does at it, as commands of its console."""


def names() -> tuple[str, ...]:
    """Return the kinds that are simulated here."""
    return tuple(sorted(module.name for module in iter_modules(__path__) if module.ispkg))


def find(kind: str) -> SimulatedMachine:
    """Return a kind's machine, by one of ``names`` or by a dotted name, ``package.module:OBJECT``. Raises
    UnknownMachineError."""
    known = names()
    module, colon, attribute = kind.partition(":")
    if not colon and kind not in known:
        raise UnknownMachineError(f"no simulated machine {kind!r}; known: {', '.join(known)}")
    try:
        machine = getattr(import_module(module if colon else f"{__name__}.{kind}"), attribute or "MACHINE")
    except (ImportError, AttributeError) as error:
        raise UnknownMachineError(f"no simulated machine {kind!r}: {error}") from error
    if not isinstance(machine, SimulatedMachine):
        raise UnknownMachineError(f"{kind} is no simulated machine (expected a sim.machines.SimulatedMachine)")
    return machine
