"""Exports a table of a run to a file in a separate process, `tester export`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from textual.widget import Widget
from textual.widgets import Input, OptionList
from textual.widgets.option_list import Option

from tester.results.formats import FORMATS, format_names
from tester.tui.dialogs.dialog import Dialog, entry, field, line
from tester.tui.host import HostApp, call


def _choices() -> list[tuple[str, str, str]]:
    """Return name, file name and title of every format, without loading installed packages."""
    others = [(name, name, "of an installed package") for name in format_names() if name not in FORMATS]
    return [(form.name, form.file, form.title) for form in FORMATS.values()] + others


class ExportDialog(Dialog):
    """Asks for the format and the file."""

    TITLE = "Export"

    def __init__(self, name: str, runs: Path) -> None:
        """``name``: of the run in the folder ``runs``."""
        super().__init__()
        self.name_of_run, self.runs = name, runs
        self._formats = _choices()

    def content(self) -> Iterable[Widget]:
        """Return list and field."""
        yield line([(self.name_of_run, "bold")])
        yield OptionList(*(Option(f"{kind:<11} {words}", id=kind) for kind, _, words in self._formats), id="formats",
                         markup=False)  # fmt: skip
        yield field("File", entry("file", limit=1000))
        yield line("Enter writes it; a file of that name is replaced.")

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Name the file for the highlighted format."""
        self.query_one("#file", Input).value = f"{self.name_of_run}-{self._formats[event.option_index][1]}"

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Export, after Enter on a format."""
        event.stop()
        self._write(event.option_index)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Export, after Enter in the field."""
        event.stop()
        self._write(self.query_one("#formats", OptionList).highlighted or 0)

    def _write(self, at: int) -> None:
        path = Path(self.query_one("#file", Input).value.strip())
        if not path.name:
            self.host.say("name a file", problem=True)
            return
        host = self.host
        host.run_worker(_export(host, self.runs / self.name_of_run, self._formats[at][0], path), exit_on_error=False)
        self.dismiss(None)


async def _export(host: HostApp, folder: Path, kind: str, path: Path) -> None:
    """Run the command and report its result."""
    done, words = await call("export", "--format", kind, "--out", str(path), "--", str(folder))
    if not done:
        host.say(f"not exported: {words}", problem=True, lasting=True)
    else:
        host.say(f"exported to {path}" + (f"; {words}" if words else ""), lasting=True)
