"""Entries of a catalogue, their reader from a run's folder, and the interface of a catalogue."""

from __future__ import annotations

import json
import platform
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from tester.base.axes import Axes, AxisValue, Setpoint, axes_from
from tester.base.trouble import TroubleError
from tester.base.words import Json, finite
from tester.results.run_results import results_of
from tester.results.table_rows import Measured
from tester.store.record_file import DATABASE
from tester.store.record_schema import StoreError
from tester.store.run_folders import RunStatus, run_folders, under_way
from tester.store.run_reader import RunReader

_MADE_BY = "1"
"""Increase it when the same record yields other entries than before: then all are made anew."""


class CatalogueError(TroubleError):
    """A catalogue cannot be used; the message gives the reason."""


@dataclass(frozen=True, slots=True)
class RunEntry:
    """One run. ``origin`` is the computer and the folder of runs; with the name it is the key."""

    origin: str
    name: str
    fingerprint: str
    """Changes when the run's files change, or a process starts or stops working on it."""
    status: str
    """A word of RunStatus: the run's status when its own computer last looked."""
    recipe: str
    recipe_sha256: str
    compounds: str
    """Separated by line feeds, which no compound holds."""
    operator: str
    simulated: bool
    seed: int | None
    started_utc: str
    ended_utc: str
    rig_seconds: float | None
    software_version: str
    conditions: int
    repeats: int
    repeats_planned: int
    trusted: int
    """Number of conditions with a trustworthy coefficient."""
    problem: str = ""
    kind: str = ""
    """Kind of the rig."""
    axes: str = ""
    """Axes of the run's conditions, as JSON (``Axes.as_data``); "" for an unreadable run."""

    def table(self) -> Axes:
        """Return the axes of the run's conditions; raises ValueError for an unreadable run."""
        return axes_from(json.loads(self.axes))


@dataclass(frozen=True, slots=True)
class ConditionEntry:
    """One condition of a run: setpoints, coefficient, uncertainty (standard and expanded), repeats."""

    condition: int
    replicate: int
    compound: str
    held: str
    """Setpoints as JSON: a value for each axis, by its column in the project's tables."""
    status: str
    mu: float | None
    s: float | None
    u_standard: float | None
    u_expanded: float | None
    n_valid: int
    n: int
    flags: str = ""
    """With ``status`` determines the trust in the coefficient (tester.analysis.results)."""

    def setpoint(self, axes: Axes) -> Setpoint:
        """Return the setpoints, on the axes of the condition's run."""
        values: dict[str, AxisValue] = json.loads(self.held)
        by_name = {axis.name: values[axis.column] for axis in axes}
        scaled = {
            axis.name: value if isinstance(value := by_name[axis.name], str) else value / axis.scale for axis in axes
        }
        return axes.setpoint(self.compound, **scaled)


@dataclass(frozen=True, slots=True)
class WantedRuns:
    """Filter of runs: every field that is not empty narrows it. ``since`` and ``until`` are the beginnings of ISO
    dates."""

    compound: str = ""
    since: str = ""
    until: str = ""
    recipe: str = ""


class Catalogue(Protocol):
    """Runs and conditions, by origin and name."""

    def fingerprints(self, origin: str) -> dict[str, str]:
        """Return the fingerprint of every run of an origin, by name."""
        ...

    def put(self, run: RunEntry, conditions: Iterable[ConditionEntry]) -> None:
        """Store a run, in place of any earlier entry."""
        ...

    def remove(self, origin: str, name: str) -> None:
        """Remove a run."""
        ...

    def runs(self, wanted: WantedRuns) -> list[RunEntry]:
        """Return the runs that pass the filter, by start."""
        ...

    def conditions(self, run: RunEntry) -> list[ConditionEntry]:
        """Return a run's conditions in order."""
        ...

    def close(self) -> None:
        """Close it."""
        ...


