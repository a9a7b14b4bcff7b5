"""`probe` in Python: from a model's name to what it can do, measured."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wonderful_team import registry
from wonderful_team.core.caps import Caps
from wonderful_team.core.deadline import bounded, limited
from wonderful_team.core.protocols import Model, privileged
from wonderful_team.core.values import Usage
from wonderful_team.errors import ConfigError
from wonderful_team.lab.measure import LabScene, LabTarget
from wonderful_team.lab.probe import Options, Probed, Subject, Tell, probe
from wonderful_team.models.client import DEADLINE_S
from wonderful_team.models.families import guess_family
from wonderful_team.models.profiles import Profile, check_name, load_profile, profile_names
from wonderful_team.models.providers.server_facts import server_facts
from wonderful_team.registry.files import is_file_name
from wonderful_team.runtime.loop import Caller

if TYPE_CHECKING:
    from wonderful_team.models.providers import Provider

RENDERED_TASKS = ("tabletop/visual_manipulation", "tabletop/rotate", "tabletop/scene_understanding")
MILLION = 1_000_000
TRIES = 3
"""Most tries at one request: a probe should not wait long for a service that fails."""


def probe_model(
    model: str | Model,
    *,
    save: str | None = None,
    full: bool = False,
    scenes: int = 12,
    rendered: int = 4,
    seed: int = 0,
    most_pictures: int = 16,
    price: str | None = None,
    allow_unpriced: bool = False,
    local_only: bool = False,
    max_calls: int | None = None,
    max_tokens: int | None = None,
    max_seconds: float | None = None,
    max_usd: float | None = None,
    timeout: float | None = None,
    encoding: str = "auto",
    concurrency: int = 4,
    tell: Tell = lambda line: None,
) -> Probed:
    """Measure a model. The profile is returned, not written; `models.profiles.save_profile` keeps it.

    Args:
        model: A name as `--model` takes it (a saved profile is measured anew), or an object with `answer(request)`.
        save: Name of the profile.
        full: Measure errors too.
        scenes: How many drawn scenes they are measured on.
        rendered: How many rendered scenes they are measured on as well.
        seed: Of all pictures.
        most_pictures: Largest request that is tried.
        price: "IN,OUT" in US dollars per million tokens.
        allow_unpriced: Accept a model of unknown price without a cap on tokens.
        local_only: Refuse models outside this machine and private networks.
        max_calls: Cap on calls.
        max_tokens: Cap on tokens.
        max_seconds: Cap on the time of all: models, what a server says of itself, drawing.
        max_usd: Cap on money.
        timeout: Longest wait for one reply [s]; None: as `Method` has it.
        encoding: Of pictures' files: auto, png or jpeg.
        concurrency: Most calls at once.
        tell: Given one line at a time, as things are found.

    Raises:
        ConfigError: A wrong name, key or option; an unknown price without a cap.
        ModelUnavailableError: The service does not answer.
        BudgetReached: A cap was met before even the convention was known.
        ModelOutputError: It pointed at nothing, however it was asked.
    """
    if save is not None:
        check_name(save)
    caps = Caps(max_calls, max_tokens, max_seconds, max_usd)
    with limited(max_seconds):
        subject = _subject(model, price, local_only, timeout, caps, allow_unpriced, encoding)
        shown = bounded("drawing scenes", rendered_scenes, rendered, seed) if full else ()
        options = Options(
            save or "", seed, most_pictures, full, scenes, shown, caps, concurrency, timeout or DEADLINE_S,
        )  # fmt: skip
        with Caller() as caller:
            probed: Probed = caller.wait_for(probe(subject, options, tell), "probing")
        return probed


def _subject(
    model: str | Model,
    price: str | None,
    local_only: bool,
    timeout_s: float | None,
    caps: Caps,
    allow_unpriced: bool,
    encoding: str,
) -> Subject:
    from wonderful_team.models.providers import check_prices, is_provider_spec, make_provider, model_options
    from wonderful_team.models.providers.library import library_version

    named: str | Model = model
    if isinstance(model, str) and not is_file_name(model) and model in profile_names():
        named = registry.named_by_profile(load_profile(model))
    if not isinstance(named, str) or not is_provider_spec(named):
        held = registry.make_model(named)
        return Subject(registry.model_label(named), lambda profile, thinking: held, provider=False)
    name = named
    options = model_options(None, price, local_only, (), timeout_s, encoding)
    given = options.price_of("*")

    def make(profile: Profile | None, thinking: Any) -> Provider:
        return make_provider(
            name,
            profile=profile,
            thinking=thinking,
            price=given,
            local_only=local_only,
            timeout_s=timeout_s,
            encoding=options.encoding,
            tries=TRIES,
        )

    first = make(None, None)
    check_prices([first], caps, allow_unpriced)
    spec, served = first.spec, first.model
    family = guess_family(served)
    full_name = name if spec.model else f"{spec.base_url}#{served}"
    # The server was asked for its model once; from here on it is named.
    name = full_name
    prices = [first.prices.usd(usage) for usage in (Usage(tokens_in=MILLION), Usage(tokens_out=MILLION))]
    return Subject(
        full_name, make, True, family.convention,
        None if spec.official else spec.base_url,
        lambda: server_facts(spec.service, spec.base_url, served, first.key, direct=local_only),
        (prices[0], prices[1]), library_version(),
    )  # fmt: skip


def rendered_scenes(count: int, seed: int) -> tuple[LabScene, ...]:
    """Rendered table tops whose truth is known: every thing that a colour and a shape tell from all others.

    Args:
        count: How many.
        seed: Of the first; seeds below 1000 are for development, and so are these scenes.
    """
    return tuple(_rendered(RENDERED_TASKS[k % len(RENDERED_TASKS)], seed + k) for k in range(count))


def _rendered(task: str, seed: int) -> LabScene:
    from wonderful_team.core.geometry import Box

    world = registry.make_world(task, seed=seed)
    try:
        view = world.observe().main
        truth = privileged(world)
        if truth is None:
            raise ConfigError(f"{task}: this world keeps no truth to measure against")
        things, masks = truth.truth()["things"], world.privileged.masks()  # type: ignore[attr-defined]
    finally:
        world.close()
    words = {name: f"{thing['texture']} {thing['shape']}" for name, thing in things.items()}
    targets = []
    for name, mask in masks.items():
        if not mask.any() or list(words.values()).count(words[name]) > 1:
            continue
        rows, columns = mask.nonzero()
        box = Box(float(columns.min()), float(rows.min()), float(columns.max() + 1), float(rows.max() + 1))
        middle = (float(columns.mean()) + 0.5, float(rows.mean()) + 0.5)
        targets.append(LabTarget(words[name], box, middle))
    absent = next((f"{colour} star" for colour in ("pink", "cyan") if f"{colour} star" not in words.values()), None)
    return LabScene(view, tuple(targets), (absent,) if absent else (), f"rendered {task}", seed)


__all__ = ["Probed", "probe_model", "rendered_scenes"]
