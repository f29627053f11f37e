"""Write docs/commands.md from the commands themselves: usage, help text, options.

``python docs/commands.py`` writes the page; ``--check`` only reports whether it is out of date and exits 1.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import click

from tester.cli.command_table import SECTIONS
from tester.cli.main import root

PAGE = Path(__file__).with_name("commands.md")
HEAD = """# Commands

`tester COMMAND --help` explains every option. `tester` alone lists what you can do next in this folder. This page is
written by `python docs/commands.py` from the commands themselves.

Standard output is data, standard error is messages. Exit codes: 0 done, 1 run failed, 2 usage, 3 invalid recipe or rig
file, 4 rig unreachable, 5 tripped or stopped, 6 incomplete, 130 interrupted, 141 the reader of the output is gone.
"""


def page_text() -> str:
    """Return the page: a table for each section of `tester --help`."""
    context = click.Context(root, info_name="tester")
    text = HEAD
    for title, listed in SECTIONS.items():
        text += f"\n## {title}\n\n| command | does | options |\n|---|---|---|\n"
        for name in listed:
            command = root.get_command(context, name)
            assert command is not None
            text += "".join(rows(command, click.Context(command, context, info_name=name)))
    return text


def rows(command: click.Command, context: click.Context) -> Iterator[str]:
    """Yield the row of a command, or those of the commands of a group."""
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            assert inner is not None
            yield from rows(inner, click.Context(inner, context, info_name=name))
        return
    arguments = [one.make_metavar(context) for one in command.params if isinstance(one, click.Argument)]
    usage = " ".join([context.command_path, *arguments])
    options = [option.opts[0] for option in command.params if isinstance(option, click.Option) and not option.hidden]
    first = (command.help or "").partition("\n\n")[0]
    cells = f"`{usage}`", " ".join(first.split()), ", ".join(f"`{one}`" for one in options)
    yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |\n"


def main(arguments: list[str]) -> int:
    """Write, or with ``--check`` only compare."""
    text = page_text()
    fresh = PAGE.is_file() and PAGE.read_text(encoding="utf-8") == text
    if not fresh and "--check" not in arguments:
        PAGE.write_text(text, encoding="utf-8", newline="\n")
    if not fresh:
        print(f"docs/{PAGE.name}: {'out of date' if '--check' in arguments else 'written'}")
    return 1 if not fresh and "--check" in arguments else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
