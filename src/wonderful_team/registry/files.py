"""Load an object from a user's file: `FILE.py:Name`."""

from __future__ import annotations

import contextlib
import hashlib
import importlib.util
import inspect
import sys
from collections.abc import Iterator, Mapping
from contextvars import ContextVar
from pathlib import Path
from types import ModuleType
from typing import Any

from wonderful_team.core import deadline
from wonderful_team.core.text import user_path
from wonderful_team.errors import BudgetReached, ConfigError, UnknownNameError, WonderfulTeamError, code_of


def is_file_name(name: str) -> bool:
    """Whether a name has the form `FILE.py:Name` (a lone `FILE.py` counts too, so that its error can say what is missing)."""
    return name.endswith(".py") or ".py:" in name


_UNTRUSTED: ContextVar[str] = ContextVar("untrusted", default="")
"""Whose words are being followed, while they are those of a file."""


@contextlib.contextmanager
def names_no_code(whose: str) -> Iterator[None]:
    """Follow what a file (a record, a store, a profile) says: no code is loaded meanwhile, whatever the file names.

    Args:
        whose: Begins the message.
    """
    before = _UNTRUSTED.set(whose)
    try:
        yield
    finally:
        _UNTRUSTED.reset(before)


def check_names_no_code(name: str, whose: str) -> str:
    """A name out of a file (a record, a store, a profile), which may name what is built in and never code that runs.

    Raises:
        ConfigError: It has the form FILE.py:NAME.
    """
    if is_file_name(name):
        raise ConfigError(
            f"{whose} names code: {name!r}. Code runs only when it is named on the command line or by the caller; "
            "files name what is built in"
        )
    return name


def load_from_file(name: str, what: str) -> Any:
    """The object that `FILE.py:Name` names.

    The file runs as a module of its own; files beside it can be imported by it.

    Args:
        name: Such as "my_model.py:MyModel".
        what: What is wanted, for messages: "model", "method", "world".

    Raises:
        ConfigError: No such file, the file fails when run, or it does not define the name.
    """
    if _UNTRUSTED.get():
        check_names_no_code(name, _UNTRUSTED.get())
    name, _ = split_arguments(name)
    file_text, _, attribute = name.rpartition(":") if ".py:" in name else (name, "", "")
    path = user_path(file_text)
    if "\0" in file_text or not path.is_file():
        raise ConfigError(f"{what} {name!r}: there is no file {str(path)!r}; valid: FILE.py:NAME")
    module = _run_file(path.resolve(), what)
    offered = [key for key in vars(module) if not key.startswith("_")]
    if not attribute:
        own = [key for key in offered if getattr(getattr(module, key), "__module__", None) == module.__name__]
        raise ConfigError(
            f"{what} {name!r}: say which name of the file is meant, as in {file_text}:{(own or ['Name'])[0]}"
        )
    if attribute not in offered:
        raise UnknownNameError(f"name in {file_text}", attribute, offered)
    return getattr(module, attribute)


def split_arguments(name: str) -> tuple[str, dict[str, str]]:
    """`FILE.py:NAME?address=10.0.0.5&speed=0.2` in two: what is loaded, and arguments for its constructor.

    Raises:
        ConfigError: What stands behind the question mark is not NAME=VALUE.
    """
    file, colon, rest = name.partition(".py:")
    if not colon:
        return name, {}
    attribute, arguments = named_arguments(rest, name)
    return f"{file}.py:{attribute}", arguments


def named_arguments(words: str, whole: str) -> tuple[str, dict[str, str]]:
    """`NAME?address=10.0.0.5&speed=0.2` in two: what stands before the question mark, and the arguments behind it.

    Args:
        words: What is read.
        whole: What the user wrote, for the message.

    Raises:
        ConfigError: What stands behind the question mark is not NAME=VALUE.
    """
    name, mark, rest = words.partition("?")
    if not mark:
        return words, {}
    pairs = [word.partition("=") for word in rest.split("&")]
    for key, equals, _ in pairs:
        if not (key.isidentifier() and equals):
            raise ConfigError(f"{whole!r}: {rest!r} is not NAME=VALUE; valid: {name}?address=10.0.0.5&speed=0.2")
    return name, {key: value for key, _, value in pairs}


