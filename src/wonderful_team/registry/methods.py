"""Methods by name: one table from a name to its factory. A rival is one file of its own and one row here; or FILE.py:NAME."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import cast

from wonderful_team.agents.prompts import ROLES, role_names
from wonderful_team.agents.role import Role
from wonderful_team.core.caps import Caps
from wonderful_team.core.protocols import Detector, Model, Policy, Subscriber, World
from wonderful_team.core.renamed import RenamedKeys
from wonderful_team.core.values import AskUser
from wonderful_team.errors import ConfigError, MethodCodeError, UnknownNameError
from wonderful_team.models.budget import Budget
from wonderful_team.models.client import DEADLINE_S, ModelClient
from wonderful_team.planning import ABLATIONS, TeamConfig, TeamPolicy, members_of
from wonderful_team.planning.baselines import direct, instruct2act, moka, nlap, pivot, point, shown, tg
from wonderful_team.planning.config import Grounding, Members, Mode
from wonderful_team.registry.detectors import make_classifier, make_detector
from wonderful_team.registry.files import is_file_name, make_from_file
from wonderful_team.registry.models import DEFAULT_ROLE
from wonderful_team.registry.told import teller


@dataclass(frozen=True)
class TeamMode:
    """What a `team…` name means: the way of working, which members are switched off, and who says where targets are."""

    mode: Mode
    ablation: str = "full"
    grounding: Grounding = "team"


@dataclass(frozen=True)
class MethodSetup:
    """What a method is made from, anew for every trial.

    Attributes:
        models: By role of the team.
        rest: For roles that the team has not.
        config: How the team works; None for every other method.
        deadline_s: Longest wait for one answer, unless the model itself may take longer.
        detector: Makes the detector that was named, for methods that look with one; weights are loaded once.
        world: Given to methods marked PRIVILEGED alone, which are told of its truth.
        ask: Asks the user what only the user can settle; None where nobody can be asked.
    """

    models: Mapping[str, Model]
    rest: Model
    caps: Caps = Caps()
    subscribers: Sequence[Subscriber] = ()
    concurrency: int = 8
    config: TeamConfig | None = None
    deadline_s: float = DEADLINE_S
    detector: Callable[[], Detector] = make_detector
    world: World | None = None
    ask: AskUser | None = None

    def client(self) -> ModelClient:
        """Where a method asks its models: capped, and told to subscribers."""
        models = {DEFAULT_ROLE: self.rest, **self.models}
        return ModelClient(
            models,
            budget=Budget(self.caps),
            subscribers=self.subscribers,
            concurrency=self.concurrency,
            deadline_s=self.deadline_s,
        )


@dataclass(frozen=True)
class MethodRow:
    """A method by name.

    Attributes:
        words: A line of help.
        make: Its factory.
        team: What its name says about the team; None for a rival.
        roles: A rival's own roles; () where it does not say.
        privileged: It is told of a simulator's truth.
        detects: It looks with a detector (`--detector`).
        plans: It can be run in a world; what only says where things are answers the suites `pointing` and `boxcheck`, and photos.
    """

    words: str
    make: Callable[[MethodSetup], Policy]
    team: TeamMode | None = None
    roles: tuple[Role, ...] = ()
    privileged: bool = False
    detects: bool = False
    plans: bool = True


def _team(setup: MethodSetup) -> Policy:
    """The team itself."""
    return TeamPolicy(
        setup.models,
        setup.config,
        caps=setup.caps,
        subscribers=setup.subscribers,
        concurrency=setup.concurrency,
        deadline_s=setup.deadline_s,
        detector=setup.detector() if setup.config is not None and setup.config.grounding == "detector" else None,
        ask=setup.ask,
    )


def _direct(words: str, axes: bool, checked: bool) -> MethodRow:
    return MethodRow(
        words, lambda setup: direct.Direct(setup.client(), axes=axes, checked=checked), roles=(direct.PLANNER,)
    )


_LISTS: tuple[tuple[str, str, bool, bool], ...] = (
    (
        "nlap",
        "the model lists objects, then plans in natural language with pictures (NLaP, arXiv 2403.13801)",
        True,
        False,
    ),
    ("nlap:text", "NLaP: the model lists objects, then plans from the words alone", False, False),
    (
        "nlap:privileged",
        "PRIVILEGED: NLaP, told a simulator's true object names and positions; no picture",
        False,
        True,
    ),
)


def _nlap(name: str, words: str, pictures: bool, privileged: bool, thoughts: bool) -> MethodRow:
    def make(setup: MethodSetup) -> Policy:
        tell = teller(setup.world, name) if privileged else None
        return nlap.Nlap(setup.client(), name, pictures=pictures, thoughts=thoughts, tell=tell)

    roles = (nlap.REASONER,) if privileged else (nlap.EXTRACTOR, nlap.REASONER)
    words += "" if thoughts else "; no chain of thought"
    return MethodRow(words, make, roles=roles, privileged=privileged)


_ABLATED: tuple[tuple[str, Mode, str], ...] = (
    ("team", "lean", "the lean team in the paper's"),
    ("team:paper", "paper", "the published algorithms in"),
)
METHODS: dict[str, MethodRow] = {
    "team": MethodRow(
        "the whole team, lean: few waiting rounds, the paper's loop only for boxes that fail", _team, TeamMode("lean")
    ),
    "team:paper": MethodRow("the whole team, the algorithms as published", _team, TeamMode("paper")),
    "single-call-grounding": MethodRow(
        "the team, the grounding team replaced by one model call that gives all boxes and points",
        _team,
        TeamMode("lean", grounding="one_call"),
    ),
    "detector-grounding": MethodRow(
        "the team, the grounding team replaced by a detector (--detector)",
        _team,
        TeamMode("lean", grounding="detector"),
        detects=True,
    ),
    **{
        f"{prefix}:{name}": MethodRow(
            f"{words} ablation setting {name[1:]}: {members.words}", _team, TeamMode(mode, name)
        )
        for prefix, mode, words in _ABLATED
        for name, members in ABLATIONS.items()
        if name != "full"
    },
    "direct": _direct("one model, one call: plan and points together; no team", False, False),
    "direct:axes": _direct("the same, with labelled axes on the main view", True, False),
    "direct:checked": _direct("direct; the model looks at its drawn plan, and may plan anew twice", False, True),
    "direct:axes:checked": _direct("the same, with labelled axes on the main view", True, True),
    "point": MethodRow(
        "one question a thing, and no plan: for the suites pointing and boxcheck, and for photos",
        lambda setup: point.PointAlone(setup.client()),
        roles=(point.POINTER,),
        plans=False,
    ),
    "point:axes": MethodRow(
        "the same with labelled axes",
        lambda setup: point.PointAlone(setup.client(), axes=True),
        roles=(point.POINTER,),
        plans=False,
    ),
    **{
        name: MethodRow(
            f"for the suite annotations: one question a picture, {how} what the team draws or cuts out",
            lambda setup, annotated=annotated: shown.ShownWith(setup.client(), annotated=annotated),  # type: ignore[misc]
            roles=(shown.VIEWER,),
            plans=False,
        )
        for name, how, annotated in (("annotated", "with", True), ("bare", "without", False))
    },
    "pivot": MethodRow(
        "points found among numbered marks in 3 iterations and 3 parallel runs (PIVOT, arXiv 2402.07872)",
        lambda setup: pivot.Pivot(setup.client()),
        roles=(pivot.PLANNER, pivot.SELECTOR),
    ),
    "tg": MethodRow(
        "a model without pictures asks a detector by name and writes programs (Trajectory Generators, arXiv 2310.11604)",
        lambda setup: tg.TrajectoryGenerator(setup.client(), setup.detector()),
        roles=(tg.DESCRIBER, tg.PROGRAMMER),
        detects=True,
    ),
    "moka": MethodRow(
        "things by name through a detector, motions by marks on the picture (MOKA, arXiv 2403.03174)",
        lambda setup: moka.Moka(setup.client(), setup.detector()),
        roles=(moka.DECOMPOSER, moka.MARKER),
        detects=True,
    ),
    "instruct2act": MethodRow(
        "one program over a segmenter and a classifier, written without a picture (Instruct2Act, arXiv 2305.11176)",
        lambda setup: instruct2act.Instruct2Act(setup.client(), setup.detector(), make_classifier()),
        roles=(instruct2act.CODER,),
        detects=True,
    ),
    **{
        (full := name + ("" if thoughts else ":no-cot")): _nlap(full, words, pictures, privileged, thoughts)
        for name, words, pictures, privileged in _LISTS
        for thoughts in (True, False)
    },
}


def method_row(name: str) -> MethodRow | None:
    """The row of a method: one of METHODS, or a team without some members, as in "team:-verification-mover"; None for any other name.

    Raises:
        UnknownNameError: A team without members that there are not.
    """
    if name in METHODS:
        return METHODS[name]
    base, dash, off = name.partition(":-")
    row = METHODS.get(base)
    if not dash or row is None or row.team is None or row.team.ablation != "full":
        return None
    members = members_of(f"-{off}")
    return replace(row, words=f"{base} {members.words}", team=replace(row.team, ablation=f"-{off}"))


EACH = ":-each"
"""After the name of a whole team: that team, and it without each member in turn."""


def each_member(names: Sequence[str]) -> list[str]:
    """Names of methods, with "team:-each" and "team:paper:-each" written out; each method once where it comes so."""
    found: list[str] = []
    for name in names:
        base = name.removesuffix(EACH)
        row = METHODS.get(base)
        if (
            base == name
            or row is None
            or row.team is None
            or row.team.ablation != "full"
            or row.team.grounding != "team"
        ):
            found.append(name)
            continue
        written = [base, *(f"{base}:-{member.name}" for member in fields(Members))]
        found += [one for one in written if one not in (*found, *names)]
    return found


def known_row(name: str) -> MethodRow:
    """The same.

    Raises:
        UnknownNameError: No such method.
    """
    row = method_row(name)
    if row is None:
        raise UnknownNameError("method", name, [*METHODS, "team:-MEMBER-MEMBER", "team:-each", "FILE.py:NAME"])
    return row


def roles_of(method: str) -> tuple[str, ...]:
    """Whom a method asks as: the roles that can have a model of their own. One that does not say, as the user's own, may ask as any."""
    row = method_row(method)
    if row is not None and row.team is not None:
        return role_names()
    return tuple(role.name for role in row.roles) if row is not None and row.roles else all_roles()


