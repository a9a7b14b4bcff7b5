"""Put a description into words that `describe` reads back to the same description."""

from __future__ import annotations

from dataclasses import replace

from wonderful_team.core.text import ordinal
from wonderful_team.offline.description import LINE_BY_LINE, Description, Related
from wonderful_team.offline.language.vocabulary import plural

_RELATION_WORDS = {"left_of": "left of", "right_of": "right of", "above": "above", "below": "below", "near": "next to", "nearest": "nearest to",
                   "far_from": "far from", "on": "on top of", "inside": "inside", "between": "between",
                   "same_colour": "with the same colour as", "same_pattern": "with the same texture as",
                   "same_shape": "with the same shape as"}  # fmt: skip
_FROM = {"leftmost": "left", "rightmost": "right", "topmost": "top", "bottommost": "bottom"}


def render(description: Description) -> str:
    """Plain words for a description, without an article; ends with its relations."""
    if description.placed is not None:
        return f"place of the {render(description.placed)}" + (
            f" in {{{description.like}}}" if description.like else ""
        )
    words, tail = _counted(description)
    words += _looks(description) + _head(description)
    if _is_corner(description):
        tail.append(f"in the {corner_words(description.name)} corner")
    if description.like and description.like_only is None:
        tail.append(f"shown in {{{description.like}}}")
    tail += [relation_words(related) for related in description.related]
    if description.excluded:
        tail.append("except the " + " and the ".join(render(item) or item.name for item in description.excluded))
    return " ".join([*words, *tail])


def worded(description: Description) -> Description:
    """The same description with its own words."""
    return replace(description, text=render(description))


def _counted(description: Description) -> tuple[list[str], list[str]]:
    """How many or which of several: words before the noun and after it."""
    words: list[str] = []
    if description.quantity in ("each", "all"):
        words.append(description.quantity)
    elif description.quantity == "number":
        words.append(str(description.number))
    superlative = description.superlative
    if superlative in LINE_BY_LINE:
        return [*words, ordinal(description.ordinal)], [f"counted {superlative} from the top left"]
    if description.ordinal > 1:
        words.append(ordinal(description.ordinal))
        if superlative in _FROM:
            return words, [f"from the {_FROM[superlative]}"]
    if superlative and not _is_corner(description):
        words.append(superlative)
    return words, []


def _looks(description: Description) -> list[str]:
    words = ["free"] if description.name == "free" else []
    if description.dark is not None:
        words.append("dark" if description.dark else "light")
    if description.colours:
        words.append(" and ".join(description.colours))
    if description.pattern:
        words.append(description.pattern)
    if description.material:
        words.append(description.material)
    return words


def relation_words(related: Related) -> str:
    """Such as "left of the blue bowl"."""
    return f"{_RELATION_WORDS[related.relation]} the " + " and the ".join(render(to) for to in related.to)


def _head(description: Description) -> list[str]:
    words: list[str] = []
    if description.like and description.like_only == "texture":
        words.append(
            f"{{{description.like}}} texture" if "texture" not in description.like else f"{{{description.like}}}"
        )
    if description.like and description.like_only == "shape":
        words.append(f"{{{description.like}}} shaped")
    noun = description.name if description.noun in ("fruit", "container") and description.name else description.noun
    if description.noun == "letter" and description.name:
        return [*words, f"letter {description.name}"]
    if description.shape and description.noun in ("object", "thing"):
        noun = description.shape if description.shape not in ("long",) else "long object"
        noun = "L-shaped object" if description.shape == "l-shape" else noun
    elif description.shape:
        words.append("L-shaped" if description.shape == "l-shape" else description.shape)
    if description.name == "free" and description.noun not in ("area",):
        noun = description.noun
    if description.name == "table":
        noun = "table"
    if description.quantity == "all" or (description.quantity == "number" and description.number > 1):
        noun = noun if noun.endswith("s") and noun not in ("cross",) else plural(noun)
    return [*words, noun]


def _is_corner(description: Description) -> bool:
    return " " in description.name


def corner_words(corner: str) -> str:
    """Such as "top left" for "topmost leftmost"."""
    return " ".join(_FROM[word] for word in corner.split())


def split_colours(thing: Description) -> list[Description]:
    """The words "the red, green and blue blocks" are three kinds of thing, not one in three colours."""
    counted = thing.quantity == "number"
    if thing.quantity == "one" or len(thing.colours) <= 1 or thing.pattern or thing.material:
        return [thing]
    if counted and thing.number != len(thing.colours):
        return [thing]  # how many of which colour is not said
    quantity = "one" if counted else thing.quantity
    parts = [replace(thing, colours=(colour,), quantity=quantity, number=1) for colour in thing.colours]
    return [worded(part) for part in parts]


def singles(thing: Description) -> list[Description]:
    """The words "the red and blue bowls" as one bowl of each colour."""
    return [worded(replace(part, quantity="one", number=1)) for part in split_colours(thing)]
