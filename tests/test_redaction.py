"""What looks like a key is replaced; ordinary words are not."""

from __future__ import annotations

import pytest

from wonderful_team.redaction import redact, redact_all


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
