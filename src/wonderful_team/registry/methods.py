"""Methods by name: the team's ways of working, and methods from a file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, cast

from wonderful_team.core.protocols import Policy
from wonderful_team.errors import ConfigError, MethodCodeError, UnknownNameError
from wonderful_team.registry.files import is_file_name, make_from_file

if TYPE_CHECKING:
    from wonderful_team.models.door import Door


SETTINGS = tuple(f"s{number}" for number in range(1, 9))
METHODS: dict[str, str] = {
    "team": "the whole team, lean: few waiting rounds, the paper's loop only for boxes that fail",
    "team:paper": "the whole team, the algorithms as published",
    **{f"team:{name}": f"the lean team in the paper's ablation setting {name[1:]}" for name in SETTINGS},
    **{f"team:paper:{name}": f"the published algorithms in ablation setting {name[1:]}" for name in SETTINGS},
}


@dataclass(frozen=True)
class TeamWay:
    """What a `team…` name means: the way of working and which members are switched off."""

    way: Literal["lean", "paper"]
    setting: str


def team_way(name: str) -> TeamWay | None:
    """What a method's name says about the team; None when it does not name the team.

    Raises:
        UnknownNameError: It starts with "team" but is not one of METHODS.
    """
    if is_file_name(name):
        return None
    if name not in METHODS:
        raise UnknownNameError("method", name, [*METHODS, "FILE.py:NAME"])
    words = name.split(":")
    setting = words[-1] if words[-1] in SETTINGS else "full"
    return TeamWay("paper" if "paper" in words else "lean", setting)


def load_method(name: str, door: Door) -> Policy:
    """A method from a user's file. Its class may ask for `door` by parameter name: questions asked there are budgeted and recorded.

    Raises:
        ConfigError: The object has no `decide(situation)` or no name.
    """
    made = make_from_file(name, "method", {"door": door}, MethodCodeError)
    if not callable(getattr(made, "decide", None)):
        raise ConfigError(f"method {name!r} needs a method decide(situation); {type(made).__name__} has none")
    if not isinstance(getattr(made, "name", None), str):
        raise ConfigError(f"method {name!r} needs an attribute `name` (a string), for records and pages")
    return cast(Policy, made)
