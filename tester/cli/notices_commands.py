"""`tester notices`: check the settings, send a test, list what waits."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base import clock
from tester.base.processes import EXIT_DONE, EXIT_FAILED, EXIT_INVALID
from tester.cli.options import ReportedGroup, json_option, print_json, runs_option
from tester.cli.text_table import shown

if TYPE_CHECKING:
    from tester.notices.mailing import Waiting
    from tester.notices.notice_settings import NoticeSettings
    from tester.notices.secrets_file import NoticeSecrets

SECRETS_OF = {"mail": "mail_password", "apprise": "apprise"}
"""The secret that a channel cannot do without."""


@click.group(cls=ReportedGroup)
def notices() -> None:
    """Notices to people elsewhere: check the settings, send a test, list what waits."""


@notices.command()
@json_option
def check(as_json: bool) -> int:
    """Validate the settings and the secrets, and print which cause goes where; nothing is sent."""
    from tester.notices.notice import MEANINGS, NoticeCause
    from tester.notices.notice_settings import settings_path
    from tester.notices.secrets_file import secrets_path

    read = _read()
    if read is None:
        return EXIT_INVALID
    settings, secrets = read
    missing = _missing(settings, secrets)
    goes = {cause: list(settings.lanes(cause).values()) for cause in MEANINGS}
    first = settings.lanes(NoticeCause.PROMPT)
    second = [place for lane, place in settings.lanes(NoticeCause.PROMPT, second=True).items() if lane not in first]
    if as_json:
        print_json({"file": str(settings_path()), "channels": list(settings.channels), "missing": missing,
                    "second": second, "causes": {cause.value: places for cause, places in goes.items()}})  # fmt: skip
    else:
        click.echo(f"settings  {settings_path()}" + ("" if settings_path().exists() else " (there is none)"))
        click.echo(f"secrets   {secrets_path()}" + ("" if secrets_path().exists() else " (there is none)"))
        for cause, places in goes.items():
            at = f" at {settings.morning}" if cause.value == "morning" else ""
            click.echo(f"{cause.value:<10}{MEANINGS[cause]}{at}: {', '.join(places) or 'nowhere'}")
        if second:
            click.echo(f"second    a question after 45 min: {', '.join(second)}")
        for problem in missing:
            click.echo(problem, err=True)
    return EXIT_FAILED if missing else EXIT_DONE


@notices.command("test")
def trial() -> int:
    """Send a test by every channel to every address; exit code 1 if one fails."""
    from tester.notices.causes import trial as trial_notice
    from tester.notices.channels.every_channel import channels_of
    from tester.notices.channels.letter import NotDeliveredError, letter_of
    from tester.notices.mailing import Waiting

    read = _read()
    if read is None:
        return EXIT_INVALID
    settings, secrets = read
    channels, failed = channels_of(settings, secrets), 0
    now = clock.utc_now()
    notice = trial_notice(f"test-{now}", now, "")
    for lane, place in settings.every_lane.items():
        name = lane.partition(":")[0]
        letter = letter_of(Waiting(f"{notice.number}.0", lane, notice, 0, 0, clock.wall_s()))
        try:
            channels[name].send(letter, place)
        except NotDeliveredError as error:
            failed += 1
            click.echo(shown(f"FAILED  {name}  {place}: {secrets.hidden(str(error))}"))
        else:
            click.echo(f"sent    {name}  {place}")
    if not settings.channels:
        click.echo("there is no channel to test: docs/how-to/notices.md", err=True)
        return EXIT_FAILED
    return EXIT_FAILED if failed else EXIT_DONE


@notices.command("list")
@runs_option("Folder of the runs, which holds the outbox.")
@json_option
def list_(out: Path, as_json: bool) -> None:
    """List the notices that wait and those that were given up: age, address, attempts, the newest reason."""
    from tester.notices.mailing import Mailing
    from tester.notices.outbox_file import outbox_path, read_entries

    mailing = Mailing.of(read_entries(outbox_path(out)))
    rows = [("waits", one) for one in mailing.waiting()] + [("given up", one) for one in mailing.failed]
    if as_json:
        print_json([_as_json(state, one) for state, one in rows])
        return
    for state, one in rows:
        click.echo(shown(_line(state, one)))
    if not rows:
        click.echo("no notice waits", err=True)


def _as_json(state: str, one: Waiting) -> dict[str, object]:
    return {
        "state": state, "age_s": round(clock.wall_s() - one.at_s, 1), "channel": _channel(one), "to": _place(one),
        "cause": one.notice.cause.value, "what": one.notice.what, "tries": one.tries, "why": one.why,
    }  # fmt: skip


def _line(state: str, one: Waiting) -> str:
    from tester.base.words import counted, rough_duration
    from tester.notices.notice import one_line, subject_of

    age = rough_duration(max(clock.wall_s() - one.at_s, 0.0))
    tries = f"  {counted(one.tries, 'attempt')}: {one_line(one.why)}" if one.tries else ""
    return f"{state}  {age}  {_channel(one)} {_place(one)}  {subject_of(one.notice)}{tries}"


def _channel(one: Waiting) -> str:
    return one.lane.partition(":")[0]


def _place(one: Waiting) -> str:
    """Return a notice's address; the outbox does not hold it, so an address that has left the settings is unknown."""
    from tester.base.source import InvalidSource
    from tester.notices.notice_settings import read_settings, settings_path

    try:
        return read_settings(settings_path()).every_lane.get(one.lane, "an address that is no longer in the settings")
    except (InvalidSource, OSError):
        return "an address in settings that cannot be read"


def _read() -> tuple[NoticeSettings, NoticeSecrets] | None:
    """Return the settings and the secrets; print every problem and return None if there is one."""
    from tester.notices.notice_settings import read_settings, settings_path
    from tester.notices.secrets_file import read_secrets, secrets_path, settings_trouble

    if problems := settings_trouble():
        for problem in problems:
            click.echo(shown(problem), err=True)
        return None
    return read_settings(settings_path()), read_secrets(secrets_path(), os.environ)


def _missing(settings: NoticeSettings, secrets: NoticeSecrets) -> list[str]:
    """Return which secrets and which extra are missing, in words."""
    from importlib.util import find_spec

    from tester.base.plugins import needs
    from tester.notices.secrets_file import VARIABLES

    wanted = {
        "mail": settings.mail is not None and settings.mail.user is not None,
        "apprise": settings.apprise is not None,
    }
    extra = [needs("apprise", "Apprise", "notify")] if settings.apprise and find_spec("apprise") is None else []
    return extra + [
        f"{channel}: {SECRETS_OF[channel]} is missing (expected in the secrets' file or in "
        f"{VARIABLES[SECRETS_OF[channel]]})"
        for channel, needed in wanted.items()
        if needed and not getattr(secrets, SECRETS_OF[channel])
    ]
