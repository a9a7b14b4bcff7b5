"""Load an object from a user's file: `FILE.py:Name`."""

from __future__ import annotations

import hashlib
import importlib.util
import inspect
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from wonderful_team.errors import ConfigError, UnknownNameError


def is_file_name(name: str) -> bool:
    """Whether a name has the form `FILE.py:Name` (a lone `FILE.py` counts too, so that its error can say what is missing)."""
    return name.endswith(".py") or ".py:" in name


def load_from_file(name: str, what: str) -> Any:
    """The object that `FILE.py:Name` names.

    The file runs as a module of its own; files beside it can be imported by it.

    Args:
        name: Such as "my_model.py:MyModel".
        what: What is wanted, for messages: "model", "method", "world".

    Raises:
        ConfigError: No such file, the file fails when run, or it does not define the name.
    """
    file_text, _, attribute = name.rpartition(":") if ".py:" in name else (name, "", "")
    path = Path(file_text).expanduser()
    if not path.is_file():
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


def build(thing: Any, offers: Mapping[str, Any], what: str) -> Any:
    """Call a class or function with those of `offers` that its parameters ask for by name; return other objects as they are.

    Raises:
        ConfigError: It needs a parameter that is not offered.
    """
    if not (inspect.isclass(thing) or inspect.isfunction(thing)):
        return thing
    needed: dict[str, Any] = {}
    for parameter in inspect.signature(thing).parameters.values():
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            continue
        if parameter.name in offers and parameter.kind is not parameter.POSITIONAL_ONLY:
            needed[parameter.name] = offers[parameter.name]
        elif parameter.default is parameter.empty:
            raise ConfigError(
                f"{what} {thing.__name__}: nothing to give for its parameter {parameter.name!r}; "
                f"it may ask for: {', '.join(offers) or 'nothing'}"
            )
    return thing(**needed)


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
        spec.loader.exec_module(module)
    except Exception as error:  # whatever a user's file raises is the user's to read, in one line
        del sys.modules[name]
        raise ConfigError(
            f"{what} file {str(path)!r} failed when it was run: {type(error).__name__}: {error}"
        ) from error
    finally:
        sys.path.remove(str(path.parent))
    return module
