"""What is said to the listener alone is no part of the instruction; what says when, or denies, always is."""

from __future__ import annotations

import pytest

from tests.offline.language.wordings import gist
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.language import understand

PLAIN = "put the red block into the bowl"


@pytest.mark.parametrize(
    "text",
    [
        "I'd be ever so grateful if you could put the red block into the bowl.",
        "Any chance you could pop the red block in the bowl for me?",
        "If it's not too much trouble, put the red block in the bowl.",
        "Put the red block in the bowl when you get a minute.",
        "What I need you to do is put the red block into the bowl.",
        "I was wondering whether you might move the red block into the bowl, thank you.",
        "Why don't you put the red block in the bowl?",
        "Hi there! The red block should be in the bowl by the time you're finished.",
        "Time for the red block to go into the bowl.",
    ],
)
def test_talk_changes_nothing(text: str) -> None:
    assert gist(understand(text)) == gist(understand(PLAIN))


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("Before you put the red block into the bowl, put the blue block into the box.", f"put the blue block into the box, then {PLAIN}"),
        ("Once you put the red block into the bowl, put the blue block into the box.", f"{PLAIN}, then put the blue block into the box"),
        ("The blue block goes in the box, but only after the red block is in the bowl.", f"{PLAIN}, then put the blue block into the box"),
        ("Put the lemon in the bowl and then the pear.", "put the lemon into the bowl, then put the pear into the bowl"),
        ("Set the apple down in between the red and blue bowls.", "put the apple between the red bowl and the blue bowl"),
        ("Everything that is a yellow block must be placed in the box.", "put all yellow blocks into the box"),
        ("Left of the blue bowl is where the yellow block should go.", "put the yellow block to the left of the blue bowl"),
        ("The box gets the largest block.", "put the largest block into the box"),
        ("There are two red blocks. Put the biggest one into the box.", "put the biggest of the red blocks into the box"),
    ],
)  # fmt: skip
def test_read_as_plain_words_are(text: str, plain: str) -> None:
    assert gist(understand(text)) == gist(understand(plain))


@pytest.mark.parametrize(
    "text",
    [
        "I do not want you to put the red block into the bowl.",
        "Never put the red block into the bowl.",
        "If you like red, put the red block into the bowl.",
        "Green block at the bottom, red block on top.",
        "I want you to juggle. Put the red block into the bowl.",
    ],
)
def test_what_is_no_talk_is_never_passed_over(text: str) -> None:
    with pytest.raises(NotUnderstoodError):
        understand(text)
