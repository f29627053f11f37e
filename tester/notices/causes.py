"""The words of each cause: what happened, what the machine does by itself, what a person should do, by when.

The owner of the rig calls these; ``item_ended`` is for the queue. Nothing here reads a clock or a result.
"""

from __future__ import annotations

from tester.notices.notice import Notice, NoticeCause

NO_HURRY = "no deadline; nothing begins before that"
END = "end of "
"""Key of a run's end, before the run's name: the end of a run and of its item in the queue are one cause."""
TRIP = "trip"
PROMPT = "prompt"


def tripped(number: str, text: str, utc: str, *, rig: str, run: str, folder: str) -> Notice:
    """Return the notice of an interlock's trip. ``text``: the event's; ``utc``: when it tripped."""
    return Notice(
        number, NoticeCause.TRIP, f"{TRIP} {text.partition(':')[0]}", text, utc,
        "it has taken off the load, brings its drives to a standstill and stays so",
        "find the cause at the machine, then acknowledge (`tester ack`)", NO_HURRY, rig, run, folder,
    )  # fmt: skip


def asked(number: str, text: str, utc: str, *, rig: str, run: str, folder: str) -> Notice:
    """Return the notice of a question that waits."""
    return Notice(
        number, NoticeCause.PROMPT, PROMPT, text, utc, "it waits with its drives off, as long as it takes",
        "do what the question asks, then answer at the machine",
        "the run ends later by the time that the question waits", rig, run, folder,
    )  # fmt: skip


def held(number: str, text: str, utc: str, *, rig: str, run: str, folder: str) -> Notice:
    """Return the notice of a hold. ``text``: its reason."""
    return Notice(
        number, NoticeCause.HOLD, "hold", text, utc, "it is lifted, without slip, and keeps its temperature",
        "release it (`tester release`) or stop it", "the run ends later by the time of the hold", rig, run, folder,
    )  # fmt: skip


def run_ended(number: str, text: str, utc: str, outcome: str, *, rig: str, run: str, folder: str) -> Notice:
    """Return the notice of a run's end. ``outcome``: done, short, failed, tripped, stopped."""
    done = outcome == "done"
    return Notice(
        number, NoticeCause.FINISHED, END + run, text, utc, "it is at standstill; nothing begins by itself",
        f"look at the results (`tester show {run}`)" if done else f"see why, then decide: `tester show {run}`",
        NO_HURRY, rig, run, folder, again=False, outcome=outcome,
    )  # fmt: skip


def item_ended(
    number: str, text: str, utc: str, outcome: str, *, follows: str, todo: str, by: str, rig: str, run: str, folder: str
) -> Notice:
    """Return the notice of an item's end, which replaces that of its run.

    ``text``: the item with its end; ``outcome``: done, short, failed, tripped, stopped; ``follows``: what the queue
    does next by itself; ``todo`` and ``by``: what a person should do, by when.
    """
    return Notice(
        number, NoticeCause.ITEM, END + run, text, utc, follows, todo, by, rig, run, folder, again=False,
        outcome=outcome,
    )  # fmt: skip


def condition_lost(number: str, text: str, utc: str, *, rig: str, run: str, folder: str) -> Notice:
    """Return the notice of a condition without a value. ``text``: the condition and why."""
    return Notice(
        number, NoticeCause.CONDITION, "condition", text, utc, "it continues with the next condition",
        "see whether the next conditions fail alike", "the end of the run", rig, run, folder,
    )  # fmt: skip


def disk_low(number: str, text: str, utc: str, *, rig: str, run: str, folder: str) -> Notice:
    """Return the notice of a disk that is nearly full. ``text``: the free space."""
    return Notice(
        number, NoticeCause.DISK, "disk", text, utc, "it stops a run that it can no longer record",
        "make room on the disk of the runs", "as soon as possible", rig, run, folder,
    )  # fmt: skip


def died(number: str, utc: str, rig: str) -> Notice:
    """Return the notice of a service that has died."""
    return Notice(
        number, NoticeCause.SERVICE, "service", "the service that owns the rig has died", utc,
        "the drives stop by their own watchdogs; nothing begins by itself",
        "look at the machine, then start the service; `tester resume` resumes an interrupted run", "soon", rig,
    )  # fmt: skip


def trial(number: str, utc: str, rig: str) -> Notice:
    """Return the notice of ``tester notices test``."""
    return Notice(
        number, NoticeCause.TEST, "test", "a test: notices of this rig arrive here", utc, "nothing", "nothing", "", rig
    )
