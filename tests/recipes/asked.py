"""The rig and the settings named in the head of a packaged recipe's file."""

from __future__ import annotations

import re
from pathlib import Path

import recipes

RIG = re.compile(r"--rig ([\w-]+)")
SET = re.compile(r'--set (?:"([^"]+)"|([\w.]+=[\w.]*\w))')


def asked_by(name: str) -> tuple[str, list[str]]:
    """Return the rig's name and the keys with their values; ``sim`` and none where the file names no rig."""
    text = Path(recipes.find(name)).read_text(encoding="utf-8")
    rig = RIG.search(text)
    return rig[1] if rig else "sim", [quoted or bare for quoted, bare in SET.findall(text)]
