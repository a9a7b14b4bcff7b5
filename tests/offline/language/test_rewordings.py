"""Free re-wordings of the same instructions must come to the same commands."""

from __future__ import annotations

import pytest

from wonderful_team.offline.language import understand

PUT = """
Put the {dragged_obj_1} into the {base_obj}.
Please put the {dragged_obj_1} in the {base_obj}
Place the {dragged_obj_1} inside the {base_obj}.
Move {dragged_obj_1} into {base_obj}
Could you drop the {dragged_obj_1} into the {base_obj}?
Take the {dragged_obj_1} and put it into the {base_obj}.
Pick up the {dragged_obj_1} and place it in the {base_obj}.
Grab the {dragged_obj_1}, then drop it into the {base_obj}.
Get the {dragged_obj_1} into the {base_obj}.
I want the {dragged_obj_1} in the {base_obj}.
I would like the {dragged_obj_1} to be in the {base_obj}.
I'd like you to move the {dragged_obj_1} into the {base_obj}.
The {dragged_obj_1} should go into the {base_obj}.
The {dragged_obj_1} belongs in the {base_obj}.
The {dragged_obj_1} must be placed inside the {base_obj}.
The {dragged_obj_1} needs to be moved into the {base_obj}.
Into the {base_obj}, put the {dragged_obj_1}.
Put into the {base_obj} the {dragged_obj_1}.
Transfer the {dragged_obj_1} to the {base_obj}.
Relocate the {dragged_obj_1} to the inside of the {base_obj}.
Bring the {dragged_obj_1} over to the {base_obj}.
Set the {dragged_obj_1} down in the {base_obj}.
Lay the object {dragged_obj_1} into the object {base_obj}.
Find the {dragged_obj_1} and put it inside of the {base_obj}.
Robot, please carefully put the thing shown in {dragged_obj_1} into the thing shown in {base_obj}.
Put the object that looks like {dragged_obj_1} into the object that looks like {base_obj}.
Deposit the {dragged_obj_1} in the middle of the {base_obj}.
Make sure the {dragged_obj_1} ends up in the {base_obj}.
Your task is to put the {dragged_obj_1} into the {base_obj}.
PUT THE {dragged_obj_1} INTO THE {base_obj}!
Let the {dragged_obj_1} be in the {base_obj}.
Would you kindly insert the {dragged_obj_1} into the {base_obj}?
Shift the {dragged_obj_1} to the {base_obj}
Pick the {dragged_obj_1} and then place it into the {base_obj}.
Would you mind putting the {dragged_obj_1} into the {base_obj}?
The goal is to have the {dragged_obj_1} inside the {base_obj}.
{dragged_obj_1} into {base_obj}, please
Carry the {dragged_obj_1} to the {base_obj} and drop it in.
Carry the {dragged_obj_1} over and drop it into the {base_obj}.
Locate the {dragged_obj_1} and move it into the {base_obj}
The {base_obj} should contain the {dragged_obj_1}.
The {dragged_obj_1} has to end up inside the {base_obj}.
Fill the {base_obj} with the {dragged_obj_1}.
Stick the {dragged_obj_1} in the {base_obj}.
Store the {dragged_obj_1} in the {base_obj}.
Throw the {dragged_obj_1} into the {base_obj}.
Put this {dragged_obj_1} in that {base_obj}.
Slot the {dragged_obj_1} into the {base_obj}.
Position the {dragged_obj_1} so that it is inside the {base_obj}.
Make the {dragged_obj_1} be inside the {base_obj}
Have the {dragged_obj_1} placed in the {base_obj}.
"""

TEXTURE = """
Put the {texture1} object in {scene} into the {texture2} object.
Place the {texture1} object from {scene} into the {texture2} object.
Put the object with the texture of {texture1} in {scene} into the object with the texture of {texture2}.
Move the object with texture {texture1} into the object with texture {texture2}, as shown in {scene}.
Take the {texture1} thing in {scene} and drop it into the {texture2} thing.
The {texture1} object in {scene} goes into the {texture2} object.
Please put the {texture1} textured object shown in {scene} inside the {texture2} textured object.
In {scene}, put the {texture1} object into the {texture2} object.
Pick up the {texture1} item in {scene} and place it inside the {texture2} item.
Looking at {scene}, put the {texture1} object into the {texture2} object.
Put the object in {scene} with the {texture1} texture into the object with the {texture2} texture.
The object of texture {texture1} in {scene} should be placed in the object of texture {texture2}.
"""

