"""Every word that the offline model knows, mapped to a kind of token and a canonical value.

Articles and the words in FILLERS carry no meaning here and are skipped; any other word that is not listed is refused
by name. The canonical values are those of `description.py`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from difflib import get_close_matches

from wonderful_team.core.text import ORDINALS

Entry = tuple[str, object]
"""Kind of token (a terminal of the grammar) and its value."""

ARTICLES = frozenset(("the", "a", "an", "this", "these", "those", "some"))

FILLERS = frozenset(
    """please kindly could can would will you i we me us now just simply carefully gently slowly precisely exactly
    directly straight robot arm gripper hand hey hi hello ok okay thanks thank  like love d ll let lets
    firstly finally lastly next  also too again lying located standing sitting situated resting positioned found
    currently once so task job goal your my our   safely properly correctly respective
    entire whole  own real alone picture image shown displayed pictured seen visible workspace scene desk
    surface tabletop here away down up overall around bright vivid suitable appropriate proper  individual
    desktop single mind actually then able nice happy glad shall perhaps maybe kind happily yes well quite midway halfway whichever
    simple simply current presently pls plz thx ta cheers mate um uh er hmm oh basically really yet alright sure cool great asap somewhere thoroughly vigorously firmly neatly""".split()
)
"""Words that are skipped: politeness, addressing the robot, and words that do not change what is asked."""


def _listed(words: str) -> dict[str, str]:
    """Listings by their first word, which is the canonical one; "VALUE: words" lists words for what is no word itself."""
    named = (entry.split(":") if ":" in entry else (entry.split()[0], entry) for entry in words.split(";"))
    return {value.strip(): listing for value, listing in named}


_COLOURS = _listed(
    """
    red crimson scarlet ruby vermilion maroon; yellow gold golden; green emerald; cyan turquoise teal aqua;
    blue navy azure cobalt; purple violet lilac lavender mauve; pink rose magenta fuchsia; brown tan beige;
    olive khaki; white; grey gray silver; black
    """
)
_PATTERNS = _listed(
    """
    plain unpatterned solid uniform; striped stripy stripe stripes lined banded;
    dotted spotted dot dots spots polka speckled; checkered chequered checked checkerboard chessboard;
    swirled swirly swirl swirls swirling spiral curly; mottled furry grainy;
    multicoloured multicolored colourful colorful rainbow
    """
)
_SHAPES = _listed(
    """
    square; rectangle rectangular oblong; circle circular round disc disk; ring doughnut donut; triangle triangular;
    diamond rhombus; pentagon pentagonal; hexagon hexagonal; star; heart; cross plus; flower;
    oval ellipse elliptical; crescent; frame; long elongated line bar stick rod strip
    """
)
_NOUNS = _listed(
    """
    object something item piece shape figure thing; block cube; fruit;
    area region zone field patch spot space paper sheet mat pad section location; letter; toy; ball sphere;
    bottle flask jar vial canister thermos; cap stopper cork; lid
    """
)
TOOLS = {"draw": "pen pencil marker crayon chalk", "wipe": "sponge cloth rag towel duster"}
"""Tools by what they do. No picture tells them apart: which one the fingers hold is stated among what is known of the robot."""
_CONTAINERS = "container bowl dish plate pan tray box bin basket receptacle pallet holder"
_FRUITS = (
    "apple apricot avocado banana blackberry blueberry cherry coconut fig grape grapefruit kiwi lemon lime mandarin mango "
    "melon peach pear plum strawberry tangerine tomato watermelon"
)
_PLURALS = {"strawberry": "strawberries", "blueberry": "blueberries", "cherry": "cherries", "peach": "peaches",
            "box": "boxes", "dish": "dishes", "cross": "crosses", "patch": "patches", "tomato": "tomatoes",
            "mango": "mangoes", "kiwi": "kiwis", "blackberry": "blackberries"}  # fmt: skip

_VERBS: dict[str, str] = {
    "PUT": "put place move bring brought drop set lay laid transfer relocate deposit shift position carry deliver insert load stick "
    "store throw thrown toss slot pop stow stash dump plop tuck serve tidy add hand send sent haul release convey transport slip pass "
    "park plant perch mount install situate settle nestle lodge plonk plunk wedge squeeze stuff cram ship chuck bung whack nip fling flung lob sling balance dunk",
    "TAKE": "take taken grab pick get lift fetch find locate grasp identify seize collect gather see spot notice consider choose chosen "
    "select look use pluck snatch retrieve raise hoist scoop nab snag",
    "ROTATE": "rotate turn spin spun rotation twist revolve swivel reorient orient pivot",
    "STACK": "stack pile tower",
    "SWAP": "swap exchange interchange switch trade",
    "RETURN": "return restore undo reset",
    "REMOVE": "remove eject extract withdraw",
    "FACE": "point face",
    "PUSH": "push slide slid shove nudge drag sweep swept brush scoot",
    "SORT": "sort distribute pair unite combine couple group allocate assign organise organize arrange",
    "GIVE": "give perform apply make do does execute undergo undergoes receive build create form construct erect assemble",
    "WANT": "want wish prefer",
    "DRAW": "draw drawn trace sketch paint write scribble doodle",
    "WIPE": "wipe clean scrub scour polish rub mop dust swab",
    "SHAKE": "shake shaken jiggle wiggle waggle agitate",
    "OPEN": "unscrew uncap uncork unseal",
    "LEAVE": "leave ignore skip keep",
}
"""Ways of moving things, from the classes of verbs of putting, sending, removing and turning; their regular forms are made."""
_AS_THEY_STAND = frozenset(("see", "use", "look", "do"))
_SMALL = _listed(
    """
    IN: in inside within; INTO: into; ON: on upon atop over; ONTO: onto; TO: to towards toward at against;
    NEAR: beside near alongside adjoining; BY: by through; ABOVE: above behind;
    BELOW: below under beneath underneath; BETWEEN: between; OF: of; WITH: with having bearing using; FROM: from; AS: as;
    AND: and but; CONTAIN: contain hold holding holds enclose missing; FILL: fill cover;
    THEN: then afterwards afterward subsequently thereafter; THAT: that which until till; WHOSE: whose; FOR: for;
    THERE: there; IT: it them itself themselves; ITS: its their theirs; THEY: they;
    MATCH: match matches matching matched suits suit suiting fits corresponds correspond fitting belonging;
    SAME: same identical corresponding equal; SHARE: shares share sharing has have shows contains holds;
    AUX: should must shall be is are been being live lives goes go belongs belong was were stood ends end ought gets lies lie stands stand sits sit rests wants wait comes come going;
    EACH: each every; ANY: any; ALL: all; ONE: one ones; RESPECTIVELY: respectively; EVERYTHING: everything;
    REST: rest others other remaining; EXCEPT: except excluding excepting save besides;
    ACCORDING: accordingly according; FORMER: former; LATTER: latter; MEASURE: angle amount;
    OPPOSITE: backwards backward; OFF: off out; ENOUGH: enough wanted needed required desired due called;
    WHERE: where; TIMES: times; TIPS: tips tip tipped corners cornered spikes spiked
    """
)
FIGURES = {
    "star": 5, "triangle": 3, "square": 4, "diamond": 4, "pentagon": 5, "hexagon": 6, "heptagon": 7, "octagon": 8, "rectangle": 0,
    "circle": 0, "spiral": 0, "line": 0, "zigzag": 0,
}  # fmt: skip
"""Figures that can be drawn, and how many tips or corners each has where nothing is said; 0 where none are counted."""
_ASPECTS = _listed(
    """
    colour color colours colors coloured colored;
    texture pattern patterned textured textures patterns surface covering;
    shape: profile outline form silhouette contour outlines profiles forms
    """
)
_MATERIALS = _listed(
    """
    brick bricks brickwork; tile tiles tiled tiling; wood wooden timber;
    granite stone stony marble marbled rocky rock concrete; plastic; tiger; lava magma volcanic; paisley
    """
)
_LOOKS: dict[str, tuple[str, tuple[str, ...]]] = {
    "gingham": ("checkered", ()), "plaid": ("checkered", ()), "zebra": ("striped", ("white", "black")),
    "camouflage": ("mottled", ()), "leopard": ("dotted", ()), "metallic": ("plain", ("grey",)),
}  # fmt: skip
"""Surfaces named after something else: pattern and colours."""
_SUPERLATIVES = _listed(
    """
    largest biggest large big bigger larger huge; smallest littlest small little tiny tiniest smaller; leftmost;
    rightmost; topmost uppermost; bottommost lowermost lowest; middle central centre center;
    tallest highest tall taller; shortest short shorter; nearest closest; darkest; lightest palest brightest
    """
)
_SIDES = {"left": "leftmost", "right": "rightmost", "top": "topmost", "bottom": "bottommost", "upper": "topmost",
          "lower": "bottommost"}  # fmt: skip
_ORDINALS = {**ORDINALS, "last": -1}
NUMBERS = {"two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10,
           "fifteen": 15, "twenty": 20, "thirty": 30, "forty": 40, "fortyfive": 45, "fifty": 50, "sixty": 60,
           "seventy": 70, "eighty": 80, "ninety": 90, "hundred": 100}  # fmt: skip


_OTHERS: dict[str, Entry] = {
    "dark": ("DARK", True), "darker": ("DARK", True), "light": ("DARK", False), "pale": ("DARK", False),
    "lighter": ("DARK", False), "orange": ("ORANGE", False), "oranges": ("ORANGE", True), "table": ("TABLE", "table"),
    "clockwise": ("TURN", 1.0), "rightwards": ("TURN", 1.0), "cw": ("TURN", 1.0), "counterclockwise": ("TURN", -1.0),
    "anticlockwise": ("TURN", -1.0), "ccw": ("TURN", -1.0), "free": ("FREE", "free"), "empty": ("FREE", "free"),
    "clear": ("FREE", "free"), "open": ("FREE", "free"), "vacant": ("FREE", "free"), "unoccupied": ("FREE", "free"),
    "back": ("ORIGIN", "origin"), "both": ("ALL", 2), "twice": ("TIMES", 2.0), "thrice": ("TIMES", 3.0),
    "to open": ("OPEN", "open"),
    **{name: ("FIGURE", name) for name in ("heptagon", "octagon", "zigzag")},
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
    for listing in TOOLS.values():
        for word in listing.split():
            _noun(words, word, ("tool", word))
    for table in (_VERBS, _SMALL):
        for kind, listing in table.items():
            words |= {word: (kind, kind.lower()) for word in listing.split()}
    words = _verb_forms() | words
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


def _verb_forms() -> dict[str, Entry]:
    inflected = (
        (kind, word) for kind, listing in _VERBS.items() if kind not in ("WANT", "LEAVE") for word in listing.split()
    )
    return {
        form: (kind, kind.lower())
        for kind, word in inflected
        if word not in _AS_THEY_STAND
        for form in _forms(word, kind)
    }


def _forms(verb: str, kind: str) -> Iterator[str]:
    """The regular forms of a verb: "dropped", "dropping"; "turns" of those that things do by themselves."""
    doubled = re.fullmatch(r"[^aeiou]+[aeiou][bdglmnpt]|[aeiou][bdglmnpt]", verb) is not None
    stem = verb[:-1] if verb.endswith("e") else verb + verb[-1] * doubled
    yield f"{stem}ing"
    yield f"{verb[:-1]}ied" if verb.endswith("ry") else f"{stem}ed"
    if kind in ("ROTATE", "FACE", "GIVE"):
        yield f"{verb}s"


def plural(word: str) -> str:
    """The plural of a noun that the model knows."""
    return _PLURALS.get(word, word + "s")


def _noun(words: dict[str, Entry], word: str, value: tuple[str, str]) -> None:
    words[word] = ("NOUN", (*value, False))
    words[plural(word)] = ("NOUN", (*value, True))


WORDS: dict[str, Entry] = _words()
"""Single words."""


def kind_of(word: str) -> str:
    """The kind of token that a word is; "" for one that is not known or is looked up in phrases only."""
    return WORDS.get(word, ("",))[0]


_LISTED = {"COLOUR": "colours", "PATTERN": "patterns", "MATERIAL": "materials", "SHAPE": "shapes", "NOUN": "nouns",
           "SUPER": "which of several", "ORDINAL": "which of several", "PUT": "put", "TAKE": "take", "ROTATE": "rotate", "STACK": "stack",
           "SWAP": "swap", "RETURN": "put back", "REMOVE": "remove", "PUSH": "push", "SORT": "sort", "DRAW": "draw", "WIPE": "wipe", "SHAKE": "shake", "OPEN": "open",
           "FIGURE": "figures"}  # fmt: skip


def known_words() -> dict[str, str]:
    """The words that name things and ask for something, by kind; the small words of a sentence are left out."""
    kinds: dict[str, list[str]] = {}
    for word, (kind, _) in WORDS.items():
        if kind in _LISTED:
            kinds.setdefault(_LISTED[kind], []).append(word)
    return {kind: ", ".join(sorted(words)) for kind, words in kinds.items()}


def nearest_words(unknown: Iterable[str]) -> str:
    """The known words nearest to unknown ones, and how to see all: a sentence for a refusal."""
    near = [word for item in unknown for word in get_close_matches(item, WORDS, n=2, cutoff=0.75)]
    known = f"{', '.join(dict.fromkeys(near))} (the nearest)" if near else "no word like that"
    return f"I know: {known}; `wonderful-team list words` shows all that I know."
