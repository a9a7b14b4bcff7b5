"""Methods by name: the team's ways of working, and methods from a file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, cast

from wonderful_team.core.protocols import Policy
from wonderful_team.core.renamed import RenamedKeys
from wonderful_team.errors import ConfigError, MethodCodeError, UnknownNameError
from wonderful_team.registry.files import is_file_name, make_from_file

if TYPE_CHECKING:
    from wonderful_team.models.client import ModelClient


ABLATIONS = tuple(f"s{number}" for number in range(1, 9))
METHODS: dict[str, str] = {
    "team": "the whole team, lean: few waiting rounds, the paper's loop only for boxes that fail",
    "team:paper": "the whole team, the algorithms as published",
    **{f"team:{name}": f"the lean team in the paper's ablation setting {name[1:]}" for name in ABLATIONS},
    **{f"team:paper:{name}": f"the published algorithms in ablation setting {name[1:]}" for name in ABLATIONS},
}


@dataclass(frozen=True)
class TeamMode:
    """What a `team…` name means: the way of working and which members are switched off."""

    mode: Literal["lean", "paper"]
    ablation: str


def team_mode(name: str) -> TeamMode | None:
    """What a method's name says about the team; None when it does not name the team.

    Raises:
        UnknownNameError: It starts with "team" but is not one of METHODS.
    """
    if is_file_name(name):
        return None
    if name not in METHODS:
        raise UnknownNameError("method", name, [*METHODS, "FILE.py:NAME"])
    words = name.split(":")
    ablation = words[-1] if words[-1] in ABLATIONS else "full"
    return TeamMode("paper" if "paper" in words else "lean", ablation)


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
