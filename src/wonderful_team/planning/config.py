"""How the team works: which members take part, which way of working, and every bound."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from typing import Literal, TypeAlias

from wonderful_team.agents import Prompts
from wonderful_team.errors import ConfigError, UnknownNameError

Mode: TypeAlias = Literal["lean", "paper"]
Grounding: TypeAlias = Literal["team", "supervisor", "one_call", "detector"]
"""Who says where targets are."""
GROUNDINGS: dict[Grounding, str] = {
    "team": "the grounding team: Manager, Checker and Mover",
    "supervisor": "the Supervisor: one point for each target",
    "one_call": "one model call: boxes and points of all targets in one answer, which stands",
    "detector": "a detector: its surest box for each target",
}
REPLACED: dict[Grounding, str] = {"one_call": "single-call-grounding", "detector": "detector-grounding"}
"""What the methods are called in which something else takes the place of the grounding team."""


@dataclass(frozen=True)
class Members:
    """Which members take part. `manager` False switches the whole grounding team off."""

    verification: bool = True
    manager: bool = True
    checker: bool = True
    mover: bool = True
    memory: bool = True

    @property
    def words(self) -> str:
        """What is switched off, in words: "without Verification and Checker"."""
        names = [member.name.capitalize() for member in fields(self) if not getattr(self, member.name)]
        if not names:
            return ""
        listed = " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
        return f"without {listed}" + ("" if self.manager else ": the Supervisor gives one point for each target")


ABLATIONS: dict[str, Members] = {
    "full": Members(),
    "s1": Members(verification=False),
    "s2": Members(checker=False),
    "s3": Members(verification=False, checker=False),
    "s4": Members(checker=False, mover=False),
    "s5": Members(verification=False, checker=False, mover=False),
    "s6": Members(manager=False, checker=False, mover=False),
    "s7": Members(verification=False, manager=False, checker=False, mover=False),
    "s8": Members(memory=False),
}
"""The paper's settings (Wang, Shen & Stadie 2024, arXiv:2407.19094, table "Settings Summary")."""


def members_of(setting: str) -> Members:
    """Who takes part in a setting: one of the paper's (ABLATIONS), or any combination, "-verification-mover".

    Without the Manager there are no Checker and Mover either.

    Raises:
        UnknownNameError: No such setting, an unknown member, one named twice, or members in another order than theirs: one combination has
            one name, by which studies know it.
    """
    if setting in ABLATIONS:
        return ABLATIONS[setting]
    known = [member.name for member in fields(Members)]
    off = setting.split("-")[1:]
    if not setting.startswith("-") or off != [name for name in known if name in off]:
        raise UnknownNameError("setting", setting, [*ABLATIONS, "-MEMBER-MEMBER, in this order: " + ", ".join(known)])
    if "manager" in off:
        off += ["checker", "mover"]
    return replace(Members(), **dict.fromkeys(off, False))


@dataclass(frozen=True)
class Bounds:
    """Every loop's bound (DESIGN, section 5).

    Attributes:
        questions: Doubts that Verification may raise over one plan, its steps included.
        refinements: Revisions of one box.
        new_centres: Fresh starts for one target after its box was rejected or its revisions ran out.
        returns: How often a target that is not there sends the plan back to the Supervisor.
        regrounds: How often a doubt about its point or box sends one target back to grounding.
        functions: Versions of one helper function.
        samples: Independent proposals of a centre or a spot.
        clarifications: Questions that the user answers for one plan.
        targets: Targets in one question to the grounding team; where there are more, several questions are asked at once. Fewer
            where the model takes fewer pictures.
    """

    questions: int = 10
    refinements: int = 5
    new_centres: int = 3
    returns: int = 2
    regrounds: int = 2
    functions: int = 5
    samples: int = 3
    clarifications: int = 3
    targets: int = 20


@dataclass(frozen=True)
class TeamConfig:
    """Configuration of a Team.

    Attributes:
        mode: `lean` (asks where there is doubt, in few waiting rounds) or `paper` (the algorithms as published, every round).
        ablation: Who is switched off, as `members_of` reads it.
        strict: A plan that Verification did not approve is refused.
        axes: Label the axes of whole views in `lean` too (for models that point badly).
        grounding: Who says where targets are: one of GROUNDINGS, `supervisor` only by the settings without the grounding team.
        thorough: `lean` asks every question, however plain the scene: the plan is checked by itself, every box too, and the
            steps are always written by the Supervisor. Runs of earlier releases did so.

    Raises:
        UnknownNameError: No such setting, or nobody of that name grounds.
        ConfigError: No such way of working, or a setting that switches members off that are not there.
    """

    mode: Mode = "lean"
    ablation: str = "full"
    grounding: Grounding = "team"
    strict: bool = False
    axes: bool = False
    thorough: bool = False
    bounds: Bounds = field(default_factory=Bounds)
    prompts: Prompts = field(default_factory=Prompts.default)

    def __post_init__(self) -> None:
        if self.mode not in ("lean", "paper"):
            raise ConfigError(f"way of working {self.mode!r}: valid are lean, paper")
        off = members_of(self.ablation)
        if self.grounding not in ("team", *REPLACED):
            raise UnknownNameError("grounding", self.grounding, ("team", *REPLACED))
        if self.grounding != "team" and not (off.manager and off.checker and off.mover):
            raise ConfigError(
                f"grounding {self.grounding!r} takes the place of Manager, Checker and Mover; setting {self.ablation!r} "
                "switches some of them off: choose one of the two"
            )

    @property
    def grounded_by(self) -> Grounding:
        """Who says where targets are, the settings without the grounding team counted in."""
        if self.grounding != "team":
            return self.grounding
        return "team" if self.members.manager else "supervisor"

    @property
    def name(self) -> str:
        """What the method is called."""
        named = "team" if self.mode == "lean" else f"team:{self.mode}"
        if self.grounding != "team":
            named = f"{REPLACED[self.grounding]}{named.removeprefix('team')}"
        return named if self.ablation == "full" else f"{named}:{self.ablation}"

    @property
    def sparing(self) -> bool:
        """Whether questions that a plain scene does not need are left out."""
        return self.mode == "lean" and not self.thorough

    @property
    def members(self) -> Members:
        """Who takes part."""
        members = members_of(self.ablation)
        return members if self.grounding == "team" else replace(members, manager=False, checker=False, mover=False)
