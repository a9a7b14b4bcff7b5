"""Options that several commands share, and how their words become values."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, TypeVar

import click

from wonderful_team.core.deadline import limited
from wonderful_team.errors import ConfigError
from wonderful_team.registry.role_models import read_roles

THOROUGH = "The team asks every question, however plain the scene: dearer, for models that see badly."
"""Help of --thorough."""
Command = TypeVar("Command", bound=Callable[..., Any])


class NamedPath(click.Path):
    """A path that names something: an empty one would mean the working directory."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "":
            self.fail("an empty path names no file and no folder", param, ctx)
        return super().convert(value, param, ctx)


PATH = NamedPath(path_type=Path)
LOCAL_ONLY = click.option("--local-only", is_flag=True, help="Refuse models outside this machine and private networks.")
TIMEOUT = click.option(
    "--timeout",
    type=click.FloatRange(0, min_open=True),
    metavar="S",
    help="Longest wait for one reply of a model. [default: 150 s, thinking 300 s; more for a service that shows to be slow]",
)
ENCODING = click.option(
    "--encoding",
    type=click.Choice(["auto", "png", "jpeg"]),
    default="auto",
    show_default=True,
    help="Files that pictures are sent as; auto: JPEG for photos without tick labels, else PNG.",
)
CACHE = click.option(
    "--cache",
    type=click.Choice(["on", "off", "only"]),
    help="Keep answers; only: never call a model. [default: on for vendors and servers, else off]",
)
CACHE_FILE = click.option(
    "--cache-file", type=PATH, metavar="FILE", help="Where answers are kept. [default: user's cache]"
)


@dataclass(frozen=True)
class Common:
    """What every planning command takes.

    Attributes:
        command: The words that reproduce the run.
        model: One name, or a name for each role ("*" for the rest).
        thinking, price: By role, "*" for the rest.
        caps: Those of max_calls, max_tokens, max_seconds, max_usd that were given.
    """

    model: str | Mapping[str, str]
    thinking: Mapping[str, str]
    price: Mapping[str, str]
    allow_unpriced: bool
    local_only: bool
    timeout: float | None
    encoding: str
    method: str
    detector: str | None
    caps: Mapping[str, float]
    concurrency: int
    cache: str | None
    cache_file: Path | None
    prompts: Path | None
    out: Path | None
    as_json: bool
    open_page: bool
    strict: bool
    thorough: bool
    command: str

    def team_arguments(self) -> dict[str, Any]:
        """Keyword arguments of `wonderful_team.Team`."""
        held = {item.name: getattr(self, item.name) for item in fields(self)}
        return {**{name: value for name, value in held.items() if name not in _NOT_OF_TEAM}, **self.caps}


_NOT_OF_TEAM = ("caps", "as_json", "open_page")


def common(command: Command) -> Callable[..., Any]:
    """Give a command the common options; it receives them as one `Common` named `common`."""

    def gathered(**values: Any) -> Any:
        caps = {key: values.pop(key) for key in ("max_calls", "max_tokens", "max_seconds", "max_usd")}
        values |= {
            "model": read_models(values["model"]),
            "thinking": read_roles(values["thinking"], "--thinking", "LEVEL"),
            "price": read_roles(values["price"], "--price", "IN,OUT"),
            "caps": {key: value for key, value in caps.items() if value is not None},
            "command": shlex.join(["wonderful-team", *(click.get_current_context().obj or ())]),
        }
        shared = Common(**{item.name: values.pop(item.name) for item in fields(Common)})
        with limited(caps["max_seconds"]):
            return command(common=shared, **values)

    gathered.__doc__ = command.__doc__
    gathered.__name__ = command.__name__
    # click keeps the parameters of the decorators below the command on the function.
    gathered.__click_params__ = getattr(command, "__click_params__", [])  # type: ignore[attr-defined]
    for option in reversed(_COMMON):
        gathered = option(gathered)
    return gathered


_COMMON: tuple[Callable[[Any], Any], ...] = (
    click.option(
        "--model",
        multiple=True,
        metavar="M|ROLE=M",
        help="offline (default), VENDOR:NAME, http://HOST:8000/v1[#NAME], a probed name or FILE.py:NAME (see "
        "`list models`); ROLE=M for one role; may be repeated.",
    ),
    click.option(
        "--thinking",
        multiple=True,
        metavar="LEVEL|ROLE=LEVEL",
        help="off, low, medium or high; may be repeated. [default: the model's own]",
    ),
    click.option(
        "--price",
        multiple=True,
        metavar="IN,OUT|ROLE=IN,OUT",
        help="USD per million tokens, for models without a price.",
    ),
    click.option("--allow-unpriced", is_flag=True, help="Accept models of unknown price without --max-tokens."),
    LOCAL_ONLY,
    TIMEOUT,
    ENCODING,
    click.option(
        "--method",
        default="team",
        show_default=True,
        metavar="NAME",
        help="team, team:paper, team:s1 to team:s8, another that `list methods` shows, or FILE.py:NAME.",
    ),
    click.option(
        "--detector",
        metavar="NAME",
        help="Who finds things for methods that look with a detector: see `list detectors`. [default: classical]",
    ),
    click.option("--max-calls", type=click.IntRange(1), help="Most calls of models."),
    click.option("--max-tokens", type=click.IntRange(1), help="Most tokens."),
    click.option(
        "--max-seconds", type=click.FloatRange(0, min_open=True), help="Longest time of all: models, robot, drawing."
    ),
    click.option("--max-usd", type=click.FloatRange(0, min_open=True), help="Most money, where prices are known."),
    click.option("--concurrency", type=click.IntRange(1), default=8, show_default=True, help="Calls at once."),
    CACHE,
    CACHE_FILE,
    click.option(
        "--prompts", type=PATH, metavar="DIR", help="Your own words for the roles (see `list prompts --out`)."
    ),
    click.option("--out", type=PATH, metavar="DIR", help="Where run folders go. [default: runs]"),
    click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text."),
    click.option("--open", "open_page", is_flag=True, help="Open the page when done."),
    click.option("--strict", is_flag=True, help="Refuse a plan that Verification did not approve."),
    click.option("--thorough", is_flag=True, help=THOROUGH),
)


def read_models(words: Sequence[str]) -> str | dict[str, str]:
    """The models of the roles, from repeated "M" and "ROLE=M".

    Raises:
        ConfigError: One role has two models, or a word is empty.
    """
    chosen: dict[str, str] = {}
    for word in words:
        role, separator, name = word.partition("=")
        # A web address may hold "=" too; a role never holds ":" or "/".
        if not separator or ":" in role or "/" in role:
            role, name = "*", word
        if not name:
            raise ConfigError(f"--model {word!r}: the model is missing; valid: --model M or --model ROLE=M")
        if role in chosen:
            raise ConfigError(f"--model: two models for {'all roles' if role == '*' else role}: {chosen[role]}, {name}")
        chosen[role] = name
    chosen.setdefault("*", "offline")
    return chosen["*"] if len(chosen) == 1 else chosen


def read_pairs(words: Sequence[str], option: str) -> dict[str, str]:
    """NAME=VALUE pairs of a repeated option.

    Raises:
        ConfigError: Another form, or a name twice.
    """
    pairs: dict[str, str] = {}
    for word in words:
        name, separator, value = word.partition("=")
        if not (separator and name and value):
            raise ConfigError(f"{option} {word!r}: valid is {option} NAME=FILE")
        if name in pairs:
            raise ConfigError(f"{option}: the name {name!r} is given twice")
        pairs[name] = value
    return pairs
