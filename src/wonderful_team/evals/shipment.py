"""What travels to the workers of a cluster: this package, and the files of the user's own that a study names. Nothing else.

The files lie below one folder as they lie below the root here, so that every name of a study, absolute or relative, means
the same on both machines. No key travels: a worker reads its keys from the environment of its own machine.
"""

from __future__ import annotations

import io
import os
import shutil
import zipfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from wonderful_team.core.filesystem import make_private_folder
from wonderful_team.core.text import look_in_copies
from wonderful_team.errors import ConfigError
from wonderful_team.redaction import holds_secret

LIMIT_BYTES = 100_000_000
"""Most that the user's files may come to: Ray keeps them in the memory of the head node."""
CONFIG_VARIABLE = "WONDERFUL_TEAM_CONFIG"
FILES = "files"
PACKAGE = Path(__file__).resolve().parents[1]
"""This package, of which every worker runs the same code."""


def _nothing() -> None:
    """A study that needs no check."""


@dataclass(frozen=True)
class Shipment:
    """What a study needs on another machine.

    Attributes:
        files: Of the user's own, absolute.
        config: Folder of the configuration here; what of it a worker may see is in `files`.
        versions: Of the code that travels, as results name them.
        ready: Raises a WonderfulTeamError where the study cannot run; every worker calls it before its first trial.
    """

    files: tuple[Path, ...] = ()
    config: Path | None = None
    versions: Mapping[str, str] = field(default_factory=dict)
    ready: Callable[[], None] = _nothing

    def pack(self, folder: Path) -> Parcel:
        """Copy it all into a folder, and say how it is unpacked.

        Raises:
            ConfigError: Too much, a file that cannot be read, or one that holds a key.
        """
        sizes = {file: _size(file) for file in dict.fromkeys(self.files)}
        total = sum(sizes.values())
        if total > LIMIT_BYTES:
            largest = max(sizes, key=lambda file: sizes[file])
            raise ConfigError(
                f"the study's own files come to {total / 1e6:.0f} MB ({len(sizes)} files, the largest {str(largest)!r}); "
                f"at most {LIMIT_BYTES / 1e6:.0f} MB travel to a cluster. Valid: fewer files, or a store for each machine with --shard I/N"
            )
        shutil.copytree(
            PACKAGE,
            folder / "wonderful_team",
            ignore=shutil.ignore_patterns("__pycache__"),
        )
        for file in sizes:
            copy = folder / FILES / file.relative_to(file.anchor)
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(_without_keys(file))
        return Parcel(os.getcwd(), str(Path.home()), "" if self.config is None else str(self.config), self.ready)


@dataclass(frozen=True)
class Parcel:
    """How a worker unpacks a shipment.

    Attributes:
        cwd, home, config: Folders of the machine that it comes from: where names start, ~, and saved profiles.
    """

    cwd: str
    home: str
    config: str
    ready: Callable[[], None]

    def unpack(self) -> None:
        """Make this process find the copies, wherever the shipment lies here."""
        copies = PACKAGE.parent / FILES
        start = copies / Path(self.cwd).relative_to(Path(self.cwd).anchor)
        start.mkdir(parents=True, exist_ok=True)
        os.chdir(start)
        look_in_copies(copies, self.home)
        if self.config:
            # Profiles that lie on this machine must not decide how a model is asked that was named on another.
            os.environ[CONFIG_VARIABLE] = self.config


def code_beside(file: Path) -> list[Path]:
    """A file and the Python files that it can import from beside it: those of its folder, and packages in there."""
    found = [file, *sorted(file.parent.glob("*.py"))]
    for package in sorted(file.parent.iterdir()):
        if package.is_dir() and (package / "__init__.py").is_file():
            found += sorted(package.rglob("*.py"))
    return [found[0], *(path for path in found[1:] if not _looks_secret(path))]


def all_below(folder: Path) -> list[Path]:
    """A file itself, or every file of a folder; what begins with a dot is passed over."""
    if folder.is_file():
        return [folder]
    if not folder.is_dir():
        raise ConfigError(f"{str(folder)!r}: there is no such file or folder to send to the cluster")
    below = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return [path for path in below if not any(part.startswith(".") for part in path.relative_to(folder).parts)]


def zipped(folder: Path) -> bytes:
    """The files of a folder; empty where there are none. Links are left out."""
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink()]
    if not files:
        return b""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:  # pictures are packed already
        for path in files:
            archive.write(path, path.relative_to(folder))
    return packed.getvalue()


def unzip(packed: bytes, folder: Path) -> None:
    """The inverse; no name in it leads out of the folder.

    Raises:
        OSError: The folder cannot be written to.
    """
    make_private_folder(folder)
    with zipfile.ZipFile(io.BytesIO(packed)) as archive:
        for name in archive.namelist():
            file = Path(archive.extract(name, folder))
            file.chmod(0o600)
            for parent in file.relative_to(folder).parents[:-1]:
                (folder / parent).chmod(0o700)


def listed(paths: Iterable[Path]) -> tuple[Path, ...]:
    """Absolute, each once, in order."""
    return tuple(dict.fromkeys(Path(os.path.normpath(path.absolute())) for path in paths))


def _size(file: Path) -> int:
    try:
        return file.stat().st_size
    except OSError as error:
        raise ConfigError(f"{str(file)!r} cannot be sent to the cluster: {error.strerror}") from error


def _looks_secret(file: Path) -> bool:
    try:
        return holds_secret(file.read_text(encoding="utf-8", errors="replace"))
    except OSError:
        return True


def _without_keys(file: Path) -> bytes:
    try:
        content = file.read_bytes()
    except OSError as error:
        raise ConfigError(f"{str(file)!r} cannot be sent to the cluster: {error.strerror}") from error
    if holds_secret(content.decode("utf-8", errors="replace")):
        raise ConfigError(
            f"{str(file)!r} holds a key and is not sent to the cluster. Valid: read keys from the environment, which each machine sets "
            "for itself before `ray start`"
        )
    return content
