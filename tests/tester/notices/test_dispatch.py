"""Times of notices: once per key in 10 minutes, in order, again while a question waits, and every morning."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone
from itertools import pairwise
from pathlib import Path

import pytest

from tester.notices.channels.letter import NotDeliveredError
from tester.notices.dispatch import DELAYS_S, OLD_S, REFUSALS
from tester.notices.mailing import Mailing
from tester.notices.notice import NextNeeded, NoticeCause, NoticeOver
from tester.notices.outbox_file import read_entries
from tester.notices.secrets_file import NoticeSecrets
from tests.tester.notices.relay import MailRelay
from tests.tester.notices.scene import ANNA, HEAD, NOON_S, OutboxScene, PlayedChannel, mail_settings, notice

HOUR_S = 3600.0


@pytest.fixture
def channel() -> PlayedChannel:
    return PlayedChannel()


@pytest.fixture
def scene(tmp_path: Path, channel: PlayedChannel) -> OutboxScene:
    return OutboxScene(tmp_path, mail_settings(1), channel=channel)


def whats(channel: PlayedChannel) -> list[str]:
    return [letter.notice.what for _, letter in channel.taken]


def test_a_notice_goes_at_once(scene: OutboxScene, channel: PlayedChannel) -> None:
    scene.take(notice(1))
    assert [(place, letter.notice.what) for place, letter in channel.taken] == [(ANNA, "text 1")]


def test_a_note_that_is_repeated_counts_once(scene: OutboxScene, channel: PlayedChannel) -> None:
    scene.take(notice(1))
    scene.pass_time(HOUR_S)
    scene.take(notice(1))
    assert len(channel.taken) == 1


def test_of_one_key_there_is_one_notice_in_ten_minutes_and_then_the_newest_with_their_number(
    scene: OutboxScene, channel: PlayedChannel
) -> None:
    for number in range(1, 6):
        scene.take(notice(number, NoticeCause.CONDITION, "condition"))
        scene.pass_time(60.0)
    assert whats(channel) == ["text 1"]
    scene.pass_time(299.0)
    assert whats(channel) == ["text 1"]
    scene.pass_time(2.0)
    assert whats(channel) == ["text 1", "text 5"]
    assert "3 more" in channel.taken[1][1].text


def test_causes_of_other_keys_do_not_wait(scene: OutboxScene, channel: PlayedChannel) -> None:
    scene.take(notice(1, key="trip overload"))
    scene.take(notice(2, key="trip guard open"))
    assert whats(channel) == ["text 1", "text 2"]


def test_the_end_of_a_run_and_of_its_item_are_one_notice(scene: OutboxScene, channel: PlayedChannel) -> None:
    scene.take(notice(1, NoticeCause.FINISHED, "end of run-1", again=False, outcome="done"))
    scene.take(notice(2, NoticeCause.ITEM, "end of run-1", again=False, outcome="done"))
    scene.pass_time(HOUR_S)
    assert whats(channel) == ["text 1"]


def test_a_question_is_asked_again_after_15_and_45_minutes_the_last_time_at_the_second_address(
    scene: OutboxScene, channel: PlayedChannel
) -> None:
    scene.take(notice(1, NoticeCause.PROMPT, "prompt"))
    seen: list[tuple[float, str]] = []
    for minute in range(181):
        seen += [(float(minute), place) for place, _ in channel.taken[len(seen) :]]
        scene.pass_time(60.0)
    assert seen == [(0.0, ANNA), (15.0, ANNA), (45.0, ANNA), (45.0, HEAD)]
    assert "(waits for 15 min)" in channel.subjects[1] and "(waits for 45 min)" in channel.subjects[2]


def test_a_question_that_is_answered_is_not_asked_again(scene: OutboxScene, channel: PlayedChannel) -> None:
    scene.take(notice(1, NoticeCause.PROMPT, "prompt"))
    scene.pass_time(16.0 * 60.0)
    scene.take(NoticeOver("s1-2", "prompt"))
    scene.pass_time(3.0 * HOUR_S)
    assert len(channel.taken) == 2


def test_a_second_question_within_ten_minutes_waits_and_goes_only_if_it_is_still_open(
    scene: OutboxScene, channel: PlayedChannel
) -> None:
    scene.take(notice(1, NoticeCause.PROMPT, "prompt"))
    scene.pass_time(60.0)
    scene.take(NoticeOver("s1-2", "prompt"))
    scene.take(notice(3, NoticeCause.PROMPT, "prompt"))
    scene.pass_time(60.0)
    scene.take(NoticeOver("s1-4", "prompt"))
    scene.take(notice(5, NoticeCause.PROMPT, "prompt"))
    scene.pass_time(600.0)
    assert whats(channel) == ["text 1", "text 5"]


def test_after_a_restart_of_the_sender_a_question_is_still_asked_again(
    tmp_path: Path, scene: OutboxScene, channel: PlayedChannel
) -> None:
    scene.take(notice(1, NoticeCause.PROMPT, "prompt"))
    scene.close()
    again = OutboxScene(tmp_path, mail_settings(1), channel=channel, now_s=NOON_S + 600.0)
    again.pass_time(HOUR_S)
    assert len(channel.taken) == 4


def test_a_question_of_a_service_that_has_ended_is_over(
    tmp_path: Path, scene: OutboxScene, channel: PlayedChannel
) -> None:
    scene.take(notice(1, NoticeCause.PROMPT, "prompt"))
    scene.close()
    later = OutboxScene(tmp_path, mail_settings(1), channel=channel, now_s=NOON_S + 600.0, service="s2")
    later.pass_time(3.0 * HOUR_S)
    assert len(channel.taken) == 1


# -- a relay that fails ---------------------------------------------------------------------------------------


def test_a_relay_that_is_down_for_three_hours_loses_none_doubles_none_and_keeps_the_order(tmp_path: Path) -> None:
    with MailRelay(down=True) as relay:
        scene = OutboxScene(tmp_path, mail_settings(relay.port))
        for number in range(1, 31):
            scene.take(notice(number))
            scene.pass_time(360.0)
        assert relay.taken == [] and relay.connections < 30
        relay.down = False
        scene.pass_time(DELAYS_S[-1])
        assert [mail.message["Subject"].split()[-1] for mail in relay.taken] == [str(n) for n in range(1, 31)]
        assert len({mail.ident for mail in relay.taken}) == 30


def test_attempts_come_at_growing_distances(scene: OutboxScene, channel: PlayedChannel) -> None:
    channel.fails = lambda: NotDeliveredError("no answer")
    times: list[float] = []
    scene.take(notice(1))
    for second in range(0, 3600, 10):
        if channel.attempts > len(times):
            times.append(float(second))
        scene.pass_time(10.0)
    assert [b - a for a, b in pairwise(times)] == [*DELAYS_S, DELAYS_S[-1]]


def test_a_mail_whose_answer_is_lost_comes_twice_under_one_message_id(tmp_path: Path) -> None:
    with MailRelay(loses=1) as relay:
        scene = OutboxScene(tmp_path, mail_settings(relay.port))
        scene.take(notice(1))
        scene.take(notice(2))
        scene.pass_time(HOUR_S)
        idents = [mail.ident for mail in relay.taken]
        assert len(idents) == 3 and idents[0] == idents[1] != idents[2]
        assert relay.taken[0].raw == relay.taken[1].raw


def test_a_mail_that_the_relay_did_not_take_comes_once(tmp_path: Path) -> None:
    with MailRelay(drops=3) as relay:
        scene = OutboxScene(tmp_path, mail_settings(relay.port))
        scene.take(notice(1))
        scene.pass_time(HOUR_S)
        assert len(relay.taken) == 1 and relay.connections == 4


def test_an_address_that_fails_holds_up_no_other(tmp_path: Path) -> None:
    with MailRelay(refuses={ANNA: 451}) as relay:
        scene = OutboxScene(tmp_path, mail_settings(relay.port, to=[ANNA, HEAD]))
        scene.take(notice(1))
        scene.take(notice(2))
        assert [mail.to for mail in relay.taken] == [[HEAD], [HEAD]]


def test_an_address_that_is_refused_for_good_is_given_up_on_record_and_holds_up_no_later_notice(tmp_path: Path) -> None:
    with MailRelay(refuses={ANNA: 550}) as relay:
        scene = OutboxScene(tmp_path, mail_settings(relay.port))
        scene.take(notice(1))
        scene.pass_time(sum(DELAYS_S[: REFUSALS - 1]) + 1.0)
        failed = Mailing.of(read_entries(tmp_path / "outbox")).failed
        assert [(one.notice.what, one.tries) for one in failed] == [("text 1", REFUSALS)]
        assert "550" in failed[0].why
        relay.refuses.clear()
        scene.take(notice(2))
        assert len(relay.taken) == 1


def test_a_notice_that_waits_for_three_days_is_abandoned_on_record(scene: OutboxScene, channel: PlayedChannel) -> None:
    channel.fails = lambda: NotDeliveredError("no answer")
    scene.take(notice(1))
    scene.pass_time(OLD_S + 120.0)
    assert [one.why for one in scene.dispatch.mailing.failed] == ["older than 3 days: no answer"]


def test_a_wall_clock_that_is_set_back_holds_up_nothing(scene: OutboxScene, channel: PlayedChannel) -> None:
    channel.fails = lambda: NotDeliveredError("no answer")
    scene.take(notice(1, key="disk"))
    channel.fails = lambda: None
    scene.now_s -= 24.0 * HOUR_S
    scene.take(notice(2, key="disk"))
    assert whats(channel) == ["text 1", "text 2"]


def test_a_disk_that_takes_no_record_delays_no_notice_and_gets_the_record_later(
    scene: OutboxScene, channel: PlayedChannel, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def full(_entry: object) -> None:
        raise OSError(28, "no space")

    with monkeypatch.context() as patch:
        patch.setattr(scene.file, "append", full)
        scene.take(notice(1))
        assert whats(channel) == ["text 1"] and read_entries(tmp_path / "outbox") == []
    scene.pass_time(1.0)
    assert [entry["k"] for entry in read_entries(tmp_path / "outbox")] == ["note", "sent"]


# -- the morning ----------------------------------------------------------------------------------------------


def test_every_morning_there_is_a_message_at_seven_local_time(tmp_path: Path, channel: PlayedChannel) -> None:
    zone = timezone(timedelta(hours=2))
    scene = OutboxScene(tmp_path, mail_settings(1), channel=channel, zone=zone)
    at: list[str] = []
    for _ in range(48):
        scene.pass_time(HOUR_S)
        at += [datetime.fromtimestamp(scene.now_s, UTC).astimezone(zone).strftime("%H:%M")
               for _ in channel.taken[len(at) :]]  # fmt: skip
    assert at == ["07:00", "07:00"]


def test_the_morning_counts_the_runs_since_the_last_one_and_names_the_next_question(
    scene: OutboxScene, channel: PlayedChannel
) -> None:
    scene.take(notice(1, NoticeCause.TRIP, "trip overload"))
    scene.take(notice(2, NoticeCause.FINISHED, "trip overload", again=False, outcome="tripped", run="night-3"))
    scene.take(notice(3, NoticeCause.FINISHED, "end of night-1", again=False, outcome="done", run="night-1"))
    scene.take(notice(4, NoticeCause.FINISHED, "end of night-2", again=False, outcome="short", run="night-2"))
    scene.take(NextNeeded("RUN: night-4", "2026-03-04T09:40:00Z", "install wheel 3"))
    scene.pass_time(19.0 * HOUR_S + 1.0)
    text = channel.taken[-1][1].text
    for part in ("done: 1 (night-1)", "short: 1 (night-2)", "tripped: 1 (night-3)", "wheel 3", "09:40", "night-4"):
        assert part in text
    scene.pass_time(24.0 * HOUR_S)
    assert "done: 0; short: 0" in channel.taken[-1][1].text


def test_a_sender_that_begins_in_the_afternoon_sends_no_morning_message(
    scene: OutboxScene, channel: PlayedChannel
) -> None:
    scene.pass_time(18.0 * HOUR_S)
    assert channel.taken == []


def test_a_sender_that_is_started_anew_at_seven_sends_the_mornings_message_once(
    tmp_path: Path, channel: PlayedChannel
) -> None:
    for late_s in (-30.0, 60.0, 120.0):
        scene = OutboxScene(tmp_path, mail_settings(1), channel=channel, now_s=NOON_S + 19.0 * HOUR_S + late_s)
        scene.pass_time(45.0)
        scene.close()
    assert len(channel.taken) == 1


def test_a_servers_answer_that_repeats_the_password_does_not_bring_it_into_the_outbox(tmp_path: Path) -> None:
    with MailRelay("rig", "another") as relay:
        scene = OutboxScene(tmp_path, mail_settings(relay.port, user="rig"), secrets=NoticeSecrets("pw-7f3c1e"))
        scene.take(notice(1))
    (entry,) = [entry for entry in read_entries(tmp_path / "outbox") if entry["k"] == "tried"]
    assert "535 not with the password (secret)" in str(entry["why"])
    assert b"pw-7f3c1e" not in (tmp_path / "outbox").read_bytes()


def test_the_outbox_holds_neither_addresses_nor_topics(scene: OutboxScene, tmp_path: Path) -> None:
    scene.take(notice(1))
    assert ANNA.encode() not in (tmp_path / "outbox").read_bytes()
