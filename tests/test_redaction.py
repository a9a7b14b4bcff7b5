"""What looks like a key, and every key in use in every coding, is replaced; ordinary words are not."""

from __future__ import annotations

import random
import sys
import threading

import pytest

from tests.key_codings import AWKWARD, CODINGS
from wonderful_team import redaction
from wonderful_team.errors import MESSAGE_LIMIT, ActionRefusedError, MethodCodeError
from wonderful_team.redaction import HIDDEN, keep_secret, redact, redact_all, redact_known, redacted_streams


@pytest.mark.parametrize(
    "secret",
    [
        "sk-proj-abcDEF1234567890",
        "sk-ant-api03-abcdefgh_ijkl",
        "AIzaSyA1234567890abcdefghijklmnop",
        "hf_abcdefghijklmnop",
        "ghp_0123456789abcdefghij",
        "eyJhbGciOiJIUzI1NiJ9.eyJzdWIiOiIxMjM0In0.c2lnbmF0dXJl",
    ],
)
def test_keys_are_replaced_by_their_looks(secret):
    assert secret not in redact(f"the key is {secret}, he said")
    assert redact(f"the key is {secret}, he said").startswith("the key is [redacted]")


@pytest.mark.parametrize(
    "text",
    [
        "Authorization: Bearer abcdef123456",
        '{"api_key": "abcdef123456"}',
        "OPENAI_API_KEY=abcdef123456",
        "http://host:8000/v1?key=abcdef123456",
        "http://user:abcdef123456@host/v1",
    ],
)
def test_keys_are_replaced_by_their_place(text):
    assert "abcdef123456" not in redact(text)


def test_ordinary_words_stay():
    text = "put the red mug on the desk-top; task T1, 18,412 tokens; the key point lies at (412, 233); ask-anything"
    assert redact(text) == text


def test_values_are_searched_deeply_and_pictures_left_alone():
    value = {"a": [{"b": "sk-abcdefgh1234"}], "png": "AIzaAAAAAAAAAAAAAAAA", "n": 3}
    assert redact_all(value) == {"a": [{"b": "[redacted]"}], "png": "AIzaAAAAAAAAAAAAAAAA", "n": 3}


KEY = AWKWARD + " é"


@pytest.mark.parametrize("coding", CODINGS)
def test_a_key_that_was_used_is_found_in_every_coding(coding, monkeypatch):
    monkeypatch.setattr(redaction, "_used", set())
    written = f"before {CODINGS[coding](KEY)} after"
    assert redact(written) == written
    keep_secret(KEY)
    hidden = redact(written)
    assert HIDDEN in hidden
    # Not even half of it is left: what stands round it is the coding's own.
    assert len(hidden.replace(HIDDEN, "")) < len("before  after") + 14
    assert redact_all({"deep": [written]}) == {"deep": [hidden]}


def test_a_variable_that_is_named_like_a_secret_is_known_without_being_used(monkeypatch, tmp_path):
    for name in ("WONDERFUL_TEAM_SERVER_KEY", "MY_TOKEN", "DB_PASSWORD", "SERVICE_KEY_2"):
        monkeypatch.setenv(name, f"quite-ordinary-{name.lower()}")
        assert redact(f"it is quite-ordinary-{name.lower()}.") == "it is [redacted]."
        # A key that was read stays known when its variable is gone; one that nobody read is not remembered.
        monkeypatch.delenv(name)
    monkeypatch.setenv("SSH_KEY", str(tmp_path))
    assert redact(f"in {tmp_path}") == f"in {tmp_path}"


def test_words_that_servers_without_keys_are_given_are_no_secrets(monkeypatch):
    monkeypatch.setattr(redaction, "_used", set())
    for word in ("none", "EMPTY", "x", ""):
        keep_secret(word)
    assert redact("none of them is EMPTY, x") == "none of them is EMPTY, x"


