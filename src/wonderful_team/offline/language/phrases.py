"""Phrases of several words that mean one thing, and the kind of token that each is."""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.offline.language.vocabulary import ARTICLES, Entry


def _origin_phrases() -> list[str]:
    """Ways of saying "back to where it was"."""
    olds = "original initial old former first previous own starting earlier".split()
    places = "place position location spot container bowl area pose point home".split()
    phrases = [
        f"{to} {whose} {old} {place}"
        for to in ("to", "into", "in", "back to", "back into", "at", "back in", "back onto", "onto")
        for whose in ("its", "their", "the")
        for old in olds
        for place in (*places, *(place + "s" for place in places))
    ]
    for it in ("it", "they", "everything", "all"):
        for was in ("was", "were", "came from", "stood", "lay", "started", "had been", "used to be", "began", "has been",
                    "was before", "were before", "was at first", "was originally", "were originally", "belonged"):  # fmt: skip
            phrases += [f"{to}where {it} {was}" for to in ("", "to ", "back to ", "back ")]
    phrases += [
        "back again",
        "back home",
        "back there",
        "back to start",
        "to its home",
        "to the start",
        "back to its home",
    ]
    return phrases


_ROWS = {"topmost": ("top", "upper", "back", "far"), "bottommost": ("bottom", "lower", "front", "near")}
_COLUMNS = {"leftmost": ("left", "left hand"), "rightmost": ("right", "right hand")}


def _corner_phrases(rows: Sequence[str], columns: Sequence[str]) -> list[str]:
    """Ways of naming one corner."""
    named = [name for row in rows for column in columns for name in (f"{row} {column}", f"{column} {row}")]
    ends = [f"{name} {end}" for name in named for end in ("corner", "hand corner")]
    return [*named, *ends, *(f"corner {at} {name}" for name in named for at in ("at", "in", "on", "to"))]


