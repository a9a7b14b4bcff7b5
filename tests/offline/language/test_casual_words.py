"""What people type in passing is read as plain words for the same are; what may mean two things is refused."""

from __future__ import annotations

import pytest

from tests.offline.language.wordings import gist
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.language import understand

SAME = [
    ("I think the star should be in the box.", "put the star into the box"),
    ("I wouldn't mind having the star in the box.", "put the star into the box"),
    ("Why isn't the star in the box?", "put the star into the box"),
    ("Would you mind putting the star in the box?", "put the star into the box"),
    ("The star is in the wrong place, put it in the box.", "put the star into the box"),
    ("Slip the star over so it's close by the box.", "put the star next to the box"),
    ("The pear in the middle, between the red bowl and the lime.", "put the pear between the red bowl and the lime"),
    ("Spin the star by a bit, say 30 degrees.", "rotate the star by 30 degrees"),
    ("The star and the ring: put them in the box.", "put the star and the ring into the box"),
    ("The star and the ring are the wrong way round, swap 'em.", "swap the star and the ring"),
    ("Put the star where the ring is and the ring where the star is.", "swap the star and the ring"),
    ("Fruit on the plate, but not the pear.", "put all fruits except the pear onto the plate"),
    ("Each block belongs in the box. Leave the red block out.", "put each block except the red block into the box"),
    ("If it's red, put it in the box.", "put everything that is red into the box"),
    ("Whichever star is leftmost, put it in the box.", "put the leftmost star into the box"),
    ("Put every last star in the box.", "put all stars into the box"),
    ("Put any star in the box.", "put one of the stars into the box"),
    ("Put a star in the box, any star.", "put one of the stars into the box"),
    ("Put any one of the stars in the box, I don't care which.", "put one of the stars into the box"),
    ("Sweep a single block into the frame.", "sweep one of the blocks into the frame"),
    ("Put any stars in the box.", "put all stars into the box"),
    ("Any star that is red goes into the box.", "put all red stars into the box"),
    ("Put any two stars in the box.", "put two stars into the box"),
]


@pytest.mark.parametrize(("text", "plain"), SAME)
def test_casual_words_are_read_as_plain_ones(text: str, plain: str) -> None:
    assert gist(understand(text)) == gist(understand(plain))


@pytest.mark.parametrize(
    "text",
    [
        "Any star goes into the box.",
        "Put any star that is red into the box.",
        "Put the star in the box except the ring.",
        "The bowl needs the block on its right.",
        "I don't think the star should be in the box.",
        "Don't put the star in the box.",
    ],
)
def test_words_that_may_mean_two_things_or_the_opposite_are_refused(text: str) -> None:
    with pytest.raises(NotUnderstoodError):
        understand(text)


def test_any_moves_one_thing() -> None:
    (command,) = understand("Put any block next to the bowl.").commands
    assert (command.thing.quantity, command.thing.number) == ("number", 1)
