"""Choose a stored run to resume, from those that `tester resume` accepts, the newest first."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import cast

from pydantic import JsonValue
from textual.content import Content
from textual.widget import Widget
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from tester.service.commands import ResumeRun
from tester.service.state_view import StateView
from tester.tui.dialogs.confirm import GoOnDialog
from tester.tui.dialogs.dialog import Dialog, line
from tester.tui.formatting import clean

Listed = Mapping[str, JsonValue]


def resumable(answer: JsonValue) -> list[Listed]:
    """Return the runs in a list of runs (tester.service.commands.ListRuns) that can be resumed, the newest first."""
    runs = answer.get("runs") if isinstance(answer, dict) else None
    listed = [cast("Listed", run) for run in runs if isinstance(run, dict)] if isinstance(runs, list) else []
    resumables = [run for run in listed if run.get("can_resume") is True]
    return sorted(resumables, key=lambda run: str(run.get("started_utc")), reverse=True)


def run_line(run: Listed) -> str:
    """Return a run in a line: name, status, share committed."""
    committed = f"{run.get('repeats')} of {run.get('repeats_planned')} repeats committed"
    return f"{clean(str(run.get('run')))}  {clean(str(run.get('status')))}, {committed}"


class ResumeDialog(Dialog):
    """Lists runs; Enter shows the pre-flight list for the chosen run."""

    TITLE = "Resume a run"

    def __init__(self, state: StateView, runs: Sequence[Listed]) -> None:
        """``runs``: as ``resumable`` returns them, at least one."""
        super().__init__()
        self.state, self.runs = state, runs

    def on_mount(self) -> None:
        """Focus the newest."""
        self.query_one(OptionList).focus()

    def content(self) -> Iterable[Widget]:
        """Return the list."""
        yield line("Committed repeats stay; the run resumes at the first uncommitted repeat. Enter chooses.")
        yield OptionList(*(Option(Content(run_line(run))) for run in self.runs))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Show the pre-flight list for a run."""
        event.stop()
        host, name = self.host, str(self.runs[event.option_index].get("run"))
        speed = host.options.speed if self.state.simulated else 1.0
        self.dismiss(None)
        host.push_screen(GoOnDialog(self.state, ResumeRun(name, speed), f"{clean(name)} resumes"))
        host.go_to("run")