ROTATE = """
Rotate the {dragged_obj} 120 degrees.
Turn the {dragged_obj} by 120 degrees.
Please rotate {dragged_obj} by 120 degrees clockwise.
Spin the {dragged_obj} 120 degrees clockwise.
Could you turn the {dragged_obj} 120°?
Rotate the {dragged_obj} clockwise by 120 degrees
Give the {dragged_obj} a 120 degree turn.
Give the {dragged_obj} a 120-degree clockwise rotation.
The {dragged_obj} should be rotated by 120 degrees.
The {dragged_obj} must be turned 120 degrees clockwise.
I want the {dragged_obj} rotated 120 degrees.
I'd like the {dragged_obj} to be turned by 120 degrees.
Rotate by 120 degrees the {dragged_obj}.
Apply a rotation of 120 degrees to the {dragged_obj}.
Perform a 120 degree clockwise rotation of the {dragged_obj}.
Take the {dragged_obj} and turn it by 120 degrees.
Turn the {dragged_obj} one hundred and twenty degrees.
By 120 degrees, rotate the {dragged_obj}.
Rotate the object {dragged_obj} in a clockwise direction by 120 degrees.
Turn the {dragged_obj} through 120 degrees.
Make a 120 degree turn with the {dragged_obj}.
Twist the {dragged_obj} by 120 degrees.
Have the {dragged_obj} rotated by 120 degrees.
Please turn the {dragged_obj} around by 120 degrees in place.
Pick up the {dragged_obj}, rotate it 120 degrees and put it back.
Rotate the {dragged_obj} so that it is turned by 120 degrees.
Rotate {dragged_obj} by an angle of 120 degrees.
Turn the {dragged_obj} clockwise 120 degrees without moving it.
Change the orientation of the {dragged_obj} by 120 degrees clockwise.
The {dragged_obj} needs a rotation of 120 degrees.
The {dragged_obj} needs to be turned 120 degrees to the right.
The {dragged_obj} needs turning by 120 degrees.
Reorient the {dragged_obj} by 120 degrees.
Please do a 120-degree spin of the {dragged_obj}.
Swivel the {dragged_obj} through an angle of 120 degrees clockwise.
Keep the {dragged_obj} where it is but rotate it by 120 degrees.
Rotate the thing in {dragged_obj} clockwise, 120 degrees.
"""

MATCH = """
Place each fruit in the area that matches its color, if such an area exists.
Put every fruit in the area of the same colour, if there is one.
Put each fruit into the area with the same colour where such an area exists.
Move each fruit to the matching area, if it exists.
Move each fruit to the area of matching colour if one exists.
Sort the fruits into the areas of the same colour, if such areas exist.
For each fruit, move it to the area of its colour if there is such an area.
Sort the fruit by colour into the areas.
Distribute the fruits to the areas that match their colour.
If there is an area of the same colour, put each fruit into it.
Put all fruits on the areas matching their colour where possible.
Every fruit should go to the area whose colour matches its own, if available.
Please place every fruit onto the region that has the same color as it, if any such region exists.
Each fruit belongs in the area of its own colour, provided that such an area exists.
Bring each fruit to the zone with its colour, if there is one.
Put each fruit in its matching colour area, if such an area is present.
Put each of the fruits on the same-coloured area, if one exists. Leave the others where they are.
All fruits should be placed in the area of the corresponding colour, when there is one.
Place every piece of fruit into the area that has its color, as long as such an area exists.
Take each fruit and put it in the area that has the same colour, if there is one.
Whenever there is an area of the same colour, move each fruit there.
Put each fruit in the area sharing its color, if such an area exists.
Move all the fruits into areas matching their colors, if such areas exist.
Place each fruit that has a matching area into that area.
Match each fruit with the area of its colour.
Place the fruits in areas of matching colors; ignore fruits without such an area.
Every fruit goes in the area of the same colour. If there is none, leave it.
Each fruit should be placed in the region having its colour, if one exists.
Put each fruit on the paper of its colour, if there is one.
Move fruits to the areas with corresponding colors, if they exist.
Arrange the fruits so that each is in the area of its colour, if such an area exists.
For every fruit that has an area of the same colour, put the fruit into that area.
For every fruit with a matching area, place it in that area.
If an area of the same colour exists, place each fruit in it.
Should an area of the same colour exist, put each fruit there.
Fruits go into the area that matches their colour, if such an area exists
Group the fruits by colour into their areas.
Assign each fruit to the area with the same color, if it exists.
Place each fruit in the area that has a color matching the fruit, if such an area exists.
Place each fruit in the area whose color is the same as that of the fruit, if there is such an area.
Place each piece of fruit on the colour patch that matches it, if such a patch exists.
Put each fruit in the colour-matched area if available
"""

