"""What every trial of a study is set up with: its method, capped and counted; the command and the versions behind it."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from wonderful_team import registry
from wonderful_team._version import __version__
from wonderful_team.api.method import Method
from wonderful_team.core.protocols import Event, Model, World
from wonderful_team.core.text import user_path
from wonderful_team.core.values import Request, Usage
from wonderful_team.evals.controls import CONTROLS
from wonderful_team.evals.trials import Limiter, RunSettings, TrialSpec
from wonderful_team.models.around import AroundModel
from wonderful_team.models.client import call_model
from wonderful_team.models.providers import model_options
from wonderful_team.record.versions import versions
from wonderful_team.registry.files import is_file_name
from wonderful_team.registry.role_models import REST, choice_of

BESIDE = frozenset({"memory"})
"""Roles whose requests run beside the main line and make no waiting round."""


@dataclass
class UsageCounter:
    """Counts what a trial asks: calls, pictures, cost by role, and waiting rounds."""

    rounds: int = 0
    by_role: dict[str, Usage] = field(default_factory=dict)
    provenance: set[str] = field(default_factory=set)
    _round_of: dict[str, int] = field(default_factory=dict)

    def on_event(self, event: Event) -> None:
        """Keep what is counted; a request sent after an answer of round n belongs to round n + 1."""
        if event.kind == "request" and event.content.role not in BESIDE:
            self._round_of[event.content.id] = self.rounds + 1
        elif event.kind == "answer":
            request, answer = event.content
            self.rounds = max(self.rounds, self._round_of.get(request.id, 0))
            self.by_role[request.role] = self.by_role.get(request.role, Usage()) + answer.usage
            self.provenance.add(answer.provenance)


class RateLimitedModel(AroundModel):
    """A model whose calls wait for a place among those of all workers."""

    def __init__(self, model: Model, limiter: Limiter) -> None:
        super().__init__(model)
        self.limiter, self.name = limiter, registry.model_label(model)

    async def answer(self, request: Request) -> Any:
        """The model's answer."""
        await self.limiter.acquire()
        try:
            return await call_model(self.model, request)
        finally:
            await self.limiter.release()


def prepared(spec: TrialSpec, settings: RunSettings, model: Any, world: World | None = None) -> Method:
    """The method of a trial with its model, capped, and limited together with all other workers."""
    caps, asked = settings.caps, method_options(settings.extra, spec.condition.method)
    if settings.limiter is not None:
        roles = (*registry.roles_of(spec.condition.method), REST)
        options = model_options(
            asked.get("thinking"), asked.get("price"), bool(asked.get("local_only")), roles, asked.get("timeout"),
            asked.get("encoding", "auto"),
        )  # fmt: skip
        made = registry.make_models(model, roles, options, world)
        behind = {id(one): RateLimitedModel(one, settings.limiter) for one in made.values()}
        model = {role: behind[id(one)] for role, one in made.items()}
    return Method(
        **asked,
        model=model,
        method=spec.condition.method,
        max_calls=caps.calls,
        max_tokens=caps.tokens,
        max_seconds=caps.seconds,
        max_usd=caps.usd,
        concurrency=settings.concurrency,
        repeat=spec.repeat,
        prompts=settings.prompts,
        out=settings.out,
        command=reproduce(spec, asked),
        world=world,
    )


def method_options(asked: Mapping[str, Any], method: str) -> dict[str, Any]:
    """The options of a study that one of its methods takes: a detector is for those that look with one."""
    return {key: value for key, value in asked.items() if key != "detector" or registry.looks_with_detector(method)}


def reproduce(spec: TrialSpec, asked: Mapping[str, Any] | None = None) -> str:
    """The command that runs this trial again by itself; `asked` holds the options of its models."""
    condition = spec.condition
    chosen = choice_of(condition.model)
    named = {REST: chosen} if isinstance(chosen, str) else chosen
    by_role = [_of_role(role, name) for role, name in named.items()]
    levels = (asked or {}).get("thinking") or {}
    levels = {REST: levels} if isinstance(levels, str) else levels
    thinking = [word for role, level in levels.items() for word in ("--thinking", _of_role(role, level))]
    if condition.method in CONTROLS or condition.isolate or condition.perturb:
        words = ["bench", spec.task, "--seeds", str(spec.seed), "--no-control", "all", "--record", "full"]
        words += ["--isolate", condition.isolate] if condition.isolate else []
        words += ["--perturb", condition.perturb] if condition.perturb else []
        models = [] if condition.method in CONTROLS else ["--model", ",".join(by_role), *thinking]
    else:
        words = ["run", spec.task, "--seed", str(spec.seed)]
        models = [*(word for name in by_role for word in ("--model", name)), *thinking]
    replans = [
        "--replans",
        str(condition.replans),
        *(["--reobserve", str(condition.reobserve)] if condition.reobserve else []),
    ]
    timeout = (asked or {}).get("timeout")
    all_asked = ["--thorough"] if (asked or {}).get("thorough") and condition.method not in CONTROLS else []
    waits = [] if timeout is None or condition.method in CONTROLS else ["--timeout", f"{timeout:g}"]
    encoding = (asked or {}).get("encoding", "auto")
    waits += [] if encoding == "auto" or condition.method in CONTROLS else ["--encoding", encoding]
    detector = (asked or {}).get("detector")
    looks = ["--detector", detector] if detector and registry.looks_with_detector(condition.method) else []
    method = ["--method", condition.method, *looks]
    return shlex.join(["wonderful-team", *words, *replans, *method, *models, *waits, *all_asked])


def _of_role(role: str, value: str) -> str:
    return value if role == REST else f"{role}={value}"


def fingerprint(spec: TrialSpec, asked: Mapping[str, Any] | None = None) -> dict[str, str]:
    """What produced a result: package, commit, and hashes of the user's own files; `asked` holds the options of its models."""
    chosen = choice_of(spec.condition.model)
    models = [chosen] if isinstance(chosen, str) else list(chosen.values())
    detector = method_options(asked or {}, spec.condition.method).get("detector") or ""
    own = [name for name in (spec.task, spec.condition.method, *models, detector) if is_file_name(name)]
    return {**package_versions(), **{name: _file_hash(name) for name in own}}


@lru_cache
def package_versions() -> dict[str, str]:
    """Of this package, as results name it."""
    found = {name: str(value) for name, value in versions().items() if value is not None}
    return {"wonderful-team": __version__, **{k: v for k, v in found.items() if "commit" in k}}


@lru_cache
def _file_hash(name: str) -> str:
    path = user_path(name.rpartition(":")[0] or name)
    return hashlib.sha256(path.read_bytes()).hexdigest()[:12] if path.is_file() else "missing"