def all_roles() -> tuple[str, ...]:
    """Every role of the team, then those of rivals."""
    rivals = (role.name for row in METHODS.values() for role in row.roles)
    return tuple(dict.fromkeys((*role_names(), *rivals)))


def grounding_roles(method: str) -> tuple[str, ...]:
    """Those of a method's roles that find targets in pictures; the others plan."""
    row = method_row(method)
    roles = ROLES.values() if row is None or row.team is not None else row.roles
    return tuple(role.name for role in roles if role.grounds)


def check_roles(method: str, named: Iterable[str]) -> None:
    """Whether a method has these roles.

    Raises:
        UnknownNameError: It has not; lists those that it has.
    """
    known = roles_of(method)
    for role in named:
        if role not in (*known, DEFAULT_ROLE):
            raise UnknownNameError(f"role of method {method!r}", role, known)


def looks_with_detector(name: str) -> bool:
    """Whether a method looks with a detector; one of the user's own may."""
    row = method_row(name)
    return row is None or row.detects


def team_mode(name: str) -> TeamMode | None:
    """What a method's name says about the team; None when it names another method.

    Raises:
        UnknownNameError: Neither a method nor a file's.
    """
    return None if is_file_name(name) else known_row(name).team


def make_method(name: str, setup: MethodSetup) -> Policy:
    """The method of that name, at work in one trial.

    Raises:
        ConfigError: A file's object has no `decide(situation)` or no name.
    """
    if is_file_name(name):
        return load_method(name, setup.client(), setup.detector)
    return known_row(name).make(setup)


def load_method(name: str, client: ModelClient, detector: Callable[[], Detector] = make_detector) -> Policy:
    """A method from a user's file. Its class may ask by parameter name for `client`, where questions are budgeted and recorded, and
    for `make_detector`, a function that gives the chosen detector.

    Raises:
        ConfigError: The object has no `decide(situation)` or no name.
    """
    made = make_from_file(
        name, "method", RenamedKeys({"client": client, "make_detector": detector}, {"door": "client"}), MethodCodeError
    )
    if not callable(getattr(made, "decide", None)):
        raise ConfigError(f"method {name!r} needs a method decide(situation); {type(made).__name__} has none")
    if not isinstance(getattr(made, "name", None), str):
        raise ConfigError(f"method {name!r} needs an attribute `name` (a string), for records and pages")
    return cast(Policy, made)
