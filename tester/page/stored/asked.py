"""The questions about stored runs, by name: each reads its own keys strictly, and answers with plain data."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError

from tester.page.front import in_one_line
from tester.page.stored.moments import moment_page
from tester.page.stored.overlays import MOST as MOST_LAID_OVER
from tester.page.stored.overlays import overlay_page
from tester.page.stored.run_cache import QuestionError, RunCache
from tester.page.stored.run_pages import condition_page, run_page
from tester.results.catalogue import open_catalogue
from tester.results.catalogue.entries import RunEntry, WantedRuns, entry_json, refresh
from tester.results.exclude import Word, record_note, record_word
from tester.service.commands import Name, Note, StrictMessage
from tester.store.run_folders import under_way
from tester.store.run_reader import RunReader

if TYPE_CHECKING:
    from numpy.typing import NDArray

RunName = Annotated[str, Field(max_length=255)]
Points = Annotated[int, Field(ge=1, le=8192)]
Seconds = Annotated[float, Field(allow_inf_nan=False)]
MOST_COLUMNS = 64


@dataclass(frozen=True, slots=True)
class AskRuns(StrictMessage):
    """List the stored runs; every field that is not empty narrows the list. ``text``: anywhere in a run's words."""

    text: Name = ""
    recipe: Name = ""
    compound: Name = ""
    person: Name = ""
    tag: Name = ""
    status: Name = ""
    since: Annotated[Name, Field(alias="from")] = ""
    until: Annotated[Name, Field(alias="to")] = ""


@dataclass(frozen=True, slots=True)
class AskRun(StrictMessage):
    """Everything about a run but its samples."""

    run: RunName


@dataclass(frozen=True, slots=True)
class AskCondition(StrictMessage):
    """A condition and its repeats."""

    run: RunName
    n: int


@dataclass(frozen=True, slots=True)
class AskSamples(StrictMessage):
    """Columns over a window of rig time, as at most 2 x ``points`` pairs of least and greatest value."""

    run: RunName
    columns: Annotated[tuple[Name, ...], Field(min_length=1, max_length=MOST_COLUMNS)]
    from_s: Seconds
    to_s: Seconds
    points: Points = 1200


@dataclass(frozen=True, slots=True)
class AskMoment(StrictMessage):
    """What the screen showed at a moment."""

    run: RunName
    t_s: Seconds


@dataclass(frozen=True, slots=True)
class AskOverlay(StrictMessage):
    """Runs laid over each other."""

    runs: Annotated[tuple[RunName, ...], Field(min_length=1, max_length=MOST_LAID_OVER)]
    against: Name


@dataclass(frozen=True, slots=True)
class AskExclude(StrictMessage):
    """Leave a repeat out of the mean (``repeat`` 0: every repeat of the condition), or include it again."""

    run: RunName
    n: int
    reason: Note
    repeat: Annotated[int, Field(ge=0)] = 0
    include: bool = False


@dataclass(frozen=True, slots=True)
class AskNote(StrictMessage):
    """Write a note, or tags."""

    run: RunName
    text: Note = ""
    tags: Annotated[tuple[Name, ...], Field(max_length=20)] = ()


def _runs(cache: RunCache, asked: AskRuns, _by: str) -> dict[str, Any]:
    until = f"{asked.until}\uffff" if asked.until else ""  # the whole of that day
    with closing(open_catalogue(cache.under)) as catalogue:
        refresh(catalogue, cache.under)
        found = catalogue.runs(WantedRuns(asked.compound, asked.since, until, asked.recipe))
    listed: list[Any] = []
    for run in found:
        tags = cache.tags(run.name)
        if _wanted(run, tags, asked):
            listed.append({**entry_json(run), "tags": list[Any](tags)})
    return {"runs": listed}


def _wanted(run: RunEntry, tags: Sequence[str], asked: AskRuns) -> bool:
    words = " ".join((run.name, run.recipe, run.operator, run.compounds, run.status, *tags)).casefold()
    return (
        asked.text.casefold() in words
        and asked.person.casefold() in run.operator.casefold()
        and (not asked.tag or asked.tag in tags)
        and (not asked.status or asked.status == run.status)
    )


def _run(cache: RunCache, asked: AskRun, _by: str) -> dict[str, Any]:
    folder = cache.folder(asked.run)
    with RunReader(folder) as reader:
        return run_page(reader, cache.results(folder))


