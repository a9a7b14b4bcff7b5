"""Every word that the offline model knows, mapped to a kind of token and a canonical value.

Articles and the words in FILLERS carry no meaning here and are skipped; any other word that is not listed is refused
by name. The canonical values are those of `description.py`.
"""

from __future__ import annotations

Entry = tuple[str, object]
"""Kind of token (a terminal of the grammar) and its value."""

ARTICLES = frozenset(("the", "a", "an", "this", "these", "those", "some"))

FILLERS = frozenset(
    """please kindly could can would will you i we me us now just simply carefully gently slowly precisely exactly
    directly straight robot arm gripper hand hey hi hello ok okay thanks thank  like love d ll let lets first
    firstly finally lastly next  also too again lying located standing sitting situated resting positioned found
    currently together once so task job goal your my our   safely properly correctly respective respectively
    entire whole  own real alone picture image shown displayed pictured seen visible workspace scene desk
    surface tabletop here away down up overall around bright vivid respectively suitable appropriate proper  individual
    desktop single mind actually then able""".split()
)
"""Words that are skipped: politeness, addressing the robot, and words that do not change what is asked."""

_COLOURS: dict[str, str] = {
    "red": "red crimson scarlet ruby vermilion maroon",
    "yellow": "yellow gold golden",
    "green": "green lime emerald",
    "cyan": "cyan turquoise teal aqua",
    "blue": "blue navy azure cobalt",
    "purple": "purple violet lilac lavender mauve",
    "pink": "pink rose magenta fuchsia",
    "brown": "brown tan beige",
    "olive": "olive khaki",
    "white": "white",
    "grey": "grey gray silver",
    "black": "black",
}
_PATTERNS: dict[str, str] = {
    "plain": "plain unpatterned solid uniform",
    "striped": "striped stripy stripe stripes lined banded",
    "dotted": "dotted spotted dot dots spots polka speckled",
    "checkered": "checkered chequered checked checkerboard chessboard",
    "swirled": "swirled swirly swirl swirls swirling spiral curly",
    "mottled": "mottled furry grainy",
    "multicoloured": "multicoloured multicolored colourful colorful rainbow",
}
_SHAPES: dict[str, str] = {
    "square": "square",
    "rectangle": "rectangle rectangular oblong",
    "circle": "circle circular round disc disk",
    "ring": "ring doughnut donut",
    "triangle": "triangle triangular",
    "diamond": "diamond rhombus",
    "pentagon": "pentagon pentagonal",
    "hexagon": "hexagon hexagonal",
    "star": "star",
    "heart": "heart",
    "cross": "cross plus",
    "flower": "flower",
    "oval": "oval ellipse elliptical",
    "crescent": "crescent",
    "frame": "frame",
    "long": "long elongated",
}
_NOUNS: dict[str, str] = {
    "object": "object item piece shape figure thing",
    "block": "block cube ",
    "fruit": "fruit",
    "area": "area region zone field patch spot space paper sheet mat pad section location",
    "letter": "letter",
    "toy": "toy",
    "ball": "ball sphere",
}
_CONTAINERS = "container bowl dish plate pan tray box bin basket receptacle pallet holder"
_FRUITS = "apple banana lemon pear plum strawberry grape blueberry cherry peach kiwi tomato mango melon"
_PLURALS = {"strawberry": "strawberries", "blueberry": "blueberries", "cherry": "cherries", "peach": "peaches",
            "box": "boxes", "dish": "dishes", "cross": "crosses", "patch": "patches", "tomato": "tomatoes",
            "mango": "mangoes", "kiwi": "kiwis"}  # fmt: skip