def test_errors_hold_no_key_however_long_their_cause_is(monkeypatch):
    monkeypatch.setattr(redaction, "_used", {KEY})
    told = "x" * (MESSAGE_LIMIT - len(KEY) // 2) + KEY
    try:
        raise ValueError(told)
    except ValueError as error:
        ours = MethodCodeError("the method", cause=error)
    # Cut in the middle of the key, its first half would be left.
    assert KEY[:8] not in str(ours)
    assert KEY[:8] not in ours.trace
    assert KEY not in str(ActionRefusedError([f"no way to {KEY}"]))


def test_what_anybody_prints_is_redacted(monkeypatch, capsys):
    monkeypatch.setattr(redaction, "_used", {KEY})
    before = sys.stdout
    with redacted_streams():
        sys.stdout.write(f"out {KEY}\n")
        sys.stderr.writelines([f"err {KEY}\n"])
        thread = threading.Thread(target=lambda: sys.stderr.write(KEY))
        thread.start()
        thread.join()
        assert not sys.stdout.isatty()
    assert sys.stdout is before
    assert capsys.readouterr() == ("out [redacted]\n", "err [redacted]\n[redacted]")


def test_pictures_inside_of_a_page_are_left_alone():
    page = f'<img src="data:image/png;base64,AAAA+AIza{"B" * 40}"> AIza{"B" * 40}'
    assert redact(page) == f'<img src="data:image/png;base64,AAAA+AIza{"B" * 40}"> [redacted]'


def test_of_two_keys_that_overlap_no_half_is_left(monkeypatch):
    monkeypatch.setattr(redaction, "_used", {"abcdef-ghi", "ghi-jklmnopqrst"})
    # The longer one goes first; what is left is no key's half that ends with one.
    assert redact("x abcdef-ghi-jklmnopqrst y") == f"x abcdef-{HIDDEN} y"


def test_another_key_does_not_compile_those_before_it_anew(monkeypatch):
    """A process that serves many users has a key for each."""
    monkeypatch.setattr(redaction, "_used", set())
    for number in range(20):
        keep_secret(f"a-key-of-user-{number:04d}")
    redact("some words that are long enough")
    before = redaction._finder.cache_info().misses
    keep_secret("a-key-of-another-user")
    assert redact("it is a-key-of-another-user, not a-key-of-user-0007") == f"it is {HIDDEN}, not {HIDDEN}"
    assert redaction._finder.cache_info().misses == before + 1


def test_a_secret_is_known_as_soon_as_the_environment_or_a_user_names_it_and_forgotten_with_it(monkeypatch):
    """What was looked up is kept only for as long as nothing changed."""
    monkeypatch.setattr(redaction, "_used", set())
    told = "words of-the-environment and of-a-user"
    before = redaction.known_secrets()
    assert redact_known(told) == told
    monkeypatch.setenv("SOME_TEST_API_KEY", "of-the-environment")
    redaction.keep_secret("of-a-user")
    assert redact_known(told) == "words [redacted] and [redacted]"
    assert redaction.known_secrets() is not before
    monkeypatch.delenv("SOME_TEST_API_KEY")
    assert redact_known(told) == "words of-the-environment and [redacted]"


def test_what_is_looked_for_first_misses_nothing_that_the_patterns_find():
    rng = random.Random(7)
    parts = (
        *("sk-", "pk-", "AIza", "ghp_", "github_pat_", "hf_", "xoxb-", "gsk_", "xai-", "AKIA", "eyJ", ".", "Bearer ", "BASIC "),
        *("api_key", "API-KEY", "=", ": ", '"', "access-token", "clientsecret", "PassWord", "?key=", "&token=", "://", "@host"),
        *("user:", " ", "\n", "\\", "ſ", "\u212a", "paſſword=", "x-api-key", "abcdefghij", "0123456789"),
    )  # fmt: skip
    changed = 0
    for _ in range(20_000):
        text = "".join(rng.choice(parts) for _ in range(rng.randint(2, 8)))
        whole = text
        if len(text) >= redaction._SHORTEST_LOOK:
            for pattern, _ in redaction._LOOKS:
                whole = pattern.sub(HIDDEN, whole)
            whole = redaction._AFTER_NAME.sub(lambda match: match.group(1) + HIDDEN, whole)
        assert redaction._redact_looks(text) == whole
        changed += whole != text
    assert changed > 1000


_PIECES = (
    *(
        "sk-",
        "AIza",
        "ghp_",
        "hf_",
        "eyJ",
        ".",
        "abcdefghijk",
        "0123456789",
        "bearer ",
        "Basic ",
        "x-api-key",
        "_api_key",
    ),
    *("access_token", "AUTH-TOKEN", "_x-client_secret", "password", ": ", "=", '\\"', "'", "?key=", "&token=", "://"),
    *(
        "user:",
        "@host",
        "/",
        " ",
        "\n",
        "é",
        "ſ",
        "\u212a",
        "ı",
        "İ",
        "secret",
        "token",
        "key",
        "_",
        "keykey",
        "right ",
    ),
)


def test_looking_only_where_a_word_stands_misses_nothing():
    rng = random.Random(1)
    for _ in range(4000):
        text = whole = "".join(rng.choice(_PIECES) for _ in range(rng.randint(1, 12)))
        if len(text) < redaction._SHORTEST_LOOK:
            continue
        for pattern, _words in redaction._LOOKS:
            whole = pattern.sub(HIDDEN, whole)
        whole = redaction._AFTER_NAME.sub(lambda match: match.group(1) + HIDDEN, whole)
        assert redaction._redact_looks(text) == whole, text
