"""What is wrong with a text that is no YAML, in the words of somebody who writes it."""

from __future__ import annotations

from yaml.error import MarkedYAMLError

from tester.base.plain import harmless

LEVELS = 3
"""Indentations that a message names at most, the deepest first."""


def plainer(error: MarkedYAMLError, text: str, line: int) -> str:
    """Return PyYAML's message in one line, in plain words where its own are hard to understand.

    ``line``: of the text, from 1, where the problem is.
    """
    message = " ".join(f"{error.problem or ''}".split())
    if "'\\t'" in message:
        return "a tab where spaces are due (indent with spaces)"
    not_allowed = "mapping values are not allowed" in message
    if not_allowed or "<block end>" in message:
        levels = _levels(text, line)
        blanks = _indent(text.split("\n")[line - 1])
        if blanks not in levels:
            listed = [f"{wanted} as in line {at}" for wanted, at in sorted(levels.items(), reverse=True)[:LEVELS]]
            return f"the line is indented by {blanks} (expected {' or '.join(listed)})"
    if not_allowed:
        return "a colon is not expected here (a text that holds ': ' needs quotes)"
    if "found '-'" in message:
        return "an item of a list (- ...) among keys"
    bracket = next((one for one in "]}" if f"',' or '{one}'" in message), "")
    if bracket:
        since = f" opened in line {error.context_mark.line + 1}" if error.context_mark else ""
        return f"a comma or {bracket} is missing (for the bracket{since})"
    context = " ".join(f"{error.context or ''}".split())
    return harmless(f"{message} {context}".strip())


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


def _levels(text: str, line: int) -> dict[int, int]:
    """Return the indentations with which a line may begin, each with the nearest line above that has it.

    ``line`` counts from 1. Of a list's item, ``- key: value``, the key has an indentation, too.
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
