"""Models by name: offline, simulated, vendors and servers, saved profiles, and models from a file."""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from wonderful_team.core.protocols import Model, World
from wonderful_team.errors import ConfigError, ModelCodeError, UnknownNameError, WonderfulTeamError, code_of
from wonderful_team.models.providers.vendors import VENDORS
from wonderful_team.registry.files import check_names_no_code, is_file_name, make_from_file
from wonderful_team.registry.simulated import SIMULATED, simulated_model

if TYPE_CHECKING:
    from wonderful_team.models.profiles import Profile
    from wonderful_team.models.providers import ModelOptions


MODELS: dict[str, str] = {
    "offline": "classical vision and a grammar: no key, no weights, no network; not a VLM",
    "simulated:perfect": "a simulator's truth, as it is seen through the pictures shown: tests everything but the model",
}
MODEL_FORMS: dict[str, str] = {
    **{
        f"{name}:NAME": f"{vendor.words}; key in {' or '.join(vendor.keys)}"
        for name, vendor in VENDORS.items()
        if vendor.words
    },
    "VENDOR:NAME@URL": "the same interface at another address",
    "http://HOST:8000/v1[#NAME]": "any OpenAI-compatible server; without #NAME it is asked which model it has",
    "simulated:PROFILE": "a simulator's truth with stated errors: coarse, hasty, paper-gpt-4o (or -gpt-4-turbo, -claude-3-opus), or what probe --full measured",
    "simulated:PROFILE:RATE=VALUE": "the same with rates of your own, as in simulated:perfect:wrong_plan=0.5:overlooks=0.1 (docs/profiles.md)",
    "FILE.py:NAME": "your own: anything with answer(request)",
}
DEFAULT_ROLE = "*"


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
        made = make_provider(
            spec,
            profile=profile,
            thinking=thinking,
            price=price,
            local_only=asked.local_only,
            timeout_s=asked.timeout_s,
            encoding=asked.encoding,
        )
        return cast(Model, made)
    if profile is not None:
        return make_model(named_by_profile(profile), options, role, world)
    if model not in MODELS:
        raise UnknownNameError("model", model, [*MODELS, *profile_names(), *MODEL_FORMS])
    return cast(Model, importlib.import_module("wonderful_team.offline").OfflineModel())


def load_ahead(model: str | Model | Mapping[str, str | Model]) -> None:
    """Start to import what the named models' services need, while other things are read; what is wrong with a name is said later."""
    from wonderful_team.models.profiles import load_profile, profile_names
    from wonderful_team.models.providers import is_provider_spec, load_library

    for named in model.values() if isinstance(model, Mapping) else (model,):
        if not isinstance(named, str) or named in MODELS or named.startswith(SIMULATED) or is_file_name(named):
            continue
        with contextlib.suppress(WonderfulTeamError):
            spec = load_profile(named).model if named in profile_names() else named
            if is_provider_spec(spec):
                load_library(spec)


def named_by_profile(profile: Profile) -> str:
    """The model that a profile was measured of.

    Raises:
        ConfigError: It names code, or another profile.
    """
    from wonderful_team.models.profiles import profile_names

    name = check_names_no_code(profile.model, f"profile {profile.name!r}")
    if name in profile_names():
        raise ConfigError(f"profile {profile.name!r} names the profile {name!r}; valid is the name of a model")
    return name


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
