"""How the team works: which members take part, which way of working, and every bound."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Literal, TypeAlias

from wonderful_team.agents import Prompts
from wonderful_team.errors import ConfigError, UnknownNameError

Mode: TypeAlias = Literal["lean", "paper"]


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
        if not self.manager:
            members = (
                "Verification, Manager, Checker and Mover" if not self.verification else "Manager, Checker and Mover"
            )
            return f"without {members}: the Supervisor gives one point for each target"
        names = [member.name.capitalize() for member in fields(self) if not getattr(self, member.name)]
        return (
            "without " + " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names) if names else ""
        )


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
    """

    questions: int = 10
    refinements: int = 5
    new_centres: int = 3
    returns: int = 2
    regrounds: int = 2
    functions: int = 5
    samples: int = 3
    clarifications: int = 3


@dataclass(frozen=True)
class TeamConfig:
    """Configuration of a Team.

    Attributes:
        mode: `lean` (asks where there is doubt, in few waiting rounds) or `paper` (the algorithms as published, every round).
        ablation: A name of SETTINGS.
        strict: A plan that Verification did not approve is refused.
        axes: Label the axes of whole views in `lean` too (for models that point badly).
        thorough: `lean` asks every question, however plain the scene: the plan is checked by itself, every box too, and the
            steps are always written by the Supervisor. Runs of earlier releases did so.

    Raises:
        UnknownNameError: No such setting.
        ConfigError: No such way of working.
    """

    mode: Mode = "lean"
    ablation: str = "full"
    strict: bool = False
    axes: bool = False
    thorough: bool = False
    bounds: Bounds = field(default_factory=Bounds)
    prompts: Prompts = field(default_factory=Prompts.default)

    def __post_init__(self) -> None:
        if self.mode not in ("lean", "paper"):
            raise ConfigError(f"way of working {self.mode!r}: valid are lean, paper")
        if self.ablation not in ABLATIONS:
            raise UnknownNameError("setting", self.ablation, ABLATIONS)

    @property
    def sparing(self) -> bool:
        """Whether questions that a plain scene does not need are left out."""
        return self.mode == "lean" and not self.thorough

    @property
    def members(self) -> Members:
        return ABLATIONS[self.ablation]
