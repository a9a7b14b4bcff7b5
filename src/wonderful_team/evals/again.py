"""The command that runs one trial of a store again and keeps its whole record: what stands where a record was not kept."""

from __future__ import annotations

import re
import shlex

from wonderful_team.evals.names import NO_MODEL
from wonderful_team.evals.photos import SET, is_photo
from wonderful_team.evals.trials import TrialSpec

NOT_KEPT = "its record was not kept"
STORE = "again.db"
_OPTIONS = (
    (re.compile(r"thinking (\w+)"), ("--thinking", "{0}")),
    (re.compile(r"(\w+) thinking (\w+)"), ("--thinking", "{0}={1}")),
    (re.compile(r"(thorough)"), ("--thorough",)),
    (re.compile(r"detector (.+)"), ("--detector", "{0}")),
    (re.compile(r"at most (\S+) calls"), ("--trial-max-calls", "{0}")),
    (re.compile(r"at most (\S+) tokens"), ("--trial-max-tokens", "{0}")),
    (re.compile(r"at most (\S+) s"), ("--trial-max-seconds", "{0}")),
    (re.compile(r"at most (\S+) USD"), ("--trial-max-usd", "{0}")),
    (re.compile(r"own words \w+"), ("--prompts", "DIR")),
)
"""What a condition says of how it was asked, and the option that asks so; the folder of own words is not known to a store."""


def command_again(spec: TrialSpec) -> str:
    """Runs this trial alone, in a store of its own. A photo's number cannot be chosen: there all photos of the file are run."""
    one = spec.condition
    words = ["wonderful-team", "bench", *_task(spec.task)]
    words += [] if is_photo(spec.task) else ["--seeds", str(spec.seed)]
    words += ["--method", one.method]
    words += [] if one.model == NO_MODEL else ["--model", one.model.replace(", ", ",")]
    words += ["--isolate", one.isolate] if one.isolate else []
    words += ["--perturb", one.perturb] if one.perturb else []
    words += ["--replans", str(one.replans)] if one.replans else []
    words += ["--reobserve", str(one.reobserve)] if one.reobserve else []
    words += ["--repeats", str(spec.repeat + 1)] if spec.repeat else []
    for said in one.how.split(", ") if one.how else []:
        words += _option(said)
    return shlex.join([*words, "--no-control", "all", "--record", "full", "--store", STORE])


def _task(task: str) -> list[str]:
    """A task as `bench` takes it."""
    if not task.startswith(SET):
        return [task]
    head, _, path = task.removeprefix(SET).partition(":")
    return [head.partition("/")[0], "--set", path, "--format", head.rpartition("/")[2]]


def _option(said: str) -> list[str]:
    for pattern, option in _OPTIONS:
        found = pattern.fullmatch(said)
        if found is not None:
            return [word.format(*found.groups()) for word in option]
    return []
