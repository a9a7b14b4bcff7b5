"""Models by role in studies: one text names who answers what, the same in the store, on the page and for a worker process.

"big" is one model for all roles; "big, checker=small" is another for the Checker.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from wonderful_team import registry
from wonderful_team.errors import ConfigError, UnknownNameError

REST = registry.DEFAULT_ROLE
_BETWEEN = ", "


def text_of(model: str | Mapping[str, str], roles: Sequence[str] | None = None) -> str:
    """The text of a choice; the roles in their own order, so that one choice has one text.

    Raises:
        UnknownNameError: A role that does not exist.
        ConfigError: No model for the roles that are not named.
    """
    if isinstance(model, str):
        return model
    known = registry.all_roles() if roles is None else roles
    for role in model:
        if role not in (*known, REST):
            raise UnknownNameError("role", role, known)
    if REST not in model:
        raise ConfigError(f"models {dict(model)}: name one for all other roles too, under {REST!r}")
    rest = model[REST]
    return _BETWEEN.join([rest, *(f"{role}={model[role]}" for role in known if model.get(role, rest) != rest)])


def choice_of(text: str) -> str | dict[str, str]:
    """The choice that a text names."""
    rest, *parts = text.split(_BETWEEN)
    return {REST: rest, **dict(part.split("=", 1) for part in parts)} if parts else text


def read_choices(words: Sequence[str], default: str) -> tuple[str, ...]:
    """The models of a study from repeated `--model` values, each "M", "M,N", "M,ROLE=X" or "ROLE=X".

    A ROLE=X beside models is for those; alone, it is for all models.

    Raises:
        UnknownNameError: A role that does not exist.
        ConfigError: One role has two models, or a word is empty.
    """
    roles = registry.all_roles()
    everywhere: dict[str, str] = {}
    groups: list[tuple[list[str], dict[str, str]]] = []
    for word in words:
        models, by_role = _one_value(word, roles)
        if models:
            groups.append((models, by_role))
        else:
            _add(everywhere, by_role, word)
    found = []
    for models, by_role in groups or [([default], {})]:
        whole = dict(everywhere)
        _add(whole, by_role, ",".join(models))
        found += [text_of({REST: model, **whole}, roles) for model in models]
    return tuple(found)


def _one_value(word: str, roles: Sequence[str]) -> tuple[list[str], dict[str, str]]:
    models: list[str] = []
    by_role: dict[str, str] = {}
    for part in (part.strip() for part in word.split(",")):
        role, separator, name = part.partition("=")
        # A web address may hold "=" too; a role never holds ":" or "/".
        if not separator or ":" in role or "/" in role:
            models += [part] if part else []
            continue
        if role not in roles:
            raise UnknownNameError("role", role, roles)
        if not name:
            raise ConfigError(f"--model {word!r}: the model is missing; valid: --model M or --model ROLE=M")
        _add(by_role, {role: name}, word)
    return models, by_role


def _add(to: dict[str, str], more: Mapping[str, str], word: str) -> None:
    for role, name in more.items():
        if to.get(role, name) != name:
            raise ConfigError(f"--model {word!r}: two models for {role}: {to[role]}, {name}")
        to[role] = name


def read_roles(words: Sequence[str], option: str, valid: str) -> dict[str, str]:
    """Values by role ("*" for the rest), from repeated "VALUE" and "ROLE=VALUE".

    Raises:
        ConfigError: One role has two values, or a word is empty.
    """
    chosen: dict[str, str] = {}
    for word in words:
        role, separator, value = word.rpartition("=")
        role = role if separator else "*"
        if not (role and value):
            raise ConfigError(f"{option} {word!r}: valid is {option} {valid} or {option} ROLE={valid}")
        if role in chosen:
            raise ConfigError(
                f"{option}: two values for {'all roles' if role == '*' else role}: {chosen[role]}, {value}"
            )
        chosen[role] = value
    return chosen