def make_from_file(
    name: str,
    what: str,
    offers: Mapping[str, Any],
    fault: type[WonderfulTeamError],
    arguments: Mapping[str, Any] | None = None,
) -> Any:
    """What `FILE.py:NAME?ARGUMENTS` names: a class or function is called, any other object is returned as it is.

    Args:
        name: Such as "arm.py:Arm?address=10.0.0.5".
        what: "model", "method" or "world".
        offers: Given to parameters that ask for them by name, such as `seed`.
        fault: Whose fault it is when the code raises something of its own.
        arguments: For the constructor, beside those in the name.

    Raises:
        ConfigError: It cannot be loaded, needs a parameter that nobody gives, or has none of that name.
        WonderfulTeamError: Of the class `fault`.
    """
    thing = load_from_file(name, what)
    given = {**split_arguments(name)[1], **(arguments or {})}
    whose = f"{what} {name!r}"
    if not (inspect.isclass(thing) or inspect.isfunction(thing)):
        if given:
            raise ConfigError(f"{whose}: arguments ({', '.join(given)}) are for a class or a function; this is neither")
        return thing
    making = f"{whose}: {thing.__name__}(…)"
    with code_of(making, fault):
        arguments = arguments_of(thing, offers, given, whose)
        return deadline.bounded(making, lambda: thing(**arguments))


def arguments_of(
    thing: Any, offers: Mapping[str, Any], given: Mapping[str, Any], whose: str, called: str = ""
) -> dict[str, Any]:
    """What a constructor or function is called with: what is given by name, and of `offers` what it asks for.

    Args:
        thing: What is called.
        offers: Given to parameters that ask for them by name.
        given: By name; texts become the numbers and truth values that annotations ask for.
        whose: Begins messages.
        called: What the user knows it as; default its own name.

    Raises:
        ConfigError: It needs a parameter that nobody gives, has none of a name, or a text is no number.
    """
    parameters = inspect.signature(thing).parameters.values()
    named = {one.name: one for one in parameters if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)}
    takes_any = any(one.kind is one.VAR_KEYWORD for one in parameters)
    if not takes_any:
        for key in given:
            if key not in named:
                raise UnknownNameError(f"argument of {called or thing.__name__}", key, named)
    held = {key: offers[key] for key in named if key in offers}
    held |= {key: _typed(value, named.get(key), whose) for key, value in given.items()}
    for parameter in parameters:
        variable = parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD)
        if not variable and parameter.name not in held and parameter.default is parameter.empty:
            raise ConfigError(
                f"{whose} {thing.__name__}: nothing to give for its parameter {parameter.name!r}; it may ask for: "
                f"{', '.join(offers) or 'nothing'}; other arguments are given as in FILE.py:NAME?{parameter.name}=VALUE"
            )
    return held


_TRUTH = {"true": True, "1": True, "yes": True, "false": False, "0": False, "no": False}


def _typed(value: Any, parameter: inspect.Parameter | None, whose: str) -> Any:
    """A value out of a name, as the number or truth value that the parameter's annotation asks for."""
    kind = str(getattr(parameter.annotation, "__name__", parameter.annotation)) if parameter is not None else ""
    if not isinstance(value, str) or kind not in ("int", "float", "bool"):
        return value
    try:
        return {"int": int, "float": float, "bool": lambda word: _TRUTH[word.lower()]}[kind](value)  # type: ignore[operator]
    except (ValueError, KeyError):
        assert parameter is not None
        raise ConfigError(f"{whose}: argument {parameter.name}={value!r} is not of type {kind}") from None


def _run_file(path: Path, what: str) -> ModuleType:
    name = f"wonderful_team_file_{path.stem}_{hashlib.sha256(str(path).encode()).hexdigest()[:8]}"
    if name in sys.modules:
        return sys.modules[name]
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ConfigError(f"{what} file {str(path)!r} is not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    sys.path.insert(0, str(path.parent))
    try:
        deadline.bounded(f"running {what} file {str(path)!r}", spec.loader.exec_module, module)
    except BudgetReached:
        del sys.modules[name]
        raise
    except (Exception, SystemExit) as error:  # whatever a user's file raises is the user's to read
        del sys.modules[name]
        raise ConfigError(f"{what} file {str(path)!r} failed when it was run: it", cause=error) from error
    finally:
        sys.path.remove(str(path.parent))
    return module
