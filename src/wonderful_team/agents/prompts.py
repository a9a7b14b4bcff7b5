"""The words that are sent, as files: `<role>.md` are a role's standing words, `<role>.<Contract>.md` one of its asks."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from types import MappingProxyType

from wonderful_team.agents.checker import CHECKER
from wonderful_team.agents.manager import MANAGER
from wonderful_team.agents.memory import MEMORY
from wonderful_team.agents.mover import MOVER
from wonderful_team.agents.passages import check
from wonderful_team.agents.replanner import REPLANNER
from wonderful_team.agents.role import Role
from wonderful_team.agents.supervisor import SUPERVISOR
from wonderful_team.agents.verification import VERIFICATION
from wonderful_team.core.text import user_path
from wonderful_team.errors import ConfigError, UnknownNameError

ROLES: Mapping[str, Role] = MappingProxyType(
    {role.name: role for role in (SUPERVISOR, VERIFICATION, MANAGER, CHECKER, MOVER, MEMORY, REPLANNER)}
)
"""Every role by name, in the order in which they come into play."""


@dataclass(frozen=True, eq=False)
class Prompts:
    """The words of all roles, built in or replaced by a user's files.

    Attributes:
        texts: By file name; always every file that exists.
    """

    texts: Mapping[str, str]

    def __post_init__(self) -> None:
        object.__setattr__(self, "texts", MappingProxyType(dict(self.texts)))

    @staticmethod
    @cache
    def default() -> Prompts:
        """The built-in words."""
        return Prompts.of(*ROLES.values())

    @staticmethod
    def of(*roles: Role) -> Prompts:
        """The words that roles bring."""
        texts = {}
        for role in roles:
            texts[f"{role.name}.md"] = role.system
            texts |= {f"{role.name}.{contract}.md": ask.words for contract, ask in role.asks.items()}
        return Prompts(texts)

    @classmethod
    def load(cls, directory: Path | str | None) -> Prompts:
        """The built-in words with those of a folder's files in their place; None means built in alone.

        Names that begin with a dot are passed over.

        Raises:
            ConfigError: No such folder, a file that no role would read, an empty file, or one that is not UTF-8.
        """
        texts = dict(cls.default().texts)
        if directory is None:
            return cls.default()
        folder = user_path(directory)
        if not folder.is_dir():
            raise ConfigError(f"prompts: {str(folder)!r} is not a folder; it should hold files such as supervisor.md")
        for path in sorted(folder.iterdir()):
            if path.name.startswith("."):
                continue
            if path.name not in texts:
                raise UnknownNameError("prompt file", path.name, texts)
            texts[path.name] = _read(path)
            check(path.name, texts[path.name])
        return cls(texts)

    def system(self, role: str) -> str:
        """A role's standing words."""
        return self.texts[f"{role}.md"]

    def ask(self, role: str, contract: str) -> str:
        """What a role is told when it is asked this kind of question."""
        return self.texts[f"{role}.{contract}.md"]

    def files(self) -> dict[str, str]:
        """Every file with its text: what `load` reads back to the same words and the same hash."""
        return {name: f"{text}\n" for name, text in self.texts.items()}

    @cached_property
    def hash(self) -> str:
        """Hash of all words: 12 hex digits."""
        digest = hashlib.sha256()
        for name, text in sorted(self.texts.items()):
            digest.update(f"{name}\0{text}\0".encode())
        return digest.hexdigest()[:12]


def _read(path: Path) -> str:
    try:
        text = path.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"prompt file {path.name!r} cannot be read as UTF-8 text: {error}") from error
    if not text:
        raise ConfigError(f"prompt file {path.name!r} is empty; remove it to use the built-in words")
    return text


def role_names() -> tuple[str, ...]:
    """All roles of the team."""
    return tuple(ROLES)
