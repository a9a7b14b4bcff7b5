"""Phrases of several words that mean one thing, and the kind of token that each is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

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
            phrases += [
                f"{to} {it} {was}"
                for to in ("where", "to where", "back to where", "back where", "to how", "back to how")
            ]
    return phrases


_ROWS = {"topmost": ("top", "upper", "back", "far"), "bottommost": ("bottom", "lower", "front", "near")}
_COLUMNS = {"leftmost": ("left", "left hand"), "rightmost": ("right", "right hand")}


def _corner_phrases(rows: Sequence[str], columns: Sequence[str]) -> list[str]:
    """Ways of naming one corner."""
    named = [name for row in rows for column in columns for name in (f"{row} {column}", f"{column} {row}")]
    ends = [f"{name} {end}" for name in named for end in ("corner", "hand corner")]
    return [*named, *ends, *(f"corner {at} {name}" for name in named for at in ("at", "in", "on", "to"))]


def _side_phrases(side: str) -> Iterator[tuple[Entry, str]]:
    """Ways of saying "left of" and "on the left", or the same of the right."""
    for place in ("", "on ", "at ", "to "):
        yield from (((f"{side.upper()}_OF", side), f"{place}{side} {end}") for end in ("of", "from"))
    for place in ("on", "at", "to", "towards", "toward"):
        yield from (((f"{side.upper()}_OF", side), f"{place} {side} {hand}side of") for hand in ("", "hand "))
        yield from (
            (("SIDE_POST", f"{side}most"), f"{place} {side}{end}") for end in ("", " side", " hand side", " edge")
        )
    for far in "far;on far;at far;on very;at very;furthest;farthest;furthest to;farthest to;to its".split(";"):
        yield ("SIDE_POST", f"{side}most"), f"{far} {side}"
    yield ("SIDE_POST", f"{side}most"), f"{side}wards"


def _all_phrases() -> Iterator[tuple[Entry, str]]:
    for entry, listing in _LISTED.items():
        yield from ((entry, words.strip()) for words in listing.split(";"))
    for row, rows in _ROWS.items():
        for column, columns in _COLUMNS.items():
            yield from ((("CORNER", (row, column)), words) for words in _corner_phrases(rows, columns))
    yield from ((("ORIGIN", "origin"), words) for words in _origin_phrases())
    for verb in ("trade", "change", "switch", "swap", "exchange", "interchange"):
        for what in ("places", "positions", "places of", "positions of"):
            yield ("SWAP", "swap"), f"{verb} {what}"
    for side in ("left", "right"):
        yield from _side_phrases(side)


_LISTED: dict[Entry, str] = {
    ("LEFT_OF", "left"): "west of; to west of",
    ("RIGHT_OF", "right"): "east of; to east of",
    ("ABOVE", "above"): "north of; at back of; to north of; further up than; on far side of; in back of",
    ("BELOW", "below"): "in front of; south of; to south of; to front of; on near side of",
    ("NEAR", "near"): """
    next to; close to; adjacent to; right next to; by side of; at side of; to side of; near to; right beside; right by; close by; directly
    next to; directly beside; immediately beside; just beside; on side of; directly adjacent to""",
    ("INTO", "into"): """
    in to; into inside of; into middle of; into centre of; over into; into center of; to inside of; to middle of; to
    centre of; to center of; down into; back into""",
    ("ONTO", "onto"): "on to; to top of; onto top of; onto middle of; over onto",
    ("TO", "to"): "over to; up to; all way to; right up to",
    ("FAR", "far"): "far from; far away from; away from",
    ("ON", "on"): "on top of; over top of",
    ("IN", "in"): "inside of; in middle of; in centre of; in center of; at centre of; at center of; at middle of",
    ("SIDE_POST", "topmost"): """
    at top; on top; at back; in back; at very top; furthest up; at top edge; upwards; nearest to top""",
    ("SIDE_POST", "bottommost"): """
    at bottom; on bottom; at front; in front; downwards; at very bottom; furthest down; at bottom edge; nearest to
    bottom""",
    ("SIDE_POST", "middle"): """
    to centre of table; to center of table; to middle of table; in centre of table; in center of table; in middle of
    table; at centre of table; at center of table; at middle of table; on middle of table; into middle of table; into
    centre of table; into center of table; to middle; to centre; to center; in middle; in centre; in center; at centre;
    at center; in between others""",
    ("SUPER", "leftmost"): "left most",
    ("SUPER", "rightmost"): "right most",
    ("SUPER", "topmost"): "top most",
    ("SUPER", "bottommost"): "bottom most",
    ("SUPER", "column by column"): "counted column by column from top left; counted column by column",
    ("SUPER", "row by row"): "counted row by row from top left; counted row by row",
    ("BETWEEN", "between"): """
    in between; in gap between; in space between; into gap between; into space between; halfway between;
    midway between; in middle between; in middle , between; right between""",
    ("TAKE", "take"): """
    pick up; round up; take hold of; look for; take up; get hold of; lift up; start with; begin with""",
    ("WANT", "want"): """
    i want; i would like; i d like; i want you to have; see to it that; make sure that; make sure; ensure that; ensure;
    i wish; we want; time for; it is time for; i need; we need; i would love; be sure that; i d love""",
    ("PUT", "put"): "put down; set down; place down; lay down; drop off; let go of",
    ("AUX", "aux"): """
    has to be; have to be; needs to be; need to be; is to be; are to be; ought to be; should end up; must end up; should
    be; must be; must go; should go; needs to go; has to go; have to go; need to go; is supposed to go; is supposed to
    be; is to go; are to go; to be; ends up; end up; to go; to end up; supposed to be; needs; has to; need to; needs to;
    belongs; finish up; finishes up; wind up; winds up; should sit; should lie; must lie; should rest; to rest; to sit; to lie; to become; rest; rests; sit; sits;
    to stand""",
    ("SKIP", "skip"): """
    in place; on spot; where it is; where it stands; where it lies;
    at its place; in its place; at its current position; 
    as follows; make it so; make it so that; if possible; of your choice; from now on; as it is; out of way;
    and let go; without moving it; without lifting it; without changing its position; keeping it in place;
    without moving it away; keeping its position; together; what about; how about; it would be nice to have;
    would be nice if; in end; at end; as first step; as last step; to start with; to begin with; as first thing; as last thing;
    task; for me; on its own; for now; right now; at once; one after other;
    one after another; one by one; in any order; following; as it stands; over there""",
    ("BY", "by"): "by angle of; through angle of; by total of",
    ("ROTATE", "rotate"): "change orientation of; re orient; turn around; turn round; rotate around; spin around",
    ("NOUN", ("area", "", False)): "sheet of paper; piece of paper; patch of paper",
    ("NOUN", ("fruit", "", False)): "piece of fruit",
    ("NOUN", ("fruit", "", True)): "pieces of fruit",
    ("STACK", "stack"): "pile up; stack up",
    ("SORT", "sort"): "sort out; bring together; put together",
    ("TURN", -1.0): """
    counter clockwise; anti clockwise; against clock; opposite to clockwise; in counterclockwise direction; in
    anticlockwise direction; in counter clockwise direction; in anti clockwise direction""",
    ("TURN", 1.0): "in clockwise direction; clock wise",
    ("ANGLE", 90.0): """
    quarter turn; quarter of turn; right angle; quarter rotation; quarter of full turn; one quarter turn; quarter of
    rotation; quarter""",
    ("ANGLE", 180.0): """
    upside down; half turn; half rotation; half of turn; one half turn; half way round; halfway round; halfway around""",
    ("ANGLE", 270.0): "three quarter turn; three quarters of turn; three quarters turn",
    ("ANGLE", 120.0): "third of turn; one third of turn; third of full turn; third of rotation",
    ("ANGLE", 240.0): "two thirds of turn; two thirds of rotation; two thirds of full turn",
    ("ANGLE", 60.0): "sixth of turn; one sixth of turn; sixth of full turn",
    ("SAMEANGLE", None): """
    that much; by that much; same amount; same angle; as much; that angle; angle; that amount; much; just as far; as
    far; equally far; same way; likewise; same extent; amount; exactly that much; given angle; just as much""",
    ("OPPOSITE", 180.0): """
    other way; other way round; other way around; opposite direction; opposite way; other direction; in opposite
    direction; in other direction; reverse direction; opposite side; other side; in reverse direction; to opposite side;
    reverse of its direction; to other side""",
    ("SWAP", "swap"): """
    swap round; swap around; switch around; take each other s place; take each others places;
    take each other s places""",
    ("REMOVE", "remove"): """
    get rid of; take away; clear away; clear; put away; put aside; set aside; move aside; move out of way; take out;
    take off""",
    ("PLACE_OF", "place"): """
    place of; right place of; right place for; place for; home of; destination of; destination for; proper place of;
    proper place for; target of; spot for""",
    ("ON_TABLE", "table"): """
    on wrong place; in wrong place; at wrong place; in wrong spot; not where it should be; on table; of table; on desk;
    on workspace; in workspace; on surface; in scene; on tabletop; from table; in view; off table; on work surface; on
    work area; in front of you; you see; you can see; you find; that you see; that you can see; there is; there are""",
    ("EXCEPT", "except"): """
    except for; apart from; other than; but not; with exception of; save for; aside from; all but not; not including;
    leaving out; leave out; just not; without counting; though not; not counting; but for""",
    ("OFF", "off"): "out of; off of; away off; from out of; off from",
    ("ONE_OF", 1.0): "one of; any one of; any of; single one of; either of; just one of; exactly one of",
    ("OF_TWO", 2): "of two; of both; out of two",
    ("OF_TWO", 3): "of three; out of three",
    ("OF_TWO", 1): "among; of all; out of all",
    ("ACCORDING", "according"): """
    according to; depending on; in accordance with; as determined by; on basis of; based on; with regard to; with
    respect to""",
    ("ANGLE", 45.0): "eighth of turn; one eighth of turn; eighth turn",
    ("ANGLE", 360.0): "full turn; complete turn; one full turn; full rotation",
    ("ORIGIN", "origin"): """
    home; home again; back again; back home; back there; back to start; to its home; to start;
    back to its home; back to its place; back to its origin; to its origin; back in its place""",
    ("SHAPE", ("l-shape", False)): "l shaped; l shape; shape of l; shape of letter l",
    ("SHAPED", "shaped"): "shaped; shaped like; in shape of; formed like; with shape of",
    ("PATTERN", "checkered"): "checker board; chess board",
    ("PATTERN", "dotted"): "polka dot; polka dots; polka dotted",
    ("PATTERN", "multicoloured"): "multi coloured; multi colored; many coloured",
    ("LIKE", "like"): """
    looks like; look like; looking like; that looks like; which looks like; same as; identical to; similar to; as shown
    in; shown in; shown by; pictured in; depicted in; from picture; of picture; in picture; shown as; that is shown in;
    seen in; like one in; as in; displayed in; appearing in; that appears in; matching picture; resembling; that
    resembles; illustrated in; visible in""",
    ("EACH", "each"): """
    each of; every one of; each one of; every single; each single; every single one of; every last; each and every""",
    ("ALL", "all"): "all of; all; all existing",
    ("ALL", 2): "both of; both",
    ("THEY", "they"): "they all; they both",
    ("EVERYTHING", "everything"): "every thing; all things",
    ("AND", "and"): "along with; together with; as well as; plus",
    ("THEN", "then"): """
    and then; after that; and after that; next; followed by; and afterwards; and finally; finally; before you; and
    subsequently; once that is done; when that is done; and next; and lastly; after which; as second step; at last; and
    at last; last of all""",
}
"""Phrases by what they mean, without their articles."""
PHRASES: dict[tuple[str, ...], Entry] = {
    tuple(word for word in words.split() if word not in ARTICLES): entry for entry, words in _all_phrases()
}
"""Phrases of several words; the longest that fits wins. Articles inside them are optional."""
