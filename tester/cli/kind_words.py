"""What a run's kind of rig gives figures and reports: published values, laws, what its coefficient is, its rig file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from tester.kinds.kind import Kind
    from tester.report.charts import Material
    from tester.report.record_section import MachineWords
    from tester.results.run_results import RunResults
    from tester.store.records import RunInfo


def kind_of(info: RunInfo) -> Kind | None:
    """Return the kind of a run's rig, None where it is not installed."""
    from tester.kinds import UnknownKindError, find

    try:
        return find(info.kind)
    except UnknownKindError:
        return None


def material_of(results: RunResults, law: str, published: bool) -> Material:
    """Return what a run's figures may show; a law that is none is a usage error."""
    from tester.report.charts import ChartValue, Material, values_of

    measured = values_of(results)
    kind = kind_of(results.run.info)
    fits = kind.fits if kind is not None else None
    if fits is None:
        if law:
            raise click.UsageError(f"--law: no law is known of the kind {results.run.info.kind}")
        return Material(measured)
    part = fits()
    beside = [ChartValue(held, mu) for held, mu in part.published_values()] if published else []
    if not law:
        return Material(measured, beside)
    try:
        return Material(measured, beside, part.law_at(law), f"law {law}", part.law_caveats)
    except KeyError as error:
        known = ", ".join(part.published_laws)
        expected = f"expected {known}" if known else "of this kind of rig no law has any: fit one with tester fit"
        raise click.UsageError(f"--law: no law {law!r} with published parameters ({expected})") from error


def words_of(info: RunInfo) -> MachineWords:
    """Return what a run's kind says of itself, and its packaged rig file that the run's is like, or its first."""
    from tester.kinds import load_rig, packaged_rigs, packaged_text
    from tester.report.record_section import MachineWords

    kind = kind_of(info)
    if kind is None:
        return MachineWords(info.kind, "")
    ring = kind.ring() if kind.ring is not None else None
    like = info.rig_source if info.rig_source in kind.rigs else next(iter(kind.rigs), "")
    if like not in packaged_rigs():  # a laboratory's own kind says in its own files what it assumes
        return MachineWords(kind.title, kind.measurand, ring=ring)
    return MachineWords(kind.title, kind.measurand, packaged_text(like), load_rig(like).text, ring)
