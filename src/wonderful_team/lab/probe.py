"""The conversation with a model that finds out how it says where things are, and what its service can do."""

from __future__ import annotations

import asyncio
import datetime
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from wonderful_team.core.caps import Caps
from wonderful_team.core.values import Usage
from wonderful_team.errors import BudgetReached, ModelOutputError, WonderfulTeamError
from wonderful_team.images.cut import MARKED_SIDE_PX
from wonderful_team.lab.asking import Bench, MakeModel, Seen, convention_of, look
from wonderful_team.lab.fit import WILD, Fit, fit_convention
from wonderful_team.lab.limits import picture_limit, schema_kept, thinking_kind
from wonderful_team.lab.marks import MarkedScene, marked_scene
from wonderful_team.lab.measure import LabScene, measure_errors
from wonderful_team.models.budget import Budget
from wonderful_team.models.client import DEADLINE_S
from wonderful_team.models.conventions import CONVENTIONS, PIXELS, Convention, Resize, Size
from wonderful_team.models.profiles import FitFigures, Profile, clamp_words, convention_words
from wonderful_team.models.providers.facts import Facts

FIT_SIZES: tuple[Size, ...] = ((601, 461), (1563, 879), (1247, 1563))
"""Small and 4:3, wide, tall and large. The sides are far from multiples of 28 and 32, so that such a resize shows."""
CHECK_SIZES: tuple[Size, ...] = ((MARKED_SIDE_PX, 960), (MARKED_SIDE_PX, 640), (560, 540))
"""Pictures on which the fitted convention is checked, as the team sends them: main views of two shapes, enlarged, and a crop."""
LEAST_OVERLAP = 0.4
"""Least median overlap of its boxes with the marks for a model whose boxes are used."""
LEAST_BOXES = 0.6
"""Least share of the marks that must have a box overlapping them at all."""
TOO_WEAK = "no convention explains its answers: its own points and boxes are not used; labelled axes are drawn instead"

Tell = Callable[[str], None]


@dataclass(frozen=True)
class Probed:
    """What a probe found.

    Attributes:
        fits: Every fit that was tried, with how the model was asked.
        notes: What was found, in words, in order.
        stopped: Why it ended early (a cap); "" when it did not.
    """

    profile: Profile
    fits: tuple[tuple[str, Fit], ...]
    notes: tuple[str, ...]
    usage: Usage
    stopped: str = ""


@dataclass(frozen=True)
class Subject:
    """The model under test.

    Attributes:
        model: Its name, as `--model` takes it.
        make: Makes it, set up by a profile (services only) and a thinking level.
        provider: It is a service with a convention of its own.
        guess: What its name suggests.
        context: Finds out what the service says of the model's context.
        prices: US dollars per million tokens in and out.
    """

    model: str
    make: MakeModel
    provider: bool
    guess: Convention = PIXELS
    base_url: str | None = None
    context: Callable[[], Facts] = Facts
    prices: tuple[float | None, float | None] = (None, None)
    library: str = ""


@dataclass(frozen=True)
class Options:
    """How thoroughly to probe.

    Attributes:
        seed: Of the pictures.
        most_pictures: Largest request tried.
        full: Measure errors on `synthetic` drawn scenes and on `scenes` that the caller brings.
    """

    name: str = ""
    seed: int = 0
    most_pictures: int = 16
    full: bool = False
    synthetic: int = 12
    scenes: tuple[LabScene, ...] = ()
    caps: Caps = field(default_factory=Caps)
    concurrency: int = 4
    deadline_s: float = DEADLINE_S


