"""Messages about a text that is no YAML, in words for its author."""

from __future__ import annotations

from yaml.error import MarkedYAMLError

from tester.base.words import harmless

LEVELS = 3
"""Most indentations that a message names, the deepest first."""
_OUT_OF_PLACE = ("<block end>", "<document start>", "did not find expected key", "did not find expected '-'")
"""Parts of either parser's messages about a line in the wrong place: usually its indentation is wrong."""


OUT_OF_RANGE = "a number in an escape or directive is out of range"


def too_deep(levels: int) -> str:
    """Return the message for a text of more levels than these."""
    return f"nested deeper than {levels} levels"


def plainer(error: MarkedYAMLError, text: str, line: int, column: int, max_depth: int) -> str:
    """Return PyYAML's or libyaml's message in one line, in plain words where their own are hard to understand.

    ``line``, ``column``: place of the problem in the text, from 1; ``max_depth``: allowed levels of a file.
    """
    message = " ".join(f"{error.problem or ''}".split())
    here = [*text.split("\n"), ""][line - 1]  # an unfinished text has its problem behind its last line
    content, character = here.lstrip(" "), here[column - 1 : column]
    if "nesting depth" in message:
        return too_deep(max_depth)
    if "Unicode character escape" in message or "long version number" in message:
        return OUT_OF_RANGE
    if "tab character" in message or (character == "\t" and "cannot start" in message):
        return "a tab where spaces are due (indent with spaces)"
    if character and "cannot start" in message:
        return f"{harmless(character)} cannot begin a text (a text that begins with it needs quotes)"
    not_allowed = "mapping values are not allowed" in message
    if not_allowed or any(marker in message for marker in _OUT_OF_PLACE):
        levels = _levels(text, line)
        blanks = _indent(here)
        if blanks not in levels:
            listed = [f"{wanted} as in line {at}" for wanted, at in sorted(levels.items(), reverse=True)[:LEVELS]]
            return f"the line is indented by {blanks} (expected {' or '.join(listed)})"
        if content.startswith("- ") and not not_allowed:
            return "an item of a list (- ...) among keys"
    if not_allowed:
        return "a colon is not expected here (a text that holds ': ' needs quotes)"
    bracket = next((marker for marker in "]}" if f"',' or '{marker}'" in message), "")
    if bracket:
        since = f" opened in line {error.context_mark.line + 1}" if error.context_mark else ""
        return f"a comma or {bracket} is missing (for the bracket{since})"
    context = " ".join(f"{error.context or ''}".split())
    return harmless(f"{message} {context}".strip())


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


def _levels(text: str, line: int) -> dict[int, int]:
    """Return the possible indentations of a line, each with the nearest line above that has it.

    ``line`` counts from 1. In a list's item, ``- key: value``, the key has an indentation as well.
    """
    levels: dict[int, int] = {}
    for number, above in enumerate(text.split("\n")[: line - 1], 1):
        content = above.lstrip(" ")
        if not content or content.startswith("#"):
            continue
        blanks = _indent(above)
        levels = {level: at for level, at in levels.items() if level < blanks}
        levels[blanks] = number
        while content.startswith("- "):
            content = content[1:].lstrip(" ")
            blanks = len(above) - len(content)
            levels[blanks] = number
    return levels or {0: 1}
