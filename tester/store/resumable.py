"""The start of a resumed run: which conditions are finished, the committed repeats of the others, the mounted wheel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite

from tester.analysis.blocks import Block, blocks_from_samples
from tester.analysis.results import NOT_JUDGED, ConditionStatus, Judgement, RepeatResult, RepeatStatus
from tester.analysis.schemes import Scheme
from tester.analysis.uncertainty import NOTHING_POOLED, Pool
from tester.inputs.recipe.plan import Mounted, Stand
from tester.store.records import NAN, PieceInfo, StoredCondition, StoredRepeat
from tester.store.run_folders import WENT_THROUGH
from tester.store.run_reader import RunReader

ENDS_A_CONDITION = (RepeatStatus.CANNOT_HOLD, RepeatStatus.NOT_REACHED)
"""A repeat with one of these statuses is its condition's last."""


@dataclass(frozen=True, slots=True)
class ConditionSoFar:
    """The committed part of an unfinished condition."""

    results: tuple[RepeatResult, ...] = ()
    """Results of its committed repeats, in order."""
    attempts: Mapping[int, int] = field(default_factory=dict[int, int])
    """Number of attempts at each repeat, committed or not."""
    warming_k_s: float = NAN
    holdable_band_k: float = NAN
    keys: tuple[int, ...] = ()
    """Keys of the results' repeats."""
    blocks: tuple[tuple[Block, ...], ...] = ()
    """Blocks of the results' repeats, from their samples: the data from which the condition is judged."""
    judged: Judgement = NOT_JUDGED
    """Judgement at the last commit of a repeat."""

    @property
    def over(self) -> RepeatStatus | None:
        """Return the status of the last repeat if it ended the condition; None if the condition continues."""
        status = self.results[-1].status if self.results else None
        return status if status in ENDS_A_CONDITION else None


@dataclass(frozen=True, slots=True)
class ResumePoint:
    """The start of a resumed run. Times in rig seconds of the whole run."""

    finished: bool
    origin_s: float
    """Rig time at which the run continues: that of the last entry."""
    stand: Stand
    conditions: Mapping[int, ConditionSoFar]
    """Unfinished conditions by number; a condition that is missing here has nothing committed."""
    reference_tare: Mapping[str, float] | None
    """Zero of each channel of the load cell, by its name, measured when the present wheel was mounted."""
    session: int
    """Number of the next session."""
    pool: Pool = NOTHING_POOLED
    """Repeatability of the finished conditions."""

    @property
    def next_repeat(self) -> tuple[int, int] | None:
        """Return condition and repeat of the first repeat begun and not committed; None if there is none."""
        for number, condition in sorted(self.conditions.items()):
            if condition.over is None:
                return number, len(condition.results) + 1
        return None


def resume_point(reader: RunReader) -> ResumePoint:
    """Return the start of a resumed run; raises StoreError if the record cannot be read."""
    run = reader.run()
    repeats: dict[int, list[StoredRepeat]] = {}
    for repeat in reader.repeats(attempts=True):
        repeats.setdefault(repeat.condition, []).append(repeat)
    ended: set[int] = set()
    schemes: dict[int, Scheme] = {}
    open_: dict[int, ConditionSoFar] = {}
    for stored in reader.conditions():
        number = stored.info.condition
        schemes[number] = stored.info.scheme
        if stored.status not in (None, ConditionStatus.PENDING):
            ended.add(number)
        elif number in repeats:
            open_[number] = _so_far(reader, repeats[number], stored)
    sessions = reader.sessions()
    return ResumePoint(
        finished=run.status == WENT_THROUGH,
        origin_s=run.rig_seconds if isfinite(run.rig_seconds) else 0.0,
        stand=Stand(
            frozenset(ended), frozenset(repeats), tuple(_pieces(reader.pieces(), repeats)), reader.counterfaces_m()
        ),
        conditions=open_,
        reference_tare=_reference(reader),
        session=max((s.session for s in sessions), default=1) + 1,
        pool=_pooled(repeats, ended, schemes),
    )


def _so_far(reader: RunReader, attempts: list[StoredRepeat], stored: StoredCondition) -> ConditionSoFar:
    committed = {r.repeat: r for r in attempts if r.result.status not in (RepeatStatus.OPEN, RepeatStatus.VOID)}
    in_order: list[StoredRepeat] = []
    # A gap ends the committed part: repeats after it are measured again.
    while len(in_order) + 1 in committed:
        in_order.append(committed[len(in_order) + 1])
    counted: dict[int, int] = {}
    for r in attempts:
        counted[r.repeat] = max(counted.get(r.repeat, 0), r.attempt)
    return ConditionSoFar(
        tuple(r.result for r in in_order),
        counted,
        stored.warming_k_s,
        stored.holdable_band_k,
        tuple(r.key for r in in_order),
        tuple(tuple(_blocks(reader, r)) for r in in_order),
        stored.judged,
    )


def _blocks(reader: RunReader, r: StoredRepeat) -> list[Block]:
    return blocks_from_samples(reader.samples(r.condition, r.repeat, r.attempt), reader.quantities())


def _pooled(repeats: Mapping[int, list[StoredRepeat]], ended: set[int], schemes: Mapping[int, Scheme]) -> Pool:
    """Return the repeatability of the finished conditions, in their order."""
    pool = Pool()
    for number in sorted(ended & repeats.keys()):
        last = {r.repeat: r.result for r in repeats[number] if r.result.status is not RepeatStatus.VOID}
        scheme = schemes[number]
        pool = pool.with_condition(scheme.values(list(last.values())), scheme.repeats_each)
    return pool


def _pieces(pieces: list[PieceInfo], repeats: Mapping[int, list[StoredRepeat]]) -> list[Mounted]:
    """Return the mounted pieces in order, each with the last condition for which it was used."""
    used: dict[int, int] = {}
    for condition, attempts in repeats.items():
        for repeat in attempts:
            used[repeat.piece] = max(used.get(repeat.piece, 0), condition)
    return [
        Mounted(
            number=w.piece,
            specimen=w.specimen,
            replicate=w.replicate,
            diameter_mm=w.diameter_mm,
            sliding_m=w.sliding_m,
            ground=isfinite(w.ground_s),
            last_condition=used.get(w.piece, 0),
        )
        for w in sorted(pieces, key=lambda w: (w.installed_s, w.piece))
    ]


def _reference(reader: RunReader) -> Mapping[str, float] | None:
    zeros = None
    for tare in reader.tares():
        if tare.kind == "reference":
            zeros = tare.zeros
    return zeros