async def probe(subject: Subject, options: Options, tell: Tell = lambda line: None) -> Probed:
    """Find out a model's convention, its service's limits, and with `full` its errors.

    A cap that is reached ends the probe; what was found until then stands, unless it is not even a convention.

    Raises:
        BudgetReached: A cap was reached before the convention was known.
        ModelOutputError: It pointed at nothing, however it was asked: nothing was measured.
        ConfigError, ModelUnavailableError: The model cannot be asked at all.
    """
    bench = Bench(
        subject.make,
        subject.provider,
        Budget(options.caps),
        concurrency=options.concurrency,
        deadline_s=options.deadline_s,
    )
    run = _Run(subject, options, bench, tell)
    stopped = ""
    try:
        profile = await run.convention()
        try:
            for step in (run.service, run.pictures, run.errors):
                profile = await step(profile)
        except BudgetReached as error:
            stopped = str(error)
            run.note(f"stopped early: {error}")
            profile = replace(profile, warnings=(*profile.warnings, f"the probe stopped early: {error}"))
    finally:
        await bench.aclose()
    seconds = [answer.usage.seconds for answer in bench.answers]
    latency = float(np.median(seconds)) if seconds else None
    models = [answer.model_id for answer in bench.answers if answer.model_id]
    profile = replace(
        profile, latency_s=None if latency is None else round(latency, 3), model_id=models[0] if models else ""
    )
    return Probed(profile, tuple(run.fits), tuple(run.notes), bench.budget.spent, stopped)


