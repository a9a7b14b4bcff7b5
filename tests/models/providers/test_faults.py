"""Every fault in every wire format: the right answer, or a typed error with the right exit code; counted; no key told."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.models.providers.asking import Asking, known_brain, largest_gap_px, question
from tests.servers.brains import AgentSession
from tests.servers.faults import ALL, Fault
from tests.servers.server import KEY, Rules, WireServer
from tests.servers.wiring import WIRES
from wonderful_team import errors

MENDED = ("fenced", "thinking_before", "double_encoded", "quoted_number", "parroted", "no_usage", "thinking_field")
"""Put right where it arrives: one request is enough."""
ASKED_AGAIN = (
    "malformed", "prose", "empty_text", "wrong_schema", "json_list", "json_null", "deep_json", "huge_number", "outside",
    "nan",
)  # fmt: skip
"""Sent back to the model with what is wrong."""
TRIED_AGAIN = (
    "rate_limit", "error_500", "error_502", "error_503", "error_529", "html_200", "html_502", "error_200", "empty_200",
    "garbage_200", "empty_choices", "other_shape", "drop", "drop_mid", "drop_headers",
)  # fmt: skip
"""Tried again with a pause."""
STALLS = ("hang", "drip")
LASTING = ("malformed", "nan", "rate_limit", "error_500", "html_200", "error_200", "empty_choices", "drop_mid", *STALLS)
"""One of each kind, on every request."""
SHORT_DEADLINE_S = 4.0
"""Half of it is left for the second try, which has to end on a machine that is busy with other things."""
FINAL: dict[str, type[errors.WonderfulTeamError]] = {
    "refusal": errors.ModelOutputError,
    "cut_off": errors.ModelCutOffError,
    "cut_empty": errors.ModelCutOffError,
    "unauthorized": errors.ModelAuthError,
    "forbidden": errors.ModelAuthError,
    "not_found": errors.UnknownModelError,
    "context_too_long": errors.ContextTooLongError,
    "bad_request": errors.RequestRejectedError,
}
"""No second try can help."""
EMPTY_IS_AN_ANSWER = {
    "openai-responses": ("empty_choices",),
    "anthropic": ("empty_choices",),
    "google": ("empty_choices", "empty_200", "error_200", "other_shape"),
}
"""Where a reply without any content is well-formed: the model may then be told that it said nothing."""
SPECIAL = ("filtered", "quota", "too_many_pictures", "too_heavy", "picture_too_heavy", "absent")


@pytest.fixture(scope="module", params=WIRES)
def asking(request: pytest.FixtureRequest) -> Iterator[Asking]:
    desk = AgentSession()
    wire = WIRES[request.param]
    server = WireServer(known_brain(desk, wire.speech), Rules(local=not wire.vendor))
    with server, Asking(server, desk, wire) as asking:
        yield asking


def test_every_fault_is_tested_here() -> None:
    named = (*MENDED, *ASKED_AGAIN, *TRIED_AGAIN, *STALLS, *FINAL, *SPECIAL)
    assert sorted(named) == sorted(ALL)


def test_without_faults_the_answer_is_right_in_one_request(asking: Asking) -> None:
    asking.server.strike()
    asked = asking.ask()
    assert asked.answer is not None
    assert largest_gap_px(asked.answer, question()) < 1.0
    assert (asked.requests, asked.calls) == (1, 1)
    assert asking.server.heard[-1].secret == KEY
    assert asked.answer.usage.tokens_in > 0


@pytest.mark.parametrize("fault", MENDED)
def test_mended_at_the_edge(fault: str, asking: Asking) -> None:
    asking.server.strike(fault)
    asked = asking.ask()
    assert asked.answer is not None, asked.error
    assert largest_gap_px(asked.answer, question()) < 1.0
    assert asked.requests == asked.calls == 1


@pytest.mark.parametrize("fault", ASKED_AGAIN)
def test_the_model_is_told_and_answers_again(fault: str, asking: Asking) -> None:
    asking.server.strike(fault)
    asked = asking.ask()
    assert asked.answer is not None, asked.error
    assert largest_gap_px(asked.answer, question()) < 1.0
    # An answer that breaks the vendor's own format is tried again, not sent back.
    assert asked.requests == asked.calls == 2
    assert asked.answer.usage.calls == 2


@pytest.mark.parametrize("fault", TRIED_AGAIN)
def test_a_passing_failure_of_the_provider_is_tried_again(fault: str, asking: Asking) -> None:
    asking.server.strike(Fault(fault, 0.05))
    asked = asking.ask()
    assert asked.answer is not None, asked.error
    assert largest_gap_px(asked.answer, question()) < 1.0
    assert asked.requests == asked.calls == 2


@pytest.mark.parametrize("fault", STALLS)
def test_a_stalled_reply_is_given_up_and_tried_again(fault: str, asking: Asking) -> None:
    asking.server.strike(fault)
    asked = asking.ask(deadline_s=SHORT_DEADLINE_S)
    assert asked.answer is not None, asked.error
    assert asked.requests == asked.calls == 2


@pytest.mark.parametrize("fault", FINAL)
def test_final_faults_are_typed_and_not_tried_again(fault: str, asking: Asking) -> None:
    asking.server.always(fault)
    asked = asking.ask()
    assert isinstance(asked.error, FINAL[fault]), asked.error
    assert asked.requests == 1, asked.error
    _tells_no_key(asked.error)


@pytest.mark.parametrize("fault", LASTING)
def test_a_lasting_fault_ends_in_a_typed_error(fault: str, asking: Asking) -> None:
    asking.server.always(Fault(fault, 0.01))
    deadline_s = 0.6 if fault in STALLS else 4.0
    asked = asking.ask(deadline_s=deadline_s, tries=2)
    assert asked.error is not None
    output = asked.error.exit_code == 1
    assert output == (fault in ASKED_AGAIN) or fault in EMPTY_IS_AN_ANSWER.get(asking.wire.vendor, ()), asked.error
    assert isinstance(asked.error, errors.ModelOutputError if output else errors.ModelUnavailableError)
    assert 1 <= asked.requests <= (3 if output else 2)
    # The last try of a stalled request may end before it arrives.
    assert asked.calls == asked.requests or fault in STALLS
    _tells_no_key(asked.error)


def test_a_content_filter_is_typed(asking: Asking) -> None:
    asking.server.always("filtered")
    asked = asking.ask()
    # Anthropic's format has one word for both.
    wanted = errors.ModelRefusalError if asking.wire.vendor == "anthropic" else errors.ContentFilterError
    assert isinstance(asked.error, wanted), asked.error
    assert (asked.exit_code, asked.requests) == (1, 1)


def test_a_spent_quota_is_the_providers_fault(asking: Asking) -> None:
    asking.server.always("quota")
    asked = asking.ask()
    assert isinstance(asked.error, errors.ModelUnavailableError), asked.error
    assert asked.exit_code == 3
    if asking.wire.vendor not in ("anthropic", "google"):
        # These two say it in the words of a rate limit, which passes.
        assert isinstance(asked.error, errors.ModelQuotaError)
        assert asked.requests == 1, asked.error


def test_one_picture_that_is_too_many_ends_it(asking: Asking) -> None:
    asking.server.always("too_many_pictures")
    asked = asking.ask()
    assert isinstance(asked.error, errors.TooManyPicturesError), asked.error
    assert asked.exit_code == 2


def test_an_absent_target_is_an_answer(asking: Asking) -> None:
    asking.server.strike("absent")
    asked = asking.ask()
    assert asked.answer is not None, asked.error
    assert [target.found for target in asked.answer.value.targets] == [False, True]
    assert asked.requests == 1, asked.error


def _tells_no_key(error: BaseException) -> None:
    """Not in the error, nor in any that stands behind it."""
    seen: BaseException | None = error
    while seen is not None:
        assert KEY not in str(seen)
        assert KEY not in repr(seen)
        seen = seen.__cause__