def _condition(cache: RunCache, asked: AskCondition, _by: str) -> dict[str, Any]:
    return condition_page(cache.results(cache.folder(asked.run)), asked.n)


def _samples(cache: RunCache, asked: AskSamples, _by: str) -> dict[str, Any]:
    with RunReader(cache.folder(asked.run)) as reader:
        pyramid = cache.pyramid(reader)
        places = {column.key: place for place, column in enumerate(pyramid.columns)}
        if unknown := [key for key in asked.columns if key not in places]:
            raise QuestionError(f"columns: no {', '.join(unknown)} (expected of {', '.join(places)})")
        found = pyramid.window(reader, asked.from_s, asked.to_s, asked.points)
    return {
        "t": _packed(found.t_s - asked.from_s, "<f8"),
        "columns": {
            key: {"min": _packed(found.low[places[key]], "<f4"), "max": _packed(found.high[places[key]], "<f4")}
            for key in asked.columns
        },
    }


def _packed(values: NDArray[Any], form: str) -> str:
    return b64encode(np.ascontiguousarray(values, dtype=form).tobytes()).decode()


def _prepare(cache: RunCache, asked: AskRun, _by: str) -> dict[str, Any]:
    folder = cache.folder(asked.run)
    if under_way(folder) is None:
        with RunReader(folder) as reader:
            cache.pyramid(reader)
    return {}


def _moment(cache: RunCache, asked: AskMoment, _by: str) -> dict[str, Any]:
    folder = cache.folder(asked.run)
    with RunReader(folder) as reader:
        return moment_page(reader, cache.results(folder), asked.t_s)


def _overlay(cache: RunCache, asked: AskOverlay, _by: str) -> dict[str, Any]:
    folders = [cache.folder(run) for run in dict.fromkeys(asked.runs)]
    with ExitStack() as stack:
        runs = [(stack.enter_context(RunReader(folder)), cache.results(folder)) for folder in folders]
        return overlay_page(runs, asked.against)


def _exclude(cache: RunCache, asked: AskExclude, by: str) -> dict[str, Any]:
    folder = cache.folder(asked.run)
    repeats = [asked.repeat]
    if not asked.repeat:
        results = cache.results(folder)
        measured = next((m for m in results.conditions() if m.info.condition == asked.n), None)
        if measured is None or not measured.repeats:
            raise QuestionError(f"n: condition {asked.n} has no committed repeat")
        repeats = [r.repeat for r in measured.repeats if (measured.left_out_by(r) is not None) is asked.include]
    for repeat in repeats:
        record_word(folder, Word(asked.n, repeat, not asked.include, asked.reason, by))
    return {"repeats": len(repeats)}


def _note(cache: RunCache, asked: AskNote, by: str) -> dict[str, Any]:
    record_note(cache.folder(asked.run), asked.text, asked.tags, by)
    return {}


Asked = tuple[TypeAdapter[Any], Callable[[RunCache, Any, str], dict[str, Any]]]
ASKED: Final[Mapping[str, Asked]] = {
    "runs": (TypeAdapter(AskRuns), _runs),
    "run": (TypeAdapter(AskRun), _run),
    "condition": (TypeAdapter(AskCondition), _condition),
    "samples": (TypeAdapter(AskSamples), _samples),
    "moment": (TypeAdapter(AskMoment), _moment),
    "overlay": (TypeAdapter(AskOverlay), _overlay),
    "exclude": (TypeAdapter(AskExclude), _exclude),
    "note": (TypeAdapter(AskNote), _note),
    "prepare": (TypeAdapter(AskRun), _prepare),
}
"""The questions, each with its keys and the function that  answers it."""
PREPARE: Final = "prepare"
"""Asked by the page process itself, so that the first picture of a run need not wait for its pyramid."""
WRITING: Final = ("exclude", "note")
"""Those that write on record: they need the role control."""


def answer(cache: RunCache, query: str, keys: Mapping[str, Any], by: str) -> dict[str, Any]:
    """Answer a question; ``by``: the page that asks, for the record. Raises QuestionError, TroubleError, OSError."""
    adapter, work = ASKED[query]
    try:
        asked = adapter.validate_python(dict(keys))
    except ValidationError as error:
        raise QuestionError(in_one_line(error)) from None
    return work(cache, asked, by)