_VERBS: dict[str, str] = {
    "PUT": "put place move bring drop set lay transfer relocate deposit shift position carry deliver insert load placed "
    "moved brought dropped laid transferred relocated deposited shifted carried delivered inserted loaded putting "
    "placing moving bringing dropping transferring stick store throw toss slot pop stow stash dump "
    "plop tuck add hand send haul convey transport lower slip pass stored thrown",
    "TAKE": "take grab pick get lift fetch find locate grasp identify seize collect gather",
    "ROTATE": "rotate turn spin rotated turned spun rotation twist rotating turning spinning revolve swivel reorient orient pivot",
    "STACK": "stack pile stacked piled stacking",
    "PUSH": "push slide pushed slid shove nudge pushing sliding drag",
    "SORT": "sort distribute  group sorted distributed sorting allocate assign organise organize arrange",
    "GIVE": "give perform apply make do execute",
    "WANT": "want wish",
    "LEAVE": "leave ignore skip keep",
}
_SMALL: dict[str, str] = {
    "IN": "in inside within",
    "INTO": "into",
    "ON": "on upon atop over",
    "ONTO": "onto",
    "TO": "to towards toward at against",
    "NEAR": "beside near alongside adjoining",
    "BY": "by through",
    "ABOVE": "above behind",
    "BELOW": "below under beneath underneath",
    "BETWEEN": "between",
    "OF": "of",
    "WITH": "with having bearing",
    "FROM": "from",
    "AS": "as",
    "AND": "and but",
    "CONTAIN": "contain hold",
    "FILL": "fill",
    "THEN": "then afterwards afterward subsequently thereafter",
    "THAT": "that which",
    "WHOSE": "whose",
    "FOR": "for",
    "THERE": "there",
    "IT": "it them itself themselves",
    "ITS": "its their",
    "THEY": "they",
    "MATCH": "match matches matching matched fits corresponds correspond fitting belonging",
    "SAME": "same identical corresponding equal",
    "SHARE": "shares share sharing has have",
    "AUX": "should must shall be is are been being goes go belongs belong ends end ought gets",
    "EACH": "each every",
    "ALL": "all both",
    "ONE": "one ones",
    "EVERYTHING": "everything",
    "REST": "rest others other remaining",
    "WHERE": "where",
}
_ASPECTS: dict[str, str] = {
    "colour": "colour color colours colors coloured colored",
    "texture": "texture pattern patterned textured textures patterns",
    "shape": " profile outline form",
}
_MATERIALS: dict[str, str] = {
    "brick": "brick bricks brickwork",
    "tile": "tile tiles tiled tiling",
    "wood": "wood wooden timber",
    "granite": "granite stone stony marble marbled rocky rock concrete",
    "plastic": "plastic",
    "tiger": "tiger",
    "lava": "lava magma volcanic",
    "paisley": "paisley",
}
_LOOKS: dict[str, tuple[str, tuple[str, ...]]] = {
    "gingham": ("checkered", ()), "plaid": ("checkered", ()), "zebra": ("striped", ("white", "black")),
    "camouflage": ("mottled", ()), "leopard": ("dotted", ()), "metallic": ("plain", ("grey",)),
}  # fmt: skip
"""Surfaces named after something else: pattern and colours."""
_SUPERLATIVES: dict[str, str] = {
    "largest": "largest biggest large big bigger larger huge",
    "smallest": "smallest littlest small little tiny smaller",
    "leftmost": "leftmost",
    "rightmost": "rightmost",
    "topmost": "topmost uppermost",
    "bottommost": "bottommost lowermost lowest",
    "middle": "middle central centre center",
    "tallest": "tallest highest tall",
    "shortest": "shortest short",
    "nearest": "nearest closest",
}
_SIDES = {"left": "leftmost", "right": "rightmost", "top": "topmost", "bottom": "bottommost", "upper": "topmost",
          "lower": "bottommost"}  # fmt: skip
_ORDINALS = {"second": 2, "third": 3, "fourth": 4, "fifth": 5, "2nd": 2, "3rd": 3, "4th": 4, "5th": 5}
NUMBERS = {"two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10,
           "fifteen": 15, "twenty": 20, "thirty": 30, "forty": 40, "fortyfive": 45, "fifty": 50, "sixty": 60,
           "seventy": 70, "eighty": 80, "ninety": 90, "hundred": 100}  # fmt: skip


_OTHERS: dict[str, Entry] = {
    "dark": ("DARK", True), "darker": ("DARK", True), "light": ("DARK", False), "pale": ("DARK", False),
    "lighter": ("DARK", False), "orange": ("ORANGE", False), "oranges": ("ORANGE", True), "table": ("TABLE", "table"),
    "clockwise": ("TURN", 1.0), "rightwards": ("TURN", 1.0), "cw": ("TURN", 1.0), "counterclockwise": ("TURN", -1.0),
    "anticlockwise": ("TURN", -1.0), "ccw": ("TURN", -1.0), "free": ("FREE", "free"), "empty": ("FREE", "free"),
    "clear": ("FREE", "free"), "open": ("FREE", "free"), "vacant": ("FREE", "free"), "unoccupied": ("FREE", "free"),
    "back": ("ORIGIN", "origin"),
}  # fmt: skip


def _words() -> dict[str, Entry]:
    words: dict[str, Entry] = {}
    for table, kind in ((_COLOURS, "COLOUR"), (_PATTERNS, "PATTERN"), (_ASPECTS, "ASPECT"), (_SUPERLATIVES, "SUPER")):
        for value, listing in table.items():
            words |= {word: (kind, value) for word in listing.split()}
    for material, listing in _MATERIALS.items():
        words |= {word: ("MATERIAL", material) for word in listing.split()}
    words |= {word: ("LOOK", looks) for word, looks in _LOOKS.items()}
    words |= _shape_words()
    for noun, listing in _NOUNS.items():
        for word in listing.split():
            _noun(words, word, (noun, ""))
    for word in _CONTAINERS.split():
        _noun(words, word, ("container", "" if word in ("container", "receptacle", "holder") else word))
    for word in _FRUITS.split():
        _noun(words, word, ("fruit", word))
    for table in (_VERBS, _SMALL):
        for kind, listing in table.items():
            words |= {word: (kind, kind.lower()) for word in listing.split()}
    words |= {word: ("SIDE", side) for word, side in _SIDES.items()}
    words |= {word: ("ORDINAL", number) for word, number in _ORDINALS.items()}
    words |= {word: ("NUMBER", float(number)) for word, number in NUMBERS.items()}
    return words | _OTHERS


