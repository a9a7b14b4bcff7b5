"""WriteProgram: write a Python program over a few given functions that carries out an instruction, without a picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pydantic import Field

from wonderful_team.contracts.plan_from_list import SlotWords
from wonderful_team.contracts.shown import AnswerModel, Question, Reasoning
from wonderful_team.core.pictures import Point


@dataclass(frozen=True)
class ProgramFunction:
    """A function that a program may call: as it is called, and what it does."""

    signature: str
    words: str


@dataclass(frozen=True)
class ProgramRound:
    """A program that was written before, and what came of it: what it printed, or its error."""

    code: str
    said: str


class Program(AnswerModel):
    """Python source."""

    reasoning: str = Reasoning
    code: str = Field(
        description="The program. It calls the given functions; only `math` may be imported.", min_length=1
    )


@dataclass(frozen=True, eq=False)
class WriteProgram(Question):
    """Asked of a planner that is given text alone; it holds no picture.

    Attributes:
        instruction: Its words; names in braces stand for pictures.
        functions: What a program may call.
        step_kinds: What the robot can do.
        picture, size_px: The picture whose pixels positions are, by name and size.
        slot_words: What the instruction's pictures show, where nobody else can tell the program.
        rounds: Programs of this attempt, the last one last.
        example: A task and its program; "" for none.
        facts: What is known of the robot and its place.
        advice: What went wrong before.
    """

    instruction: str
    functions: tuple[ProgramFunction, ...]
    step_kinds: tuple[str, ...]
    picture: str
    size_px: tuple[int, int]
    slot_words: tuple[SlotWords, ...] = ()
    rounds: tuple[ProgramRound, ...] = ()
    example: str = ""
    facts: tuple[str, ...] = ()
    advice: tuple[str, ...] = ()

    def output(self) -> type[AnswerModel]:
        return Program

    def has(self, function: str) -> bool:
        """Whether a program may call it."""
        return any(item.signature.startswith(f"{function}(") for item in self.functions)


@dataclass(frozen=True)
class Reference:
    """A thing or a spot as a program gets at it.

    Attributes:
        query: Words for a detector, or a picture of the instruction in braces; "" for a spot.
        near: The thing meant of several is nearest to this; the surest without it [px].
        spot: A place that is no thing's [px].
        shown_in: A picture of the instruction of a whole scene: the place where it shows the thing that is moved.
    """

    query: str = ""
    near: Point | None = None
    spot: Point | None = None
    shown_in: str = ""


@dataclass(frozen=True)
class ProgramMove:
    """A thing that is carried or pushed.

    Attributes:
        place: Where to; None leaves it where it is.
        origin: It goes where `place` was at the start.
    """

    thing: Reference
    place: Reference | None
    clockwise_deg: float = 0.0
    pushed: bool = False
    origin: bool = False


def program_for(question: WriteProgram, moves: Sequence[ProgramMove], reasoning: str) -> Program:
    """The next program for these moves, in the functions that there are: for a model that plans moves and no programs.

    Where a trajectory is asked for, a first program looks at what a detector finds, as the method has it.
    """
    if not question.has("execute_trajectory"):
        return Program(
            reasoning=reasoning, code=_written(moves, "retrieve(segments, {})", "segments = segment()", _pick_place)
        )
    names = dict.fromkeys(
        one.query for move in moves for one in (move.thing, move.place) if one is not None and one.query
    )
    if not question.rounds and names:
        looks = f"for name in {list(names)!r}:\n    found = detect_object(name)\n    print(len(found), 'found:', name, found)"
        return Program(reasoning=f"First I look. {reasoning}", code=looks)
    code = _written(moves, "detect_object({})", "import math", _trajectory)
    return Program(reasoning=reasoning, code=f"{code}\ntask_completed()")


_NEAREST = """
def nearest(found, x, y):
    return min(found, key=lambda one: (one["x"] - x) ** 2 + (one["y"] - y) ** 2)
""".strip()


def _written(
    moves: Sequence[ProgramMove], look: str, first: str, motion: Callable[[str, str, str, ProgramMove], list[str]]
) -> str:
    lines, names, now = [first], dict[tuple[Reference, str], str](), dict[str, str]()
    if any(one is not None and one.near is not None for move in moves for one in (move.thing, move.place)):
        lines.append(_NEAREST)

    def named(one: Reference, thing: str = "") -> str:
        key = (one, thing if one.shown_in else "")
        if key not in names:
            names[key] = f"t{len(names) + 1}"
            found = look.format(repr(one.query))
            if one.spot is not None:
                value = f"({one.spot[0]:.0f}, {one.spot[1]:.0f})"
            else:
                found = f"retrieve(segment({one.shown_in!r}), {thing}_box)" if one.shown_in else found
                best = f"{found}[0]" if one.near is None else f"nearest({found}, {one.near[0]:.0f}, {one.near[1]:.0f})"
                lines.append(f"{names[key]}_box = {best}")
                value = f"({names[key]}_box['x'], {names[key]}_box['y'])"
            lines.append(f"{names[key]} = {value}")
        return names[key]

    for move in moves:
        thing = named(move.thing)
        place = thing if move.place is None else named(move.place, thing)
        start = now.get(thing, thing)
        end = start if move.place is None else place if move.origin else now.get(place, place)
        lines += motion(thing, start, end, move)
        now[thing] = end
    return "\n".join(lines)


def _trajectory(thing: str, start: str, end: str, move: ProgramMove) -> list[str]:
    turn = f"{move.clockwise_deg:g}"
    if move.pushed:
        return [
            f"way = math.hypot({end}[0] - {start}[0], {end}[1] - {start}[1]) or 1",
            f"ux, uy = ({end}[0] - {start}[0]) / way, ({end}[1] - {start}[1]) / way",
            f"half = {thing}_box['length'] / 2",
            f"a = ({start}[0] - ux * half * 1.4, {start}[1] - uy * half * 1.4)",
            f"b = ({end}[0] - ux * half, {end}[1] - uy * half)",
            "execute_trajectory([(*a, 15, 0), (*a, 0, 0), (*b, 0, 0), (*b, 15, 0)])",
        ]
    return [
        f"execute_trajectory([(*{start}, 15, 0), (*{start}, 0, 0)])",
        "close_gripper()",
        f"execute_trajectory([(*{start}, 15, 0), (*{end}, 15, {turn}), (*{end}, 0, {turn})])",
        "open_gripper()",
    ]


def _pick_place(thing: str, start: str, end: str, move: ProgramMove) -> list[str]:
    return [f"pick_place({start}, {end}, {move.clockwise_deg:g})"]
