"""A master curve as lines of text, and as plain data."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from sim.physics.wlf import GLASS_TO_REFERENCE_K
from tester.analysis.master_curve.fitted_curve import Master
from tester.analysis.master_curve.overlap import TemperaturePair
from tester.analysis.master_curve.rules import Rule
from tester.analysis.master_curve.shift_choice import DECIDES, ShiftChoice
from tester.analysis.master_curve.verdict import TEST_WORDS
from tester.base.words import Json, finite

HEADER = "log10 aT v  mu as measured      degC        v /m/s  off curve %"


def table_lines(master: Master) -> Iterator[str]:
    """Yield the table: x at the reference temperature, the measured values, and the distance of mu from the curve."""
    yield HEADER
    for row in master.rows():
        off = 100.0 * row.off
        yield f"{row.x:>10.4f} {row.mu:>15.4f} {row.temperature_c:>9.2f} {row.speed_m_s:>13.4g} {off:>+12.2f}"


def csv_text(master: Master) -> str:
    """Return the table as CSV with full precision, a header first."""
    lines = ["log10 aT v,mu as measured,Temperature /°C,Speed /m·s⁻¹,ln mu off the curve"]
    lines += [f"{row.x!r},{row.mu!r},{row.temperature_c!r},{row.speed_m_s!r},{row.off!r}" for row in master.rows()]
    return "\n".join(lines) + "\n"


def verdict_lines(master: Master) -> Iterator[str]:
    """Yield the verdict with its reasons."""
    yield f"verdict: {master.judged.verdict.value}"
    yield from (f"  {reason}" for reason in master.judged.reasons)


def summary_lines(master: Master) -> Iterator[str]:
    """Yield the figures behind the verdict."""
    of, judged = master.collapse.of, master.judged
    first = master.points[0]
    sources = ", ".join(dict.fromkeys(point.source.name for point in master.points))
    others = "".join(f", {words}" for words in first.held.values())
    yield (
        f"{first.compound}{others}: {len(master.points)} conditions of {sources}, {len(of.blocks_c)} temperatures from"
        f" {of.blocks_c[0]:g} to {of.blocks_c[-1]:g} degC"
    )
    yield f"Ts {_ts_words(master)}; reference {master.reference_c:g} degC"
    if master.glass_c is not None:
        expected_c = master.glass_c + GLASS_TO_REFERENCE_K
        yield f"the compound's file states Tg {master.glass_c:g} degC: Ts = Tg + 50 K is {expected_c:g} degC"
    c = master.collapse
    yield (
        f"scatter about the curve {100.0 * c.scatter_rms:.2f} % of mu ({c.scatter_mu:.4f} in mu), a cubic spline with"
        f" {c.interior} knots inside"
    )
    for test in judged.tests:
        outcome = "more than chance" if test.failed else "no more than chance"
        yield f"  {TEST_WORDS[test.name]}: F {test.f:.2f}, chance stays below {test.critical:.2f}: {outcome}"
    for peak in master.peaks:
        low, high = peak.interval_m_s
        yield (
            f"maximum: mu {peak.mu:.3f} at {peak.speed_m_s:.3g} m/s (95 %: {low:.3g} to {high:.3g}) and"
            f" {master.reference_c:g} degC"
        )
    if master.bumps:
        yield f"further maxima of the curve that its scatter may have made: {master.bumps}"
    for rule in master.rules:
        yield f"Grosch, {rule.name}: {rule_words(rule)}"
    if master.choice is not None:
        yield choice_words(master.choice)
    yield from _pair_lines(master)


def _ts_words(master: Master) -> str:
    c = master.collapse
    if not c.searched:
        return f"{c.ts_c:.2f} degC, given"
    low, high = c.interval
    thermometer = c.of.thermometer_k
    parts = f"{c.u_fit_k:.2f} K of the fit, {thermometer:.2f} K of the thermometer"
    return f"{c.ts_c:.2f} degC (95 %: {low:.2f} to {high:.2f}; standard uncertainty {parts})"


def rule_words(rule: Rule) -> str:
    """Return the outcome of a rule."""
    if not isfinite(rule.speed_m_s):
        return "the moduli have no such maximum where they are known"
    if rule.peak is None:
        return f"{rule.speed_m_s:.3g} m/s; the curve has no maximum of {rule.mechanism.value}"
    if not rule.assigned:
        return f"{rule.speed_m_s:.3g} m/s; the curve's nearest maximum is {rule.decades:+.2f} decades from it"
    low, high = rule.interval
    return (
        f"{rule.speed_m_s:.3g} m/s; the maximum of {rule.mechanism.value} is {rule.decades:+.2f} decades from it (95 %:"
        f" {low:+.2f} to {high:+.2f}): the rule {rule.verdict.value}"
    )


def choice_words(choice: ShiftChoice) -> str:
    """Return which shift is likelier."""
    best = f"Arrhenius with its best {1e-3 * choice.activation_j_mol:.0f} kJ/mol"
    found = f"ln likelihood {choice.wlf_over_arrhenius:+.1f} (expected beyond {DECIDES:g})"
    outcome = f"{choice.likelier} is likelier" if choice.likelier else "cannot tell"
    return f"WLF against {best}: {found}: {outcome}"


def _pair_lines(master: Master) -> Iterator[str]:
    yield "neighbours, shift in decades:    free     WLF  difference  overlap"
    for pair in master.pairs:
        free = f"{pair.free:>8.2f}" if isfinite(pair.free) else f"{'-':>8}"
        difference = f"{pair.difference:>+12.2f}" if isfinite(pair.difference) else f"{'-':>12}"
        thin = "  thin" if pair.thin else ""
        yield (
            f"  {pair.colder_c:>6g} and {pair.warmer_c:>6g} degC     {free} {pair.wlf:>7.2f} {difference}"
            f" {max(pair.overlap, 0.0):>8.2f}{thin}"
        )
    thin = [f"{pair.colder_c:g} and {pair.warmer_c:g} degC" for pair in master.pairs if pair.thin]
    if thin:
        yield f"thin overlap, where a shift shows little: {', '.join(thin)}"


def plain(master: Master) -> dict[str, Json]:
    """Return a master curve as data: SI units except degC, shifts in decades, NaN and infinity as None."""
    c, judged = master.collapse, master.judged
    rows: list[Json] = [
        {
            "x": row.x,
            "mu_as_measured": row.mu,
            "temperature_c": row.temperature_c,
            "speed_m_s": row.speed_m_s,
            "off_ln": row.off,
        }
        for row in master.rows()
    ]
    tests: list[Json] = [
        {"asks": TEST_WORDS[test.name], "f": test.f, "critical": test.critical, "failed": test.failed}
        for test in judged.tests
    ]
    return {
        "compound": master.points[0].compound,
        "held": {**master.points[0].held},
        "verdict": judged.verdict.value,
        "reasons": [*judged.reasons],
        "reference_c": master.reference_c,
        "ts_c": c.ts_c,
        "ts_given": not c.searched,
        "ts_interval_c": [*c.interval],
        "u_fit_k": c.u_fit_k,
        "glass_c": master.glass_c,
        "u_thermometer_k": c.of.thermometer_k,
        "scatter_ln": c.scatter_rms,
        "scatter_mu": c.scatter_mu,
        "interior_knots": c.interior,
        "tests": tests,
        "peaks": [
            {"speed_m_s": peak.speed_m_s, "mu": peak.mu, "interval_m_s": [finite(end) for end in peak.interval_m_s]}
            for peak in master.peaks
        ],
        "bumps": master.bumps,
        "rules": [_rule(rule) for rule in master.rules],
        "shift": _shift(master.choice),
        "neighbours": [_pair(pair) for pair in master.pairs],
        "rows": rows,
    }


def _rule(rule: Rule) -> Json:
    return {
        "rule": rule.name,
        "mechanism": rule.mechanism.value,
        "speed_m_s": finite(rule.speed_m_s),
        "decades": finite(rule.decades),
        "interval_decades": [finite(end) for end in rule.interval],
        "verdict": rule.verdict.value,
    }


def _shift(choice: ShiftChoice | None) -> Json:
    if choice is None:
        return None
    return {
        "activation_j_mol": choice.activation_j_mol,
        "wlf_over_arrhenius": choice.wlf_over_arrhenius,
        "likelier": choice.likelier,
    }


def _pair(pair: TemperaturePair) -> Json:
    return {
        "colder_c": pair.colder_c,
        "warmer_c": pair.warmer_c,
        "free": finite(pair.free),
        "wlf": pair.wlf,
        "difference": finite(pair.difference),
        "overlap": pair.overlap,
        "thin": pair.thin,
    }
