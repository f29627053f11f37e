"""A support bundle: what somebody elsewhere needs to understand what happened here."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

from pydantic_core import to_json

from tester import __version__
from tester.base.trouble import in_words
from tester.service.address import AddressError, folder
from tester.tui.scene import ScreenScene
from tester.tui.starting import LOG

LOG_BYTES = 1_000_000
"""Of the service's log, from its end."""


def write_bundle(scene: ScreenScene, stamp: str, where: Path = Path()) -> Path:
    """Write ``support-STAMP.zip`` and return its path; raises OSError."""
    path = where / f"support-{stamp}.zip"
    with ZipFile(path, "x", ZIP_DEFLATED) as bundle:
        bundle.writestr("version.txt", f"{__version__}\n")
        bundle.writestr("state.json", to_json(scene.state, indent=1, inf_nan_mode="null"))
        bundle.writestr("plan.json", to_json(scene.plan, indent=1, inf_nan_mode="null"))
        bundle.writestr("events.jsonl", _lines(scene.events))
        bundle.writestr("frames.jsonl", _lines(scene.frames))
        bundle.writestr("trend.jsonl", _lines([scene.machine.trend, *scene.trend]))
        bundle.writestr("serve.log", _log())
    return path


def _lines(things: Iterable[object]) -> bytes:
    return b"\n".join(to_json(one, inf_nan_mode="null") for one in things)


def _log() -> bytes:
    try:
        return (folder() / LOG).read_bytes()[-LOG_BYTES:]
    except (OSError, AddressError) as error:
        return f"no log of a service started by this screen: {in_words(error)}".encode()
