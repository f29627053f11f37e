"""Codes and secrets, on a clock of the test."""

from __future__ import annotations

import pytest

from tester.page.pairing import CODE_S, MOST_PAIRINGS, PAIRED_S, TRIES, WINDOW_S, PairingError, Pairings


class Clock:
    """Seconds that the test sets."""

    def __init__(self) -> None:
        self.s = 0.0

    def __call__(self) -> float:
        return self.s


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def pairings(clock: Clock) -> Pairings:
    return Pairings("control", clock)


def other(digits: str) -> str:
    return f"{(int(digits) + 1) % 1_000_000:06d}"


def test_a_code_pairs_one_page_for_its_role(pairings: Pairings) -> None:
    code = pairings.new_code("stop")
    pairing, secret = pairings.pair(code.digits, "Anna's phone")
    assert (pairing.role, pairing.recorded) == ("stop", "page 1: Anna's phone")
    assert pairings.of(secret) is pairing
    with pytest.raises(PairingError, match="no code"):
        pairings.pair(code.digits, "a second page")


def test_a_code_ends_after_its_time(pairings: Pairings, clock: Clock) -> None:
    code = pairings.new_code("look")
    clock.s = CODE_S
    with pytest.raises(PairingError, match="no code"):
        pairings.pair(code.digits, "late")


def test_a_code_is_void_after_five_wrong_ones(pairings: Pairings) -> None:
    code = pairings.new_code("look")
    for _ in range(TRIES):
        with pytest.raises(PairingError, match="not the code"):
            pairings.pair(other(code.digits), "guess")
    with pytest.raises(PairingError, match="no code"):
        pairings.pair(code.digits, "right, but too late")


def test_wrong_codes_end_no_pairing(pairings: Pairings) -> None:
    _, secret = pairings.pair(pairings.new_code("stop").digits, "in")
    pairings.new_code("look")
    for _ in range(1000):
        with pytest.raises(PairingError):
            pairings.pair("", "guess")
    assert pairings.of(secret).role == "stop"


def test_a_pairing_ends_after_twelve_hours(pairings: Pairings, clock: Clock) -> None:
    pairing, secret = pairings.pair(pairings.new_code("look").digits, "in")
    clock.s = PAIRED_S
    assert not pairings.good(pairing) and pairings.listed() == []
    with pytest.raises(PairingError, match="no longer"):
        pairings.of(secret)


def test_a_revoked_pairing_is_over(pairings: Pairings) -> None:
    pairing, secret = pairings.pair(pairings.new_code("control").digits, "in")
    assert pairings.revoke(pairing.number) and not pairings.revoke(pairing.number)
    with pytest.raises(PairingError):
        pairings.of(secret)


@pytest.mark.parametrize("secret", ["", "x", "ä" * 43])
def test_another_secret_is_none(secret: str, pairings: Pairings) -> None:
    pairings.pair(pairings.new_code("control").digits, "in")
    with pytest.raises(PairingError):
        pairings.of(secret)


def test_secrets_have_256_bits_and_are_not_kept(pairings: Pairings) -> None:
    pairing, secret = pairings.pair(pairings.new_code("look").digits, "in")
    assert len(secret) >= 43 and secret not in repr(pairing)


def test_a_name_with_a_control_character_is_refused(pairings: Pairings) -> None:
    with pytest.raises(PairingError, match="not accepted"):
        pairings.pair(pairings.new_code("look").digits, "Anna\x1b[2J")


def test_there_are_only_so_many_pairings(pairings: Pairings) -> None:
    for _ in range(MOST_PAIRINGS):
        pairings.pair(pairings.new_code("look").digits, "in")
    with pytest.raises(PairingError, match="paired already"):
        pairings.pair(pairings.new_code("look").digits, "one more")


def test_an_action_needs_a_code_that_is_good_once_and_for_it_alone(pairings: Pairings) -> None:
    pairing, _ = pairings.pair(pairings.new_code("control").digits, "in")
    with pytest.raises(PairingError, match=r"^code:"):
        pairings.confirm(pairing, "run a", "run a", "")
    ((_, code),) = pairings.asked()
    with pytest.raises(PairingError, match=r"^code:"):
        pairings.confirm(pairing, "run b", "run b", code.digits)
    ((_, code),) = pairings.asked()
    pairings.confirm(pairing, "run b", "run b", code.digits)
    with pytest.raises(PairingError, match=r"^code:"):
        pairings.confirm(pairing, "run b", "run b", code.digits)


def test_guessing_codes_for_actions_ends_after_five_of_all_pages(pairings: Pairings, clock: Clock) -> None:
    pages = [pairings.pair(pairings.new_code("control").digits, "in")[0] for _ in range(3)]
    for page in pages:
        with pytest.raises(PairingError):
            pairings.confirm(page, "run", "run", "")
    wrong = {page.number: other(code.digits) for page, code in pairings.asked()}
    for n in range(TRIES):
        page = pages[n % 3]
        with pytest.raises(PairingError, match="not the code"):
            pairings.confirm(page, "run", "run", wrong[page.number])
    right = {page.number: code.digits for page, code in pairings.asked()}
    with pytest.raises(PairingError, match="wait"):
        pairings.confirm(pages[0], "run", "run", right[pages[0].number])
    clock.s = WINDOW_S
    with pytest.raises(PairingError, match="shows now"):
        pairings.confirm(pages[0], "run", "run", "")
