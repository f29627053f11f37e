"""Commands that the screen has done in a process of their own: `tester export`, `tester results exclude`."""

from __future__ import annotations

import asyncio

from tester.base.children import tester_command


async def call(*arguments: str) -> tuple[bool, str]:
    """Carry out ``tester ARGUMENTS``; return whether it was done, and what it said."""
    process = await asyncio.create_subprocess_exec(
        *tester_command(*arguments),
        stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.PIPE,
    )  # fmt: skip
    _, told = await process.communicate()
    return process.returncode == 0, told.decode(errors="replace").strip()