def _shape_words() -> dict[str, Entry]:
    words: dict[str, Entry] = {}
    for shape, listing in _SHAPES.items():
        words |= {word: ("SHAPE", (shape, False)) for word in listing.split()}
        words |= {plural(word): ("SHAPE", (shape, True)) for word in listing.split() if plural(word) not in words}
    return words


def plural(word: str) -> str:
    """The plural of a noun that the model knows."""
    return _PLURALS.get(word, word + "s")


def _noun(words: dict[str, Entry], word: str, value: tuple[str, str]) -> None:
    words[word] = ("NOUN", (*value, False))
    words[plural(word)] = ("NOUN", (*value, True))


WORDS: dict[str, Entry] = _words()
"""Single words."""

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
                                     "on the left side", "on the left hand side", "at the very left", "far left",
                                     "furthest left", "furthest to the left", "farthest to the left", "leftwards",
                                     "at the left edge")),
        (("SIDE_POST", "rightmost"), ("on the right", "at the right", "on the far right", "at the far right",
                                      "to the right", "on the right side", "on the right hand side", "far right",
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
        (("TAKE", "take"), ("pick up", "take hold of", "look for", "take up", "get hold of", "lift up")),
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
                            "if possible", "if you please", "of your choice", "as it is")),
        (("SKIP", "skip"), ("without moving it", "without lifting it", "without changing its position",
                            "keeping it in place", "without moving it away", "keeping its position")),
        (("BY", "by"), ("by an angle of", "through an angle of", "by angle of", "by a total of")),
        (("ROTATE", "rotate"), ("change the orientation of", "change orientation of", "re orient")),
        (("NOUN", ("fruit", "", False)), ("piece of fruit",)),
        (("NOUN", ("fruit", "", True)), ("pieces of fruit",)),
        (("ROTATE", "rotate"), ("turn around", "turn round", "rotate around", "spin around")),
        (("STACK", "stack"), ("pile up", "stack up")),
        (("SORT", "sort"), ("sort out",)),
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
        (("ANGLE", 45.0), ("an eighth of a turn", "one eighth of a turn", "an eighth turn")),
        (("ANGLE", 360.0), ("a full turn", "full turn", "a complete turn", "one full turn", "a full rotation")),
        (("ORIGIN", "origin"), ("back to its original place", "back to where it was", "back where it was",
                                "to where it was", "to its original place", "to its original position",
                                "back to its original position", "back to its place", "to its initial position",
                                "back to its origin", "to its origin", "back to its initial position",
                                "where it was before", "back to where it came from", "to its old place",
                                "back to its old place", "where it was", "back in its place", "to its starting point",
                                "back to where it stood", "where it stood")),
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
        (("ALL", "all"), ("all of", "both of", "all those", "all existing")),
        (("EVERYTHING", "everything"), ("every thing", "all things")),
        (("THEN", "then"), ("and then", "after that", "and after that", "next", "followed by", "and afterwards",
                            "and finally", "finally", "before you", "and subsequently", "once that is done",
                            "when that is done", "and next", "and lastly", "after which", "as a second step")),
        (("ON_TABLE", "table"), ("on the table", "on this table", "of the table", "on the desk", "on the workspace",
                                 "in the workspace", "on the surface", "in the scene", "on table", "in this scene",
                                 "on the tabletop", "from the table", "in view", "in the view", "off the table",
                                 "on the work surface", "on the work area", "in front of you", "you see", "you can see",
                                 "you find", "that you see", "that you can see", "there is", "there are")),
        (("CORNER", ("topmost", "leftmost")), ("top left corner", "upper left corner", "top left", "upper left")),
        (("CORNER", ("topmost", "rightmost")), ("top right corner", "upper right corner", "top right", "upper right")),
        (("CORNER", ("bottommost", "leftmost")), ("bottom left corner", "lower left corner", "bottom left",
                                                  "lower left")),
        (("CORNER", ("bottommost", "rightmost")), ("bottom right corner", "lower right corner", "bottom right",
                                                   "lower right")),
    )
    for words in listing
}  # fmt: skip
"""Phrases of several words; the longest that fits wins. Articles inside them are optional."""


def known_words() -> str:
    """What the model knows, in one line for a refusal."""
    nouns = sorted({word for word, (kind, value) in WORDS.items() if kind == "NOUN" and not value[2]})  # type: ignore[index]
    return (
        f"colours ({', '.join((*_COLOURS, 'orange'))}), patterns ({', '.join(_PATTERNS)}), "
        f"materials ({', '.join(_MATERIALS)}), shapes ({', '.join(_SHAPES)}, "
        f"l-shape, letters), nouns ({', '.join(nouns)}), left of, right of, above, below, beside, between, in, on, "
        "largest, smallest, leftmost, rightmost, middle, put, rotate, stack, push, sort, each, all"
    )
