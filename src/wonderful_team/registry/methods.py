"""Methods by name: one table from a name to its factory. A rival is one file of its own and one row here; or FILE.py:NAME."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import cast

from wonderful_team.core.caps import Caps
from wonderful_team.core.protocols import Model, Policy, Subscriber
from wonderful_team.core.renamed import RenamedKeys
from wonderful_team.core.values import AskUser
from wonderful_team.errors import ConfigError, MethodCodeError, UnknownNameError
from wonderful_team.models.budget import Budget
from wonderful_team.models.client import DEADLINE_S, ModelClient
from wonderful_team.planning import ABLATIONS, TeamConfig, TeamPolicy
from wonderful_team.planning.config import Mode
from wonderful_team.registry.files import is_file_name, make_from_file
from wonderful_team.registry.models import DEFAULT_ROLE


@dataclass(frozen=True)
class TeamMode:
    """What a `team…` name means: the way of working and which members are switched off."""

    mode: Mode
    ablation: str = "full"


@dataclass(frozen=True)
class MethodSetup:
    """What a method is made from, anew for every trial.

    Attributes:
        models: By role of the team.
        rest: For roles that the team has not.
        config: How the team works; None for every other method.
        deadline_s: Longest wait for one answer, unless the model itself may take longer.
        ask: Asks the user what only the user can settle; None where nobody can be asked.
    """

    models: Mapping[str, Model]
    rest: Model
    caps: Caps = Caps()
    subscribers: Sequence[Subscriber] = ()
    concurrency: int = 8
    config: TeamConfig | None = None
    deadline_s: float = DEADLINE_S
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
    """A method: a line of help, its factory, and what its name says about the team (None for a rival)."""

    words: str
    make: Callable[[MethodSetup], Policy]
    team: TeamMode | None = None


def _team(setup: MethodSetup) -> Policy:
    """The team itself."""
    return TeamPolicy(
        setup.models,
        setup.config,
        caps=setup.caps,
        subscribers=setup.subscribers,
        concurrency=setup.concurrency,
        deadline_s=setup.deadline_s,
        ask=setup.ask,
    )


_ABLATED: tuple[tuple[str, Mode, str], ...] = (
    ("team", "lean", "the lean team in the paper's"),
    ("team:paper", "paper", "the published algorithms in"),
)
METHODS: dict[str, MethodRow] = {
    "team": MethodRow(
        "the whole team, lean: few waiting rounds, the paper's loop only for boxes that fail", _team, TeamMode("lean")
    ),
    "team:paper": MethodRow("the whole team, the algorithms as published", _team, TeamMode("paper")),
    **{
        f"{prefix}:{name}": MethodRow(
            f"{words} ablation setting {name[1:]}: {members.words}", _team, TeamMode(mode, name)
        )
        for prefix, mode, words in _ABLATED
        for name, members in ABLATIONS.items()
        if name != "full"
    },
}


def team_mode(name: str) -> TeamMode | None:
    """What a method's name says about the team; None when it names another method.

    Raises:
        UnknownNameError: Neither one of METHODS nor a file's.
    """
    if is_file_name(name):
        return None
    if name not in METHODS:
        raise UnknownNameError("method", name, [*METHODS, "FILE.py:NAME"])
    return METHODS[name].team


def make_method(name: str, setup: MethodSetup) -> Policy:
    """The method of that name, at work in one trial.

    Raises:
        ConfigError: A file's object has no `decide(situation)` or no name.
    """
    return load_method(name, setup.client()) if is_file_name(name) else METHODS[name].make(setup)


def load_method(name: str, client: ModelClient) -> Policy:
    """A method from a user's file. Its class may ask for `client` by parameter name: questions asked there are budgeted and recorded.

    Raises:
        ConfigError: The object has no `decide(situation)` or no name.
    """
    made = make_from_file(name, "method", RenamedKeys({"client": client}, {"door": "client"}), MethodCodeError)
    if not callable(getattr(made, "decide", None)):
        raise ConfigError(f"method {name!r} needs a method decide(situation); {type(made).__name__} has none")
    if not isinstance(getattr(made, "name", None), str):
        raise ConfigError(f"method {name!r} needs an attribute `name` (a string), for records and pages")
    return cast(Policy, made)