SURFACES = """
Put the red and blue polka dot object in {scene} into the tiles object.
In {scene} there is a pink object; put it into the tiles object.
Find the pink object in {scene} and put it in the object with tiles.
Take the pink-coloured object in {scene}, place it inside the tiled object.
Put the object that is pink in {scene} into the one that is tiled.
The pink object from {scene} must end up in the object with the magma texture.
Put the object with the red and yellow stripes in {scene} into the object with the red swirls.
Put the red-and-yellow-striped object in {scene} into the one with the red swirl pattern.
Put the object having yellow and blue polka dots in {scene} into the wooden object
Put the yellow and blue dotted thing in {scene} inside the brick object.
Move the granite object in {scene} to the rainbow object.
"""


def _lines(text: str) -> list[str]:
    return [line for line in text.strip().splitlines() if line.strip()]


@pytest.mark.parametrize("text", _lines(PUT))
def test_put_one_pictured_thing_into_another(text: str) -> None:
    (command,) = understand(text).commands
    assert (command.kind, command.thing.like, command.thing.like_only) == ("put", "dragged_obj_1", None)
    assert command.to is not None
    assert command.to.how == "in"
    assert command.to.what is not None
    assert command.to.what.like == "base_obj"


@pytest.mark.parametrize("text", _lines(TEXTURE))
def test_put_by_texture(text: str) -> None:
    (command,) = understand(text).commands
    assert (command.kind, command.thing.like, command.thing.like_only) == ("put", "texture1", "texture")
    assert command.to is not None
    assert command.to.how == "in"
    assert command.to.what is not None
    assert (command.to.what.like, command.to.what.like_only) == ("texture2", "texture")


@pytest.mark.parametrize("text", _lines(ROTATE))
def test_rotate_clockwise(text: str) -> None:
    commands = [command for command in understand(text).commands if command.kind == "rotate"]
    assert [(command.thing.like, command.rotate_deg) for command in commands] == [("dragged_obj", 120.0)]


@pytest.mark.parametrize("text", _lines(MATCH))
def test_each_fruit_to_its_colour(text: str) -> None:
    (command,) = understand(text).commands
    assert (command.kind, command.thing.noun) == ("put", "fruit")
    assert command.thing.quantity in ("each", "all")
    assert command.to is not None
    assert (command.to.how, command.to.aspect) == ("matching", "colour")
    assert command.to.what is not None
    assert command.to.what.noun == "area"


@pytest.mark.parametrize("text", _lines(SURFACES))
def test_surfaces_in_words(text: str) -> None:
    (command,) = understand(text).commands
    assert command.to is not None
    assert command.to.what is not None
    assert command.to.how == "in"
    thing, place = command.thing, command.to.what
    assert thing.colours or thing.material
    assert place.material or place.pattern


def test_the_list_is_long() -> None:
    """So that a slip in one group cannot hide behind a short list."""
    assert sum(len(_lines(group)) for group in (PUT, TEXTURE, ROTATE, MATCH, SURFACES)) >= 130


@pytest.mark.parametrize(
    "text",
    [
        "Sort the fruits: each goes to the region that has its colour, where such a region exists.",
        "Sort the fruits: each goes to the region that has its colour.",
    ],
)
def test_a_shared_colour_is_never_lost_on_the_way(text: str) -> None:
    (command,) = understand(text).commands
    assert command.to is not None
    assert (command.to.how, command.to.aspect) == ("matching", "colour")