@dataclass
class _Run:
    """One probe under way."""

    subject: Subject
    options: Options
    bench: Bench
    tell: Tell
    fits: list[tuple[str, Fit]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def note(self, text: str) -> None:
        self.notes.append(text)
        self.tell(text)

    # -- the convention ---------------------------------------------------------------------------------------------

    async def convention(self) -> Profile:
        """The first convention that explains the answers and also holds on fresh pictures; else none."""
        blank = self._blank()
        scenes = self._scenes(FIT_SIZES, self.options.seed)
        why = ""
        for asked in self._askings():
            model = self.bench.model(replace(blank, convention=asked) if self.subject.provider else None)
            self.tell(f"asking for {sum(len(s.marks) for s in scenes)} marks in {convention_words(asked)} …")
            seen = await self._look_all(model, scenes)
            fit = fit_convention(
                [item.sighting(convention_of(model)) for item in seen], guess=self.subject.guess, shape=asked.shape
            )
            self.fits.append((convention_words(asked), fit))
            if not fit.good:
                why = fit.why
                self.note(f"asked for {convention_words(asked)}: {fit.why}")
                continue
            self.note(
                f"fits {convention_words(fit.convention)}: median {fit.median_px:.1f} px, 90 % within {fit.p90_px:.1f} px, "
                f"{fit.outliers} of {fit.answered} answers far off, {fit.answered} of {fit.asked} marks answered"
            )
            profile, why = await self._checked(blank, fit)
            if profile is not None:
                return profile
            self.note(f"but on fresh pictures, asked in that convention: {why}")
        return await self._weak(blank, why)

    def _blank(self) -> Profile:
        subject, prices = self.subject, self.subject.prices
        return Profile(
            self.options.name, subject.model, base_url=subject.base_url, usd_in=prices[0], usd_out=prices[1],
            probed=datetime.datetime.now(tz=datetime.UTC).date().isoformat(), library=subject.library,
        )  # fmt: skip

    def _askings(self) -> list[Convention]:
        """Conventions to ask in: what the name suggests first; pictures are never resized beforehand."""
        if not self.subject.provider:
            return [PIXELS]
        found: dict[tuple[str, str], Convention] = {}
        for row in (self.subject.guess, PIXELS, CONVENTIONS["qwen3-vl"], CONVENTIONS["gemini"]):
            found.setdefault((row.order, row.unit), Convention("asked", row.order, row.unit, shape=row.shape))
        return list(found.values())

    async def _look_all(self, model: object, scenes: Sequence[MarkedScene], labelled: bool = False) -> list[Seen]:
        return list(await asyncio.gather(*(look(self.bench, model, scene, labelled=labelled) for scene in scenes)))  # type: ignore[arg-type]

    def _scenes(self, sizes: Sequence[Size], seed: int) -> list[MarkedScene]:
        return [marked_scene(seed + k, size, name=f"picture {k + 1}") for k, size in enumerate(sizes)]

    async def _checked(self, blank: Profile, fit: Fit) -> tuple[Profile | None, str]:
        """Ask for fresh marks in the fitted convention, as in use. The profile, or why it does not hold."""
        convention, seen_resize = _within_probed(fit.convention)
        profile = replace(blank, convention=convention, resize_measured=seen_resize)
        model = self.bench.model(profile if self.subject.provider else None)
        seen = await self._look_all(model, self._scenes(CHECK_SIZES, self.options.seed + 100))
        median, answered, near, asked = _held(seen)
        if answered < 0.6 * asked:
            return None, f"only {answered} of {asked} marks were answered"
        if near < 0.7 * answered:
            return None, f"only {near} of {answered} answers lie within {100 * WILD:g} % of the diagonal"
        overlaps = np.concatenate([item.overlaps for item in seen])
        overlap = float(np.median(overlaps))
        boxes = overlap >= LEAST_OVERLAP and float(np.mean(overlaps > 0)) >= LEAST_BOXES
        figures = FitFigures(
            fit.asked, fit.answered, fit.outliers, round(fit.median_px, 2), round(fit.p90_px, 2), round(fit.worst_px, 2),
            round(median, 2), round(overlap, 3), fit.clamped,
        )  # fmt: skip
        self.note(f"holds on fresh pictures: median {median:.1f} px; boxes overlap by {overlap:.2f} (median)")
        warnings = []
        if not boxes:
            warnings.append(
                f"its points can be used, its boxes cannot (median overlap {overlap:.2f}, least {LEAST_OVERLAP}): "
                "labelled axes are drawn"
            )
            self.note(warnings[0])
        if fit.clamped is not None:
            warnings.append(f"it {clamp_words(fit.clamped)}: things at the edge may be off")
            self.note(warnings[-1])
        return replace(profile, native_boxes=boxes, axes=not boxes, fit=figures, warnings=tuple(warnings)), ""

    async def _weak(self, blank: Profile, why: str) -> Profile:
        """No convention: measure how well it reads labelled axes instead."""
        asked, answered, outliers = (sum(getattr(fit, name) for _, fit in self.fits[:1]) for name in ("asked", "answered", "outliers"))  # fmt: skip
        profile = replace(
            blank, convention=PIXELS, native_points=False, native_boxes=False, axes=True,
            fit=FitFigures(asked, answered, outliers), warnings=(f"{TOO_WEAK} ({why})",),
        )  # fmt: skip
        self.note(f"do not use native boxes: {TOO_WEAK} ({why})")
        model = self.bench.model(profile if self.subject.provider else None)
        try:
            seen = await self._look_all(model, self._scenes(CHECK_SIZES, self.options.seed + 200), labelled=True)
        except BudgetReached as error:
            return replace(profile, warnings=(*profile.warnings, f"labelled axes were not tried: {error}"))
        median, answered, near, asked = _held(seen)
        if not answered and not any(fit.answered for _, fit in self.fits):
            raise self._silent(seen)
        told = f"with labelled axes {near} of {asked} marks are pointed at" + (
            f", median {median:.1f} px" if near else ""
        )
        self.note(told)
        return replace(profile, warnings=(*profile.warnings, told))

    def _silent(self, seen: Sequence[Seen]) -> ModelOutputError:
        """It never pointed at any mark: there is nothing to keep."""
        marks = sum(fit.asked for _, fit in self.fits) + sum(len(item.scene.marks) for item in seen)
        why = next((item.problem for item in seen if item.problem), "its answers say that nothing is there")
        spent = self.bench.budget.spent
        return ModelOutputError(
            f"{self.subject.model} pointed at none of {marks} marks, asked in {len(self.fits)} conventions and with labelled "
            f"axes: nothing was measured, and no profile is kept ({spent.calls} calls, {spent.tokens:,} tokens; {why})"
        )

    # -- the service ------------------------------------------------------------------------------------------------

    async def service(self, profile: Profile) -> Profile:
        """Schemas, thinking, context length."""
        if not self.subject.provider:
            self.note("schemas, thinking, context length: not asked of a model that is no service")
            return profile
        schemas = await schema_kept(self.bench, profile, self.options.seed)
        self.note(f"schemas: {schemas}")
        thinking = await thinking_kind(self.bench, profile, self.options.seed)
        self.note(f"thinking: {thinking}")
        found = await asyncio.to_thread(self.subject.context)
        known = found.context is not None
        self.note(
            f"context: {found.context} tokens ({found.source})"
            if known
            else "context: unknown, the service does not say"
        )
        return replace(
            profile, schemas=schemas, thinking=thinking, context_tokens=found.context, context_source=found.source
        )

    async def pictures(self, profile: Profile) -> Profile:
        """How many pictures one request may hold."""
        most, reached = await picture_limit(
            self.bench, profile, self.options.most_pictures, self.options.seed, self.tell
        )
        words = (
            "all of one request are pasted on one sheet"
            if most == 1
            else "that is the limit"
            if reached
            else "more may fit"
        )
        self.note(f"pictures per request: {most} ({words})")
        if most == 1 and self.subject.provider:
            profile = replace(profile, max_pictures=1, max_pictures_reached=True)
            return await self._pasted(profile)
        return replace(profile, max_pictures=most, max_pictures_reached=reached)

    async def _pasted(self, profile: Profile) -> Profile:
        """Check that places are found on a sheet with several pictures."""
        scenes = self._scenes(((640, 480), (480, 640)), self.options.seed + 300)
        model = self.bench.model(profile)
        also = [marked_scene(self.options.seed + 310, (320, 240), absent=7, name="another").picture]
        try:
            seen = [await look(self.bench, model, scene, labelled=profile.axes, also=also) for scene in scenes]
        except BudgetReached:
            raise
        except WonderfulTeamError as error:
            return self._warned(profile, f"pictures pasted on one sheet were not answered: {error}")
        median, answered, near, asked = _held(seen)
        if near < 0.6 * asked:
            return self._warned(profile, f"on a sheet of several pictures only {near} of {asked} marks are found")
        self.note(f"on a sheet of several pictures: {near} of {asked} marks found, median {median:.1f} px")
        return profile

    def _warned(self, profile: Profile, text: str) -> Profile:
        self.note(text)
        return replace(profile, warnings=(*profile.warnings, text))

    async def errors(self, profile: Profile) -> Profile:
        """With `full`: how often and how far it errs, asked as in use."""
        if not self.options.full:
            return profile
        model = self.bench.model(profile if self.subject.provider else None)
        errors = await measure_errors(
            self.bench, model, self.options.synthetic, self.options.scenes, seed=self.options.seed + 1000,
            labelled=profile.axes, tell=self.tell,
        )  # fmt: skip
        return replace(profile, errors=errors)


def _held(seen: Sequence[Seen]) -> tuple[float, int, int, int]:
    """Median error of the near answers [px], answers, answers within WILD of the diagonal, marks."""
    errors = np.concatenate([item.errors_px for item in seen])
    limits = np.concatenate(
        [np.full(len(item.scene.marks), WILD * float(np.hypot(*item.scene.picture.size_px))) for item in seen]
    )
    answered = np.isfinite(errors)
    near = answered & (np.where(answered, errors, np.inf) <= limits)
    median = float(np.median(errors[near])) if near.any() else float("nan")
    return median, int(answered.sum()), int(near.sum()), len(errors)


def _within_probed(convention: Convention) -> tuple[Convention, bool]:
    """A convention in pixels, kept to the sizes that were probed, and whether a resize of the model's own was seen.

    Beyond those sizes a model may shrink pictures in a way that nobody has measured.
    """
    if convention.unit != "pixels":
        return convention, convention.resize is not None
    measured = convention.resize
    resize = measured or Resize()
    if resize.longest_side is None and resize.max_pixels is None:
        side, area = max(max(size) for size in FIT_SIZES), max(width * height for width, height in FIT_SIZES)
        resize = replace(resize, longest_side=-(-side // resize.multiple) * resize.multiple, max_pixels=area)
    return replace(convention, resize=resize), measured is not None