PHRASES: dict[tuple[str, ...], Entry] = {
    tuple(word for word in words.split() if word not in ARTICLES): entry
    for entry, listing in (
        (("LEFT_OF", "left"), ("to the left of", "on the left of", "at the left of", "left of", "to left of", "west of",
                               "on the left side of", "to the left side of", "on the left hand side of",
                               "at the left side of", "to the west of", "left from", "to the left from")),
        (("RIGHT_OF", "right"), ("to the right of", "on the right of", "at the right of", "right of", "to right of",
                                 "east of", "on the right side of", "to the right side of",
                                 "on the right hand side of", "at the right side of", "to the east of",
                                 "right from", "to the right from")),
        (("ABOVE", "above"), ("north of", "at the back of", "to the north of", "further up than", "on the far side of",
                              "in back of")),
        (("BELOW", "below"), ("in front of", "south of", "to the south of", "to the front of", "on the near side of")),
        (("NEAR", "near"), ("next to", "close to", "adjacent to", "right next to", "by the side of", "at the side of",
                            "to the side of", "near to", "right beside", "directly next to",
                            "directly beside", "immediately beside", "just beside", "on the side of",
                            "directly adjacent to")),
        (("INTO", "into"), ("in to", "into the inside of", "into the middle of", "into the centre of", "over into",
                            "into the center of", "to the inside of", "to the middle of", "to the centre of",
                            "to the center of", "down into", "back into")),
        (("ONTO", "onto"), ("on to", "to the top of", "onto the top of", "onto the middle of", "over onto")),
        (("TO", "to"), ("over to", "up to", "all the way to", "right up to")),
        (("FAR", "far"), ("far from", "far away from", "away from")),
        (("ON", "on"), ("on top of", "over the top of", "on the top of")),
        (("IN", "in"), ("inside of", "in the middle of", "in the centre of",
                        "in the center of", "at the centre of", "at the center of", "at the middle of")),
        (("SIDE_POST", "leftmost"), ("on the left", "at the left", "on the far left", "at the far left", "to the left",
                                     "to the left side", "on the left side", "on the left hand side", "at the very left", "far left",
                                     "furthest left", "furthest to the left", "farthest to the left", "leftwards",
                                     "at the left edge")),
        (("SIDE_POST", "rightmost"), ("on the right", "at the right", "on the far right", "at the far right",
                                      "to the right", "to the right side", "on the right side", "on the right hand side", "far right",
                                      "at the very right", "furthest right", "furthest to the right",
                                      "farthest to the right", "at the right edge")),
        (("SIDE_POST", "topmost"), ("at the top", "on the top", "at the back", "in the back", "at the very top",
                                    "furthest up", "at the top edge", "upwards", "nearest to the top")),
        (("SIDE_POST", "bottommost"), ("at the bottom", "on the bottom", "at the front", "in the front", "downwards",
                                       "at the very bottom", "furthest down", "at the bottom edge",
                                       "nearest to the bottom")),
        (("SIDE_POST", "middle"), ("to the centre of the table", "to the center of the table",
                                   "to the middle of the table", "in the centre of the table",
                                   "in the center of the table", "in the middle of the table",
                                   "at the centre of the table", "at the center of the table",
                                   "at the middle of the table", "on the middle of the table",
                                   "into the middle of the table", "into the centre of the table",
                                   "into the center of the table", "to the middle", "to the centre", "to the center",
                                   "in the middle", "in the centre", "in the center", "at the centre", "at the center",
                                   "in between the others")),
        (("SUPER", "leftmost"), ("left most", "far left")),
        (("SUPER", "rightmost"), ("right most",)),
        (("SUPER", "topmost"), ("top most",)),
        (("SUPER", "bottommost"), ("bottom most",)),
        (("BETWEEN", "between"), ("in between", "in the gap between", "in the space between", "into the gap between",
                                  "into the space between", "halfway between", "midway between")),
        (("TAKE", "take"), ("pick up", "take hold of", "look for", "take up", "get hold of", "lift up", "start with", "begin with")),
        (("WANT", "want"), ("i want", "i would like", "i d like", "i want you to have", "see to it that",
                            "make sure that", "make sure", "ensure that", "ensure", "i wish", "we want", "i need",
                            "we need", "i would love", "be sure that", "i d love")),
        (("PUT", "put"), ("put down", "set down", "place down", "lay down", "drop off", "let go of")),
        (("AUX", "aux"), ("has to be", "have to be", "needs to be", "need to be", "is to be", "are to be",
                          "ought to be", "should end up", "must end up", "should be", "must be", "must go", "should go",
                          "needs to go", "has to go", "have to go", "need to go", "is supposed to go",
                          "is supposed to be", "is to go", "are to go", "to be", "ends up", "end up", "to go",
                          "to end up", "supposed to be", "needs", "has to", "need to", "needs to", "belongs",
                          "should sit", "should lie", "must lie", "should rest", "to rest", "to sit", "to lie",
                          "to become", "rest", "rests", "sit", "sits", "to stand")),
        (("SKIP", "skip"), ("i want you to", "i would like you to", "i d like you to", "your task is to", "task is to",
                            "you should", "you must", "i need you to", "we want you to", "we need you to",
                            "your job is to", "goal is to", "your goal is to", "you need to", "you have to", "in place",
                            "on the spot", "where it is", "where it stands", "where it lies", "at its place",
                            "in its place", "at its current position", "help me to", "help me", "go ahead and",
                            "try to", "be so kind as to", "be so kind and", "it is time to", "as follows",
                            "what i want is to", "the aim is to", "aim is to", "make it so that", "if you can",
                            "if possible", "if you please", "of your choice", "as it is", "out of the way", "and let go")),
        (("SKIP", "skip"), ("without moving it", "without lifting it", "without changing its position",
                            "keeping it in place", "without moving it away", "keeping its position")),
        (("BY", "by"), ("by an angle of", "through an angle of", "by angle of", "by a total of")),
        (("ROTATE", "rotate"), ("change the orientation of", "change orientation of", "re orient")),
        (("NOUN", ("area", "", False)), ("sheet of paper", "piece of paper", "patch of paper")),
        (("NOUN", ("fruit", "", False)), ("piece of fruit",)),
        (("NOUN", ("fruit", "", True)), ("pieces of fruit",)),
        (("ROTATE", "rotate"), ("turn around", "turn round", "rotate around", "spin around")),
        (("STACK", "stack"), ("pile up", "stack up")),
        (("SORT", "sort"), ("sort out", "bring together", "put together")),
        (("SKIP", "skip"), ("together",)),
        (("TURN", -1.0), ("counter clockwise", "anti clockwise", "against the clock", "opposite to clockwise")),
        (("TURN", 1.0), ("in clockwise direction", "clock wise", "in a clockwise direction",
                         "in the clockwise direction")),
        (("TURN", -1.0), ("in a counterclockwise direction", "in an anticlockwise direction",
                          "in the counterclockwise direction", "in the anticlockwise direction",
                          "in a counter clockwise direction", "in an anti clockwise direction")),
        (("ANGLE", 90.0), ("a quarter turn", "quarter turn", "a quarter of a turn", "a right angle", "right angle",
                           "a quarter rotation", "quarter of a full turn", "a quarter of a full turn",
                           "one quarter turn", "quarter of a turn", "a quarter of a rotation", "a quarter")),
        (("ANGLE", 180.0), ("a half turn", "half turn", "half a turn", "half a rotation", "a half rotation",
                            "half of a turn", "one half turn", "half way round", "halfway round", "halfway around")),
        (("ANGLE", 270.0), ("three quarter turn", "three quarters of a turn", "a three quarter turn",
                            "three quarters turn")),
        (("ANGLE", 120.0), ("a third of a turn", "one third of a turn", "third of a turn", "a third of a full turn",
                            "a third of a rotation")),
        (("ANGLE", 240.0), ("two thirds of a turn", "two thirds of a rotation", "two thirds of a full turn")),
        (("ANGLE", 60.0), ("a sixth of a turn", "one sixth of a turn", "a sixth of a full turn")),
        (("SAMEANGLE", None), ("that much", "by that much", "the same amount", "the same angle", "as much", "that angle",
                               "this angle", "that amount", "this much", "just as far", "as far", "equally far",
                               "the same way", "likewise", "the same extent", "this amount", "exactly that much",
                               "the given angle", "just as much")),
        (("OPPOSITE", 180.0), ("the other way", "the other way round", "the other way around", "the opposite direction",
                               "the opposite way", "other direction", "in the opposite direction",
                               "in the other direction", "the reverse direction", "the opposite side",
                               "the other side", "in the reverse direction", "to the opposite side",
                               "the reverse of its direction", "to the other side")),
        (("SWAP", "swap"), (*(f"{verb} {what}" for verb in ("trade", "change", "switch", "swap", "exchange", "interchange")
                              for what in ("places", "positions", "the places of", "the positions of")),
                            "swap round", "swap around", "switch around", "take each other s place",
                            "take each others places", "take each other s places")),
        (("REMOVE", "remove"), ("get rid of", "take away", "clear away", "clear", "put away", "put aside", "set aside",
                                "move aside", "move out of the way", "take out", "take off")),
        (("PLACE_OF", "place"), ("the place of", "the right place of", "the right place for", "the place for", "the home of",
                                 "the destination of", "the destination for", "the proper place of",
                                 "the proper place for", "the target of", "the spot for")),
        (("ON_TABLE", "table"), ("on the wrong place", "in the wrong place", "at the wrong place", "in a wrong place",
                                 "at a wrong place", "in the wrong spot", "not where it should be")),
        (("EXCEPT", "except"), ("except for", "apart from", "other than", "but not", "with the exception of", "save for",
                                "aside from", "all but not", "not including", "leaving out", "leave out", "without counting",
                                "though not", "not counting", "but for")),
        (("OFF", "off"), ("out of", "off of", "away off", "from out of", "off from")),
        (("ONE_OF", 1.0), ("one of", "any one of", "any of", "a single one of", "either of", "just one of",
                           "exactly one of")),
        (("OF_TWO", 2), ("of the two", "of both", "out of the two")),
        (("OF_TWO", 3), ("of the three", "out of the three")),
        (("OF_TWO", 1), ("among the", "of all", "out of all")),
        (("ACCORDING", "according"), ("according to", "depending on", "in accordance with", "as determined by",
                                      "on the basis of", "based on", "with regard to", "with respect to")),
        (("SKIP", "skip"), ("what about", "how about", "d be happy if you", "d be glad if you", "would be happy if you",
                            "would be glad if you", "it would be nice if you", "it would be nice to have",
                            "it would be good if you", "would be nice if", "shall we", "would you be so kind as to",
                            "would be great if you", "it would be great if you", "i d appreciate it if you",
                            "i would appreciate it if you", "i d ask you to", "time to", "what i need is",
                            "what i want is", "what you should do is", "what you have to do is", "is it possible to",
                            "would it be possible to", "do me a favour and", "do me a favor and", "be a dear and",
                            "in the end", "at the end", "as a first step", "as a last step", "to start with",
                            "to begin with", "as the first thing", "as the last thing", "the task", "for me",
                            "on its own", "for now", "right now", "at once", "if you would", "if you like",
                            "one after the other", "one after another", "one by one", "in any order",
                            "the following", "as it stands")),
        (("SIDE_POST", "leftmost"), ("towards the left", "toward the left", "to its left")),
        (("SIDE_POST", "rightmost"), ("towards the right", "toward the right", "to its right")),
        (("ANGLE", 45.0), ("an eighth of a turn", "one eighth of a turn", "an eighth turn")),
        (("ANGLE", 360.0), ("a full turn", "full turn", "a complete turn", "one full turn", "a full rotation")),
        (("ORIGIN", "origin"), ("back to its original place", "back to where it was", "back where it was",
                                "to where it was", "to its original place", "to its original position",
                                "back to its original position", "back to its place", "to its initial position",
                                "back to its origin", "to its origin", "back to its initial position",
                                "where it was before", "back to where it came from", "to its old place",
                                "back to its old place", "where it was", "back in its place", "to its starting point",
                                "back to where it stood", "where it stood", *_origin_phrases())),
        (("SHAPE", ("l-shape", False)), ("l shaped", "l shape", "shape of an l", "shape of the letter l")),
        (("SHAPED", "shaped"), ("shaped", "shaped like", "in the shape of", "formed like", "with the shape of")),
        (("PATTERN", "checkered"), ("checker board", "chess board")),
        (("PATTERN", "dotted"), ("polka dot", "polka dots", "polka dotted")),
        (("PATTERN", "multicoloured"), ("multi coloured", "multi colored", "many coloured")),
        (("LIKE", "like"), ("looks like", "look like", "looking like", "that looks like", "which looks like", "same as",
                            "identical to", "similar to", "as shown in", "shown in", "shown by", "pictured in",
                            "depicted in", "from the picture", "of the picture", "in the picture", "shown as",
                            "that is shown in", "the same as", "seen in", "like the one in", "as in", "displayed in",
                            "appearing in", "that appears in", "matching the picture", "resembling", "that resembles",
                            "illustrated in", "visible in")),
        (("EACH", "each"), ("each of", "every one of", "each one of", "every single", "each single", "every single one of",
                            "any")),
        (("ALL", "all"), ("all of", "all those", "all existing")),
        (("ALL", 2), ("both of", "both those")),
        (("THEY", "they"), ("they all", "they both")),
        (("EVERYTHING", "everything"), ("every thing", "all things")),
        (("THEN", "then"), ("and then", "after that", "and after that", "next", "followed by", "and afterwards",
                            "and finally", "finally", "before you", "and subsequently", "once that is done",
                            "when that is done", "and next", "and lastly", "after which", "as a second step", "at last", "and at last", "last of all")),
        (("ON_TABLE", "table"), ("on the table", "on this table", "of the table", "on the desk", "on the workspace",
                                 "in the workspace", "on the surface", "in the scene", "on table", "in this scene",
                                 "on the tabletop", "from the table", "in view", "in the view", "off the table",
                                 "on the work surface", "on the work area", "in front of you", "you see", "you can see",
                                 "you find", "that you see", "that you can see", "there is", "there are")),
        *((("CORNER", (row, column)), _corner_phrases(rows, columns)) for row, rows in _ROWS.items()
          for column, columns in _COLUMNS.items()),
    )
    for words in listing
}  # fmt: skip
"""Phrases of several words; the longest that fits wins. Articles inside them are optional."""