def entry_json(run: RunEntry) -> dict[str, Json]:
    """Return a run as `tester runs --json` prints it; of an unreadable one only its name and the problem."""
    found: dict[str, Json] = {"run": run.name, "origin": run.origin}
    if run.problem:
        return found | {"status": run.status, "problem": run.problem}
    return {
        **found,
        "status": run.status, "recipe": run.recipe, "operator": run.operator, "started_utc": run.started_utc,
        "ended_utc": run.ended_utc or None,
        "compounds": list[Json](run.compounds.split("\n")),
        "rig_seconds": None if run.rig_seconds is None else finite(run.rig_seconds),
        "simulated": run.simulated, "seed": run.seed,
        "conditions": run.conditions, "repeats": run.repeats, "repeats_planned": run.repeats_planned,
        "values": run.trusted,
        "can_resume": RunStatus(run.status).can_resume,
    }  # fmt: skip


def origin_of(under: Path) -> str:
    """Return the origin of the runs under a folder."""
    return f"{platform.node()}:{under.absolute()}"


def refresh(catalogue: Catalogue, under: Path) -> None:
    """Bring a catalogue up to date with the runs under a folder; unchanged runs are not read again."""
    origin = origin_of(under)
    known = catalogue.fingerprints(origin)
    for folder in run_folders(under):
        print_ = fingerprint(folder)
        if known.pop(folder.name, None) != print_:
            catalogue.put(*read_entries(folder, origin, print_))
    for name in known:
        catalogue.remove(origin, name)


def fingerprint(folder: Path) -> str:
    """Return a text that changes with a run's entries: size and time of the database and its log, and whether it is in
    use."""
    parts = [_MADE_BY] if under_way(folder) is None else [_MADE_BY, "held"]
    for name in (DATABASE, f"{DATABASE}-wal"):
        path = folder / name
        if path.is_file():
            stat = path.stat()
            parts.append(f"{stat.st_size}.{stat.st_mtime_ns}")
    return "/".join(parts)


def read_entries(folder: Path, origin: str, print_: str) -> tuple[RunEntry, list[ConditionEntry]]:
    """Return a run's entries; an unreadable run gets an entry with the problem."""
    try:
        with RunReader(folder) as reader:
            results = results_of(reader)
    except StoreError as error:
        return _unreadable(folder, origin, print_, str(error)), []
    run, conditions = results.run, list(results.conditions())
    compounds = dict.fromkeys(measured.info.compound for measured in conditions)
    entry = RunEntry(
        origin=origin,
        name=folder.name,
        fingerprint=print_,
        status=results.status.value,
        recipe=run.info.recipe_name,
        recipe_sha256=run.recipe_sha256,
        compounds="\n".join(compounds),
        operator=run.info.operator,
        simulated=run.info.simulated,
        seed=run.info.seed,
        started_utc=run.info.started_utc,
        ended_utc=run.ended_utc,
        rig_seconds=finite(run.rig_seconds),
        software_version=run.info.software_version,
        conditions=len(results.rows),
        repeats=sum(len(measured.repeats) for measured in conditions),
        repeats_planned=sum(measured.info.repeats_planned for measured in conditions),
        trusted=results.valued(),
        kind=run.info.kind,
        axes=json.dumps(results.axes.as_data(), ensure_ascii=False),
    )
    return entry, [_condition(measured) for measured in conditions]


def _condition(measured: Measured) -> ConditionEntry:
    i, r = measured.info, measured.result
    return ConditionEntry(
        condition=i.condition,
        replicate=i.replicate,
        compound=i.compound,
        held=json.dumps({axis.column: axis.of(i.setpoint) for axis in i.setpoint.axes}),
        status=r.status.value,
        mu=finite(r.mu),
        s=finite(r.s),
        u_standard=finite(r.budget.standard),
        u_expanded=finite(r.budget.expanded),
        n_valid=r.n_valid,
        n=r.counts.asked,
        flags=r.flags,
    )


def _unreadable(folder: Path, origin: str, print_: str, problem: str) -> RunEntry:
    status = RunStatus.UNREADABLE.value
    return RunEntry(
        origin, folder.name, print_, status, "", "", "", "", False, None, "", "", None, "", 0, 0, 0, 0, problem
    )
