"""Run folders: where a run's record, pictures and page lie, and how a run is found again."""

from __future__ import annotations

import contextlib
import os
import re
from datetime import datetime
from pathlib import Path

from wonderful_team.core.filesystem import make_private_folder, writing
from wonderful_team.core.text import user_path
from wonderful_team.errors import ConfigError, FileNotWrittenError, UnknownNameError
from wonderful_team.redaction import redact

OUT_VARIABLE = "WONDERFUL_TEAM_RUNS"
LATEST = "latest"
TRIALS = "trials"
"""Folder of the run folders of a study's trials, within that of runs."""
RECORD_NAME = "record.json"


def runs_folder(out: str | Path | None = None) -> Path:
    """Where run folders go: what is asked for, else $WONDERFUL_TEAM_RUNS, else `runs` in the working directory."""
    return user_path(out if out is not None else os.environ.get(OUT_VARIABLE, "runs"))


def new_run_folder(words: str, out: str | Path | None = None) -> Path:
    """Make `<time>_<words>` and point `latest` at it.

    Raises:
        FileNotWrittenError: The place cannot be written to.
    """
    root = runs_folder(out)
    stem = f"{datetime.now():%Y-%m-%d_%H%M%S}_{_slug(words)}"
    hint = "use --out DIR for another folder of runs"
    make_private_folder(root, hint)
    with writing(root / stem, hint):
        folder = _first_free(root, stem)
    link, fresh = root / LATEST, root / f".{LATEST}-{os.getpid()}"
    try:
        with writing(link, hint):
            fresh.symlink_to(folder.name)
            fresh.replace(link)
    except FileNotWrittenError:
        for remove in (fresh.unlink, folder.rmdir):
            with contextlib.suppress(OSError):
                remove()
        raise
    return folder


def find_run(name: str, out: str | Path | None = None) -> Path:
    """The folder of a run: a path, a folder name in the runs folder, part of one that is unique, or "latest".

    Raises:
        UnknownNameError: No such run.
        ConfigError: It is not a run's folder, or the name fits several.
    """
    root = runs_folder(out)
    for folder in (user_path(name), root / name):
        if folder.is_file() and folder.name in (RECORD_NAME, "page.html", "plan.json"):
            folder = folder.parent
        if (folder / RECORD_NAME).is_file():
            return folder
        if folder.is_dir():
            raise ConfigError(f"{str(folder)!r} is not a run: it has no {RECORD_NAME}")
    names = [run.name for run in all_runs(out)]
    fitting = [known for known in names if name in known]
    if len(fitting) > 1:
        raise ConfigError(f"run {name!r} fits several: {', '.join(fitting[:5])}")
    if not fitting:
        where = f" in {str(root)!r}"
        if TRIALS in Path(name).parts:
            where += " (a trial's record may not have been kept: `show STORE.db` tells how to get it)"
        raise UnknownNameError("run", name, names[:12], where=where)
    return root / fitting[0]


def all_runs(out: str | Path | None = None) -> list[Path]:
    """All run folders, newest first."""
    root = runs_folder(out)
    if not root.is_dir():
        return []
    found = [folder for folder in root.iterdir() if not folder.is_symlink() and (folder / RECORD_NAME).is_file()]
    return sorted(found, key=lambda folder: folder.name, reverse=True)


def trials_kept(out: str | Path | None = None) -> int:
    """How many trials of studies keep a record there."""
    root = runs_folder(out) / TRIALS
    return sum(1 for _ in root.glob(f"*/*/{RECORD_NAME}")) - sum(1 for _ in root.glob(f"*/{LATEST}/{RECORD_NAME}"))


def _slug(words: str) -> str:
    # A picture among the words has no words of its own.
    words = re.sub(r"\{[^{}]*\}", "pictured thing", words)
    return re.sub(r"[^a-z0-9]+", "-", redact(words).lower()).strip("-")[:40].strip("-") or "run"


def _first_free(root: Path, stem: str) -> Path:
    for count in range(1, 1000):
        folder = root / (stem if count == 1 else f"{stem}-{count}")
        try:
            folder.mkdir(mode=0o700)
        except FileExistsError:
            continue
        return folder
    raise OSError(f"{stem} exists a thousand times")
