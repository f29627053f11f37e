"""Where the run is: campaign, repeat, and the step under way with its soak."""

from __future__ import annotations

from tester.base.words import decimal, duration
from tester.service.state_view import Gate, ProgressView, SoakView
from tester.tui.formatting import clean, fit
from tester.tui.screen_scene import UNDER_WAY, ScreenScene, mode_words
from tester.tui.widgets.panel_base import FAINT, NOTICE, Panel, Parts, rows

DONE, LEFT = "━", "─"
NAME = 10


class ProgressPanel(Panel):
    """Three lines: campaign, repeat, step."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return campaign, repeat, step."""
        state = scene.state
        if state is None:
            return []
        progress = state.progress
        if not progress.steps:
            return idle_words(scene, width)
        share = min(max(progress.share, 0.0), 1.0)
        left = f"   {duration(progress.left_s)} left" if progress.left_s is not None else ""
        whole = _line("Campaign", share, f"{100 * share:3.0f} %{left}", width)
        return rows([whole, _repeat(progress, width), _step(progress, state.soak, state.gates, width)])


def idle_words(scene: ScreenScene, width: int) -> Parts:
    """Return the panel's content while no run is under way."""
    state = scene.state
    if state is None:
        return []
    lines: list[Parts] = [[fit(f" {clean(mode_words(state))}: {clean(state.mode_text)}", width)]]
    run = state.run
    if run is not None and run.outcome != UNDER_WAY:
        reason = f": {clean(run.reason)}" if run.reason else ""
        key = "Enter shows its results. " if scene.ended_run is not None else ""
        lines.append([fit(f" {key}Last run {clean(run.outcome)}{reason}   {clean(run.name)}", width)])
        if run.missing:
            named = "; ".join(clean(name) for name in run.missing)
            lines.append([fit(f" {len(run.missing)} without a value: {named}", width)])
    if len(lines) < 3 and state.interrupted:
        lines.append([(fit(f" {clean(state.interrupted[-1])} was cut off: r resumes it", width), NOTICE)])
    elif len(lines) < 3 and run is not None and run.outcome not in (UNDER_WAY, "done", "incomplete"):
        lines.append([(fit(" r resumes it, or another unfinished run", width), NOTICE)])
    if len(lines) < 3:
        lines.append([(fit(" F2 chooses a recipe", width), FAINT)])
    return rows(lines)


def _line(name: str, share: float, words: str, width: int) -> Parts:
    room = max(min(width - NAME - len(words) - 4, 60), 0)
    done = round(share * room)
    return [f" {name:<{NAME}}", (DONE * done, "bold"), (LEFT * (room - done), FAINT), f" {words}"]


def _repeat(progress: ProgressView, width: int) -> Parts:
    wanted = progress.revolutions_wanted
    if not progress.repeats or wanted <= 0.0:
        return [f" {'This rep':<{NAME}}", ("—", FAINT)]
    share = min(progress.revolutions / wanted, 1.0)
    words = f"{100 * share:3.0f} %   {progress.revolutions:.0f} / {wanted:.0f} revolutions"
    return _line("This rep", share, f"{words}, burst {progress.burst}" if progress.burst else words, width)


def _step(progress: ProgressView, soak: SoakView | None, gates: tuple[Gate, ...], width: int) -> Parts:
    text = f" {progress.step}/{progress.steps} {clean(progress.title)}"
    if progress.phase:
        text += f": {clean(progress.phase)}"
    if soak is not None:
        words = soak_words(soak)
        if len(text) + 3 + len(words) > width:  # the condition comes first
            words = soak_words(soak, short=True)
        return [fit(text, max(width - len(words) - 3, 0)), "   ", fit(words, width)]
    if progress.burst and (closed := [clean(gate.key) for gate in gates if not gate.open]):
        text += f"   waits for {', '.join(closed)}"
    return [fit(text, width)]


def soak_words(soak: SoakView, *, short: bool = False) -> str:
    """Return a soak in words: 39.6 of 40.0 ± 1.0 °C, in band 3:10 of 10:00; ``short``: 39.6 of 40.0 °C 3:10/10:00."""
    if short:
        at = f"{decimal(soak.surface_c, 1)} of {soak.target_c:.1f} °C"
        return f"{at} {duration(soak.in_band_s)}/{duration(soak.for_s)}"
    band = f"{decimal(soak.surface_c, 1)} of {soak.target_c:.1f} ± {soak.within_k:.1f} °C"
    return f"{band}, in band {duration(soak.in_band_s)} of {duration(soak.for_s)}"
