"""A method by name: its model, its caps, its words; from the Python face and the command line alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

from wonderful_team import registry
from wonderful_team.agents.prompts import ROLES
from wonderful_team.core.caps import Caps
from wonderful_team.core.protocols import Detector, Model, Policy, Subscriber, World
from wonderful_team.core.renamed import renamed_attribute
from wonderful_team.core.values import AskUser
from wonderful_team.errors import ConfigError
from wonderful_team.models.cache import CacheMode, cached_models
from wonderful_team.models.cache_key import model_identity
from wonderful_team.models.client import DEADLINE_S, ModelClient
from wonderful_team.models.providers import PriceChoice, check_prices, model_options
from wonderful_team.planning import TeamConfig
from wonderful_team.registry.simulated import waiting

ModelChoice = str | Model | Mapping[str, str | Model]
POINTING_ROLES = tuple(name for name, role in ROLES.items() if role.points)
"""Who gives points and boxes on whole views."""


@dataclass
class Method:
    """A method by name, with its model and its caps, not yet at work.

    Args:
        model: A name (`offline`, FILE.py:NAME), an object with `answer(request)`, or a mapping from role to either;
            "*" is for the roles not named. Rivals have roles of their own, such as the `selector` of `pivot`.
        method: One that `list methods` shows (team, team:paper, team:s1 to team:s8, …), or FILE.py:NAME.
        thinking: off, low, medium or high, for all roles or by role; None leaves each model's own default.
        price: "IN,OUT" or (IN, OUT) in USD per million tokens, for all roles or by role, where no price is known.
        allow_unpriced: Accept models of unknown price without a cap on tokens.
        local_only: Refuse models outside this machine and private networks.
        timeout: Longest wait for one reply of a model [s]; None: 150 s, with thinking 300 s, and more once a service has shown
            that it takes longer; for own models 300 s.
        encoding: Files that pictures are sent to services as: auto (photos without tick labels as JPEG, all else as PNG), png, jpeg.
        max_calls, max_tokens, max_usd: Caps of one plan or trial; None for no cap.
        max_seconds: Longest time of one plan or trial: models, the method, the world, drawing and judging; None for no cap. A call
            that does not come back is left behind in its thread, and `stop()` of the world is called. So with this cap a world's
            methods run in one thread of their own.
        concurrency: Most calls in flight at once.
        cache: on, off or only (never call a model); None: on for vendors and servers, off for `offline` and own models.
        cache_file: Where answers are kept; default $WONDERFUL_TEAM_CACHE, else the user's cache folder.
        repeat: Number of this repetition: repetitions do not share kept answers.
        prompts: A folder with your own words for the team's roles.
        strict: Refuse a plan that Verification did not approve.
        detector: Who finds things by words for methods that look with a detector: a name that `list detectors` shows, FILE.py:NAME,
            or an object with `detect(rgb, words)`; None for `classical`.
        thorough: The lean team asks every question, however plain the scene: slower and dearer, for models that see badly.
        ask: Called with a question and its choices when neither picture nor instruction settles what is meant; what it returns is
            what the user answered, and planning goes on with it. None, or no answer: the plan ends as needs_clarification.
        out: Where run folders go; default $WONDERFUL_TEAM_RUNS or `runs`.
        subscribers: Told of every event as it happens.
        command: The command line that reproduces the run, for the page.
        parent: Which run this one branches off, and at which stage.
        world: Whose truth a `simulated:` model answers from, and a method marked PRIVILEGED is told; `wt.rollout(method, world)` passes it by itself.

    Raises:
        ConfigError: An unknown name or a value out of range; before anything is sent.
    """

    model: ModelChoice = "offline"
    method: str = "team"
    max_calls: int | None = None
    max_tokens: int | None = None
    max_seconds: float | None = None
    max_usd: float | None = None
    concurrency: int = 8
    cache: CacheMode | None = None
    cache_file: str | Path | None = None
    repeat: int = 0
    prompts: str | Path | None = None
    strict: bool = False
    thorough: bool = False
    out: str | Path | None = None
    subscribers: Sequence[Subscriber] = ()
    command: str | None = None
    parent: Mapping[str, str] | None = None
    thinking: str | Mapping[str, str] | None = None
    price: PriceChoice | Mapping[str, PriceChoice] | None = None
    allow_unpriced: bool = False
    local_only: bool = False
    timeout: float | None = None
    encoding: str = "auto"
    world: World | None = None
    detector: str | Detector | None = None
    ask: AskUser | None = None

    def __post_init__(self) -> None:
        self._config = team_config(self.method, self.prompts, self.strict, self.thorough)
        self._check_detector()
        roles = registry.roles_of(self.method)
        for chosen in (self.model, self.thinking, self.price):
            registry.check_roles(self.method, chosen if isinstance(chosen, Mapping) else ())
        options = model_options(self.thinking, self.price, self.local_only, roles, self.timeout, self.encoding)
        made = registry.make_models(self.model, roles, options, self.world)
        if self._config is not None and any(getattr(made[role], "weak_pointing", False) for role in POINTING_ROLES):
            self._config = replace(self._config, axes=True)
        self._models, self._store = cached_models(made, self.cache, self.cache_file, repeat=self.repeat)
        self._caps = Caps(self.max_calls, self.max_tokens, self.max_seconds, self.max_usd)
        if self.cache != "only":
            check_prices(made.values(), self._caps, self.allow_unpriced)
        self._label = registry.model_label(_known_names(self.model, made))

    @property
    def name(self) -> str:
        """What records call the method."""
        return self.method

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the user should know of the set-up, in words."""
        notes = dict.fromkeys(str(getattr(model, "note", "")) for model in self._models.values())
        told = [f"PRIVILEGED: method {self.method!r} is told a simulator's truth"] if self._privileged else []
        return (*told, *(note for note in notes if note), *(() if self._store is None else self._store.warnings))

    @property
    def _privileged(self) -> bool:
        row = registry.method_row(self.method)
        return row is not None and row.privileged

    @property
    def model_name(self) -> str:
        """What records call the model."""
        return self._label

    def in_world(self, world: World) -> Self:
        """The same method, with the world's truth for a simulated model that still waits for one, or a PRIVILEGED method.

        Raises:
            ConfigError: The world has no truth, or its instruction was replaced.
        """
        if waiting(self._models) is None and not self._privileged:
            return self
        bound = replace(self, world=world)
        if self._privileged:
            # Made once for nothing: a world without the truth that the method is told is refused before anything runs.
            bound.policy()
        return bound

    def check_ready(self) -> None:
        """Raises ConfigError when a simulated model has no world to answer from."""
        name = waiting(self._models)
        if name is not None:
            raise ConfigError(
                f"model {name!r} answers from a simulator's truth, and a picture alone has none: pass the world, as in "
                f"wt.Team(model={name!r}, world=world), or run it with wt.rollout(team, world)"
            )

    door = renamed_attribute("door", "client")

    def client(self, *subscribers: Subscriber) -> ModelClient:
        """A client of the model for one run: capped, and told to subscribers."""
        return self._setup(subscribers).client()

    def policy(self, *subscribers: Subscriber) -> Policy:
        """The method at work in one trial."""
        return registry.make_method(self.method, self._setup(subscribers))

    def _check_detector(self) -> None:
        """Names and weights are wrong before anything is sent, never in the middle of a run."""
        row = registry.method_row(self.method)
        if self.detector is not None and not registry.looks_with_detector(self.method):
            looking = ", ".join(name for name, one in registry.METHODS.items() if one.detects)
            raise ConfigError(
                f"method {self.method!r} looks with no detector, so a detector changes nothing; methods that do: {looking}"
            )
        if row is not None and row.detects:
            self.make_detector()

    def make_detector(self) -> Detector:
        """The detector that was chosen; weights are loaded once for each name."""
        return registry.make_detector(registry.DEFAULT_DETECTOR if self.detector is None else self.detector)

    def _setup(self, subscribers: Sequence[Subscriber]) -> registry.MethodSetup:
        # Roles that are not the team's have the model of the roles that are not named.
        named = self.model if isinstance(self.model, Mapping) else {}
        rest = next(iter([role for role in self._models if role not in named] or self._models))
        everyone = (*subscribers, *self.subscribers)
        return registry.MethodSetup(
            self._models, self._models[rest], self._caps, everyone, self.concurrency, self._config,
            self.timeout or DEADLINE_S, self.make_detector, self.world if self._privileged else None, self.ask,
        )  # fmt: skip

    def words(self) -> Mapping[str, str]:
        """The words of the roles, by file name; none for a method of one's own."""
        return {} if self._config is None else self._config.prompts.files()

    def configuration(self) -> dict[str, Any]:
        """What the record says of how a run was set up."""
        caps = {"calls": self.max_calls, "tokens": self.max_tokens, "seconds": self.max_seconds, "usd": self.max_usd}
        return {
            "method": self.method,
            "model": self.model_name,
            "caps": caps,
            "concurrency": self.concurrency,
            "thinking": dict(self.thinking) if isinstance(self.thinking, Mapping) else self.thinking,
            "local_only": self.local_only,
            "timeout": self.timeout,
            "encoding": self.encoding,
            "axes": self._config is not None and self._config.axes,
            "models": {
                role: model_identity(model) for role, model in self._models.items() if hasattr(model, "identity")
            },
            "cache": "off" if self._store is None else (self.cache or "on"),
            "repeat": self.repeat,
            "strict": self.strict,
            "thorough": self.thorough,
            "prompts": None if self._config is None else self._config.prompts.hash,
            **self._grounding(),
            **({} if self.parent is None else {"parent": dict(self.parent)}),
        }

    def _grounding(self) -> dict[str, Any]:
        """Who says where targets are, where that is not the grounding team; and which detector looks."""
        told: dict[str, Any] = {}
        if self._config is not None and self._config.grounding != "team":
            told["grounding"] = self._config.grounding
        row = registry.method_row(self.method)
        if self.detector is not None or (row is not None and row.detects):
            chosen = registry.DEFAULT_DETECTOR if self.detector is None else self.detector
            told["detector"] = registry.detector_label(chosen)
        return told


def team_config(
    method: str, prompts: str | Path | None = None, strict: bool = False, thorough: bool = False
) -> TeamConfig | None:
    """The configuration that a `team…` name means; None for a method of one's own.

    Raises:
        UnknownNameError: Not a name of the team.
    """
    from wonderful_team.agents import Prompts

    mode = registry.team_mode(method)
    if mode is None:
        return None
    words = Prompts.default() if prompts is None else Prompts.load(Path(prompts))
    return TeamConfig(
        mode=mode.mode,
        ablation=mode.ablation,
        grounding=mode.grounding,
        strict=strict,
        thorough=thorough,
        prompts=words,
    )


def _known_names(model: ModelChoice, made: Mapping[str, Model]) -> ModelChoice:
    """The choice with the names that servers gave for addresses without #NAME."""
    if isinstance(model, Mapping):
        rest = next((role for role in made if role not in model), None)
        by_role = {role: made[rest] if role == "*" and rest else made.get(role) for role in model}
        return {role: _known_name(named, by_role[role]) for role, named in model.items()}
    return _known_name(model, next(iter(made.values())))


def _known_name(named: str | Model, made: Model | None) -> str | Model:
    return named if made is None or not isinstance(named, str) else str(getattr(made, "name", named))
