"""Names of earlier releases: they work for one more release, and say what they are called now."""

from __future__ import annotations

import functools
import importlib
import importlib.abc
import importlib.machinery
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import ModuleType
from typing import Any, TypeVar

Thing = TypeVar("Thing", bound=Callable[..., Any])


def warn_renamed(old: str, new: str, stacklevel: int = 3) -> None:
    """Say that a name is another now."""
    text = f"{old} is called {new} now; the old name goes with the next release"
    warnings.warn(text, DeprecationWarning, stacklevel=stacklevel)


def renamed_arguments(**names: str) -> Callable[[Thing], Thing]:
    """Let a function, or a class when it is called, take keyword arguments by their old names too: `old="new"`.

    Raises:
        TypeError: When called with both names of one argument.
    """

    def decorate(thing: Thing) -> Thing:
        inner = thing.__init__ if isinstance(thing, type) else thing  # type: ignore[misc]

        @functools.wraps(inner)
        def call(*args: Any, **given: Any) -> Any:
            for old in set(given) & set(names):
                new = names[old]
                if new in given:
                    raise TypeError(f"{thing.__name__}: {old} is the old name of {new}; give one of them")
                warn_renamed(f"{thing.__name__}({old}=…)", f"{new}=…")
                given[new] = given.pop(old)
            return inner(*args, **given)

        if isinstance(thing, type):
            thing.__init__ = call  # type: ignore[misc]
            return thing
        return call  # type: ignore[return-value]

    return decorate


def renamed_attribute(old: str, new: str) -> Any:
    """An attribute of a class under its old name; it can be read."""

    def read(self: Any) -> Any:
        warn_renamed(f"{type(self).__name__}.{old}", new)
        return getattr(self, new)

    return property(read, doc=f"The old name of `{new}`.")


class RenamedKeys(Mapping[str, Any]):
    """A mapping that also answers to old names of its keys, but does not list them.

    Args:
        held: The mapping.
        names: Old name to new.
    """

    def __init__(self, held: Mapping[str, Any], names: Mapping[str, str]) -> None:
        self._held, self._names = held, names

    def __getitem__(self, key: str) -> Any:
        if key in self._names and key not in self._held:
            warn_renamed(repr(key), repr(self._names[key]), stacklevel=4)
            key = self._names[key]
        return self._held[key]

    def __contains__(self, key: object) -> bool:
        return key in self._held or key in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._held)

    def __len__(self) -> int:
        return len(self._held)


class _Renamed(ModuleType):
    """A module under its old name: it hands on what the new one has."""

    def __init__(self, old: str, new: str) -> None:
        super().__init__(old, f"The old name of `{new}`.")
        self._new = new

    def __getattr__(self, name: str) -> Any:
        return getattr(importlib.import_module(self._new), name)


class _Names(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    def __init__(self, names: Mapping[str, str]) -> None:
        self.names = names

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        return importlib.machinery.ModuleSpec(fullname, self) if fullname in self.names else None

    def create_module(self, spec: importlib.machinery.ModuleSpec) -> ModuleType:
        warn_renamed(spec.name, self.names[spec.name])
        return _Renamed(spec.name, self.names[spec.name])

    def exec_module(self, module: ModuleType) -> None:
        """There is nothing to run: the new module is imported when something of it is asked for."""


def keep_module_names(names: Mapping[str, str]) -> None:
    """Let modules be imported by old names, full old name to full new one; they are looked for last."""
    if not any(isinstance(finder, _Names) and finder.names == names for finder in sys.meta_path):
        sys.meta_path.append(_Names(names))


__all__ = ["RenamedKeys", "keep_module_names", "renamed_arguments", "renamed_attribute", "warn_renamed"]
