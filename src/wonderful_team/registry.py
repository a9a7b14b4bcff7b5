"""Names to things: models, methods, worlds and tasks. The only place where a string picks an implementation.

Every kind also takes `FILE.py:Name`. Truth leaves a simulator only through `privileged`, and only for scorers and simulated
models.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, cast

from wonderful_team.core.protocols import Model, Policy, World, offers
from wonderful_team.core.values import Instruction, KeepOut
from wonderful_team.errors import (
    ConfigError,
    MethodCodeError,
    ModelCodeError,
    UnknownNameError,
    WorldUnavailableError,
    code_of,
)
from wonderful_team.loading import check_names_no_code, is_file_name, load_from_file, make_from_file
from wonderful_team.own_world import OwnWorld
from wonderful_team.simulated_models import SIMULATED, simulated_model

if TYPE_CHECKING:
    from wonderful_team.models.door import Door
    from wonderful_team.models.providers import ModelOptions

MODELS: dict[str, str] = {
    "offline": "classical vision and a grammar: no key, no weights, no network; not a VLM",
    "simulated:perfect": "a simulator's truth, as it is seen through the pictures shown: tests everything but the model",
}
MODEL_FORMS: dict[str, str] = {
    "openai:NAME": "OpenAI (Responses); openai-chat:NAME for Chat Completions; key in OPENAI_API_KEY",
    "anthropic:NAME": "Anthropic; key in ANTHROPIC_API_KEY",
    "google:NAME": "Google Gemini; key in GOOGLE_API_KEY or GEMINI_API_KEY",
    "openrouter:NAME": "OpenRouter; key in OPENROUTER_API_KEY",
    "VENDOR:NAME@URL": "the same interface at another address",
    "http://HOST:8000/v1[#NAME]": "any OpenAI-compatible server; without #NAME it is asked which model it has",
    "simulated:PROFILE": "a simulator's truth with stated errors: coarse, hasty, or a profile that probe --full measured",
    "FILE.py:NAME": "your own: anything with answer(request)",
}
SETTINGS = tuple(f"s{number}" for number in range(1, 9))
METHODS: dict[str, str] = {
    "team": "the whole team, lean: few waiting rounds, the paper's loop only for boxes that fail",
    "team:paper": "the whole team, the algorithms as published",
    **{f"team:{name}": f"the lean team in the paper's ablation setting {name[1:]}" for name in SETTINGS},
    **{f"team:paper:{name}": f"the published algorithms in ablation setting {name[1:]}" for name in SETTINGS},
}
WORLDS: dict[str, str] = {
    "tabletop": "MuJoCo table, 1.0 x 0.5 m, suction, top and front cameras with depth",
    "vimabench": "VIMA-Bench itself: your own copy, in a process and a Python environment of its own; 256 x 128 px, no depth",
}
_SIMULATORS: dict[str, str] = {
    "tabletop": "wonderful_team.sims.tabletop",
    "vimabench": "wonderful_team.sims.vimabench",
}
DEFAULT_ROLE = "*"


# -- models --------------------------------------------------------------------------------------------------------


def make_model(
    model: str | Model, options: ModelOptions | None = None, role: str = DEFAULT_ROLE, world: World | None = None
) -> Model:
    """The model that a name means; an object with `answer(request)` is a model already.

    Args:
        model: `offline`, a name saved by `probe --save`, one of MODEL_FORMS, or an object.
        options: Thinking, prices and where models may be.
        role: Whose options count.
        world: Whose truth a simulated model answers from; without it, such a model waits for one and answers nothing.

    Raises:
        ConfigError: The name means nothing that exists, its file has no such model, a key is missing, or a world gives no
            truth to a simulated model.
        ModelUnavailableError: A server that was to be asked for its models does not answer.
    """
    if not isinstance(model, str):
        with code_of(f"model {type(model).__name__}", ModelCodeError):
            answers = callable(getattr(model, "answer", None))
        if not answers:
            raise ConfigError(f"a model needs a method answer(request); {type(model).__name__} has none")
        return model
    if model.startswith(SIMULATED):
        return simulated_model(model, world)
    if is_file_name(model):
        made = make_from_file(model, "model", {}, ModelCodeError)
        return make_model(made)
    from wonderful_team.models.profiles import load_profile, profile_names
    from wonderful_team.models.providers import ModelOptions, is_provider_spec, make_provider

    asked = options or ModelOptions()
    profile = load_profile(model) if model in profile_names() else None
    spec = model if profile is None else profile.model
    if is_provider_spec(spec):
        thinking, price = asked.thinking_of(role), asked.price_of(role)
        made = make_provider(spec, profile=profile, thinking=thinking, price=price, local_only=asked.local_only)
        return cast(Model, made)
    if profile is not None:
        return make_model(check_names_no_code(spec, f"profile {model!r}"), options, role, world)
    if model not in MODELS:
        raise UnknownNameError("model", model, [*MODELS, *profile_names(), *MODEL_FORMS])
    return cast(Model, importlib.import_module("wonderful_team.offline").OfflineModel())


def make_models(
    model: str | Model | Mapping[str, str | Model],
    roles: Sequence[str],
    options: ModelOptions | None = None,
    world: World | None = None,
) -> dict[str, Model]:
    """One model for every role.

    Args:
        model: One model for all roles, or a model for each role; key "*" is for the roles not named.
        roles: All roles there are.
        options: Thinking and prices by role, and where models may be.
        world: Whose truth simulated models answer from.

    Raises:
        UnknownNameError: A role that does not exist.
        ConfigError: A role is left without a model.
    """
    wanted: Mapping[str, str | Model] = model if isinstance(model, Mapping) else {DEFAULT_ROLE: model}
    for role in wanted:
        if role not in (*roles, DEFAULT_ROLE):
            raise UnknownNameError("role", role, roles)
    left_out = [role for role in roles if role not in wanted]
    if left_out and DEFAULT_ROLE not in wanted:
        raise ConfigError(
            f"no model for: {', '.join(left_out)}; give one for all roles beside the ones for {', '.join(wanted)}"
        )
    # Roles that share a name and its options share one model, and so its connections.
    made: dict[tuple[Any, ...], Model] = {}
    models = {}
    for role in roles:
        named = wanted.get(role, wanted.get(DEFAULT_ROLE))
        assert named is not None
        how = () if options is None else (options.thinking_of(role), options.price_of(role))
        key = (named if isinstance(named, str) else id(named), *how)
        if key not in made:
            made[key] = make_model(named, options, role, world)
        models[role] = made[key]
    return models


def model_label(model: str | Model | Mapping[str, str | Model]) -> str:
    """How records and pages name the model."""
    if isinstance(model, Mapping):
        return ", ".join(
            model_label(name) if role == DEFAULT_ROLE else f"{role}={model_label(name)}" for role, name in model.items()
        )
    return model if isinstance(model, str) else str(getattr(model, "name", type(model).__name__))


# -- methods -------------------------------------------------------------------------------------------------------


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


# -- worlds --------------------------------------------------------------------------------------------------------


def task_names() -> dict[str, str]:
    """Every task of every world, as WORLD/TASK, with a line of help."""
    return {f"{world}/{name}": words for world in _SIMULATORS for name, words in _simulator(world).task_names().items()}


def task_partitions() -> dict[str, tuple[str, ...]]:
    """The generalisation levels of every task, as WORLD/TASK: a world is then made as WORLD/TASK@LEVEL."""
    return {
        f"{world}/{name}": tuple(_simulator(world).partitions(name))
        for world in _SIMULATORS
        for name in _simulator(world).task_names()
    }


def check_ready(names: Iterable[str]) -> None:
    """Whether the simulators behind these tasks can be started, before many are; each is asked once.

    Raises:
        ConfigError: One is not installed; says how to get it.
    """
    for world in dict.fromkeys(name.partition("/")[0] for name in names if not is_file_name(name)):
        ready = getattr(_simulator(world), "check_ready", None) if world in _SIMULATORS else None
        if ready is not None:
            ready()


def own_tiers(name: str) -> tuple[str, ...]:
    """Kinds of harder tier that a world makes itself, in its simulator; () where only its pictures can be changed."""
    ours = name.partition("/")[0] == "tabletop"
    if is_file_name(name):
        ours = task_made_of(load_from_file(name, "world")) is not None
    return tuple(importlib.import_module("wonderful_team.sims.tabletop.options").TIERS) if ours else ()


def make_world(
    name: str | Any,
    seed: int = 0,
    instruction: str | Instruction | None = None,
    keep_out: Sequence[KeepOut] = (),
    tiers: Mapping[str, int] | None = None,
    **arguments: Any,
) -> World:
    """A world with one scene set up in it.

    Args:
        name: WORLD/TASK such as "tabletop/rotate"; or FILE.py:NAME, a class with the World interface or a task
            made with `wonderful_team.task`; or an object that is a world but for its instruction, `stop` or `close`.
        seed: Of the scene. Seeds below 1000 are for development; suites start at 1000.
        instruction: Instead of the world's own; the scorer, which judges the world's own, is then dropped.
        keep_out: Regions nothing may enter, beside the world's own.
        tiers: How much harder than usual, 0 to 3, by kind; of `own_tiers(name)`.
        **arguments: For the constructor of a world of FILE.py:NAME, such as a robot's address.

    Raises:
        UnknownNameError: No such world or task; lists those that exist.
        ConfigError: The seed is negative, or the world has no instruction and none is given.
    """
    if seed < 0:
        raise ConfigError(f"seed {seed}: must be 0 or more")
    if not isinstance(name, str):
        world, name = _whole(name, f"world {type(name).__name__}"), type(name).__name__
        _take_none(name, arguments)
    else:
        wrong = [kind for kind in tiers or {} if kind not in own_tiers(name)]
        if wrong:
            raise ConfigError(f"world {name!r} makes no tiers of {', '.join(wrong)}; our tabletop does")
        harder = dict(tiers or {})
        if is_file_name(name):
            world = _world_from_file(name, seed, harder, arguments)
        else:
            _take_none(name, arguments)
            world = _named_world(name, seed, harder)
    with code_of(f"instruction of world {name!r}", WorldUnavailableError):
        own = getattr(world, "instruction", None)
        whole = offers(world, World)
    if own is not None and not isinstance(own, Instruction):
        raise WorldUnavailableError(
            f"instruction of world {name!r} is a {type(own).__name__}; valid: a wt.Instruction, or None"
        )
    wanted = _worded(instruction, own) if instruction is not None else own
    if wanted is None:
        raise ConfigError(
            f'world {name!r} brings no instruction: say one, as in: run {name} "put the red cup on the tray"'
        )
    if whole and wanted is own and not keep_out:
        return cast(World, world)
    return cast(World, OwnWorld(world, wanted, tuple(keep_out)))


def scene_name(name: str, seed: int) -> str:
    """How records name a scene."""
    return f"{name}#{seed}"


def _take_none(name: str, arguments: Mapping[str, Any]) -> None:
    if arguments:
        raise ConfigError(
            f"world {name!r} takes no arguments ({', '.join(arguments)}); those of FILE.py:NAME, a class, are for its constructor"
        )


def _worded(instruction: str | Instruction, own: Instruction | None) -> Instruction:
    if isinstance(instruction, Instruction):
        return instruction
    slots = dict(own.slots) if own is not None else {}
    return Instruction(instruction, {key: slot for key, slot in slots.items() if f"{{{key}}}" in instruction})


def _named_world(name: str, seed: int, harder: Mapping[str, int]) -> World:
    world, _, task = name.partition("/")
    if world not in WORLDS:
        known = [*WORLDS, "FILE.py:NAME"]
        worlds = [one for one in _SIMULATORS if name.partition("@")[0] in _simulator(one).task_names()]
        if worlds:
            raise ConfigError(
                f"unknown world {name!r}: it is a task; say {' or '.join(f'{one}/{name}' for one in worlds)}"
            )
        raise UnknownNameError("world", world, known)
    if not task:
        raise ConfigError(f"world {name!r}: say which task, one of: {', '.join(task_names())}")
    if task.partition("@")[0] not in _simulator(world).task_names():
        raise UnknownNameError("task", name, task_names())
    return cast(World, _simulator(world).make_world(task, seed=seed, **harder))


def _world_from_file(name: str, seed: int, harder: Mapping[str, int], arguments: Mapping[str, Any]) -> Any:
    task = task_made_of(load_from_file(name, "world"))
    if task is not None:
        _take_none(name, arguments)
        return _tabletop().make_world(task, seed=seed, **harder)
    made = make_from_file(name, "world", {"seed": seed}, WorldUnavailableError, arguments)
    return _whole(made, f"world {name!r}")


def _whole(made: Any, what: str) -> Any:
    """The same object, when it has what a world needs."""
    with code_of(f"{what}: {type(made).__name__}", WorldUnavailableError):
        missing = [need for need in ("vocabulary", "limits", "observe", "execute") if not hasattr(made, need)]
    if missing:
        raise ConfigError(
            f"{what}: {type(made).__name__} lacks {', '.join(missing)}; a world has vocabulary, limits, "
            "observe() and execute(action), a task is made with wonderful_team.task"
        )
    return made


def task_made_of(thing: Any) -> str | None:
    """The name of the tabletop task that a user's function was made into."""
    registering = importlib.import_module("wonderful_team.sims.tabletop.registering")
    return next((name for name in _tabletop().task_names() if registering.find_task(name).set_table is thing), None)


def made_in_main(name: str) -> bool:
    """Whether a task of the tabletop was made in the script that is running: only that script can make it again."""
    task = name.removeprefix("tabletop/").partition("@")[0]
    if not name.startswith("tabletop/") or is_file_name(name):
        return False
    registering = importlib.import_module("wonderful_team.sims.tabletop.registering")
    return str(registering.find_task(task).set_table.__module__) in ("__main__", "__mp_main__")


def _tabletop() -> Any:
    return _simulator("tabletop")


def _simulator(world: str) -> Any:
    """The package of a simulated world: `make_world`, `task_names` and `partitions`; imported when it is first used."""
    return importlib.import_module(_SIMULATORS[world])


__all__ = [
    "METHODS",
    "MODELS",
    "MODEL_FORMS",
    "SETTINGS",
    "WORLDS",
    "OwnWorld",
    "TeamWay",
    "check_ready",
    "load_method",
    "make_model",
    "make_models",
    "make_world",
    "model_label",
    "own_tiers",
    "scene_name",
    "task_made_of",
    "task_names",
    "task_partitions",
    "team_way",
]
