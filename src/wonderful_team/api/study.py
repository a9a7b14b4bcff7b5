"""`wt.Study`: any methods x any models x suites x seeds in one store, with a report. The command `bench` is made of it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from wonderful_team import registry
from wonderful_team.api.known_suites import check_levels, check_scenes, known_suites, methods_of, photo_counts
from wonderful_team.api.shipping import shipment_of
from wonderful_team.api.trial import check_isolation, check_names, code_of_names, run_trial
from wonderful_team.core.caps import Caps
from wonderful_team.core.renamed import renamed_arguments
from wonderful_team.core.text import counted
from wonderful_team.errors import ConfigError
from wonderful_team.evals.controls import CONTROLS
from wonderful_team.evals.estimate import Estimate, estimate
from wonderful_team.evals.monitor import Report
from wonderful_team.evals.perturb import read_tiers
from wonderful_team.evals.plan import OFFLINE, WHOLE, StudyPlan, of_photos, read_shard, split_names
from wonderful_team.evals.pointing_sets import set_suites
from wonderful_team.evals.processes import started_by_spawn
from wonderful_team.evals.shipment import Shipment
from wonderful_team.evals.store import Store
from wonderful_team.evals.study import StudyResult, run_study
from wonderful_team.evals.suites import read_seeds, resolve
from wonderful_team.evals.summary import Summary, summarise
from wonderful_team.evals.trials import RECORDED, Condition, Recorded, RunSettings, TrialRow, TrialSpec
from wonderful_team.evals.workers import run_safely
from wonderful_team.models.cache import CacheMode
from wonderful_team.models.providers import PriceChoice
from wonderful_team.record.run_folders import runs_folder
from wonderful_team.registry.files import is_file_name
from wonderful_team.registry.role_models import choice_of, read_choices, read_roles, text_of

ALL_CONTROLS = (*CONTROLS, OFFLINE)
PILOT = 6
"""Pilot trials of a condition that costs nothing."""
FREE = ("-", OFFLINE)
"""Models whose pilot trials cost no money; simulated ones beside them."""

_OF_MODELS = ("allow_unpriced", "local_only", "timeout", "encoding", "cache", "cache_file", "detector", "thorough")
_SAME_AS_OPTIONS = (
    *("repeats", "replans", "reobserve", "isolate", "perturb", "concurrency", "record", "out", "prompts"),
    *("jobs", "at_once", "ray", "ship", "retry_errors"),
    *_OF_MODELS,
)
"""Options of `bench` that a study takes as they are."""


@renamed_arguments(looks="reobserve", pages="record")
@dataclass
class Study:
    """A comparison.

    Args:
        suite: A suite, a task, FILE.py:TASK, PHOTOS.json, or several.
        methods, models: A name or several; objects cannot be sent to worker processes. Methods are by default those that the suite
            compares, else the team; "team:-each" is the team, and it without each member in turn. A model may be a mapping from
            role to name, with "*" for the rest.
        seeds: For every task; None for the suite's own, from 1000 on.
        store: File that keeps what ended; the same study on the same file resumes.
        repeats, replans, reobserve, shard: As `bench` has them.
        isolate: whole, planning, grounding: one or several. perturb: KIND=LEVEL: one or several; "" is the scene as it is.
        thinking, price, allow_unpriced, local_only, timeout, encoding, cache, cache_file, prompts, thorough: As `Method` takes them.
        detector: Its name, for methods that look with one.
        photo_set, set_format: With the suites pointing and boxcheck: pictures of your own instead of the toy table, and how they are written
            (where2place, refspatial, coco; None: as their files show).
        controls: Those that run beside the methods; () refuses them all.
        caps: Of the whole study. trial_caps: of each trial.
        concurrency: Most model calls at once, over all workers.
        record: Which trials keep their run folder with record, pictures and page: full, failures (those that did not succeed) or
            none; what ended stands in the store all the same. `pages` with "all" is its old name.
        ray: Address of a Ray cluster whose workers run the trials; "auto" or "local" (docs/benchmarking.md). jobs are then its workers.
        ship: With ray: files and folders that your own code reads, beside those that the study names.

    Raises:
        ConfigError: A name or a value that is not valid; before anything runs.
    """

    suite: str | Sequence[str]
    methods: str | Sequence[str] = ()
    models: str | Mapping[str, str] | Sequence[str | Mapping[str, str]] = (OFFLINE,)
    seeds: Iterable[int] | None = None
    store: str | Path = "study.db"
    repeats: int = 1
    replans: int | None = None
    reobserve: int = 0
    isolate: str | Sequence[str] = ""
    perturb: str | Sequence[str] = ""
    shard: tuple[int, int] = (1, 1)
    controls: Sequence[str] = ALL_CONTROLS
    caps: Caps = Caps()
    trial_caps: Caps = Caps()
    concurrency: int | None = None
    record: Recorded = "failures"
    out: str | Path | None = None
    prompts: str | Path | None = None
    thinking: str | Mapping[str, str] | None = None
    price: PriceChoice | Mapping[str, PriceChoice] | None = None
    allow_unpriced: bool = False
    local_only: bool = False
    timeout: float | None = None
    encoding: str = "auto"
    cache: CacheMode | None = None
    cache_file: str | Path | None = None
    detector: str | None = None
    jobs: int | None = None
    at_once: int = 1
    ray: str | None = None
    ship: Sequence[str | Path] = ()
    retry_errors: bool = False
    command: str = ""
    thorough: bool = False
    photo_set: str | Path | None = None
    set_format: str | None = None

    def __post_init__(self) -> None:
        words = _listed(self.suite)
        self.methods = registry.each_member(_listed(self.methods) or methods_of(words))
        self.controls = _listed(self.controls)
        self.models = [self.models] if isinstance(self.models, str | Mapping) else list(self.models)
        self.record = new_name_of(self.record)
        if self.ship and self.ray is None:
            raise ConfigError("what is shipped goes to the workers of a cluster: name it with --ray ADDRESS")
        if isinstance(self.seeds, int):
            raise ConfigError(
                f"seeds {self.seeds}: valid is a sequence, as in range(1000, 1020), or None for the suite's own"
            )
        models = [text_of(one) if isinstance(one, Mapping) else one for one in self.models]
        for name in (*self.methods, *models):
            if not isinstance(name, str):
                raise ConfigError(f"a study takes names, as in FILE.py:NAME; got a {type(name).__name__}")
        unknown = [name for name in self.controls if name not in ALL_CONTROLS]
        if unknown:
            raise ConfigError(f"control {unknown[0]!r}: valid are {', '.join(ALL_CONTROLS)}")
        tiers = read_tiers(_listed(self.perturb))
        if self.set_format is not None and self.photo_set is None:
            raise ConfigError(f"--format {self.set_format} says how a set of pictures is written: name it with --set")
        if self.photo_set is None:
            suites = resolve(words, list(registry.task_names()), known_suites(), is_file_name)
        else:
            suites = set_suites(words, Path(self.photo_set).absolute(), self.set_format)
        check_levels(suites)
        check_scenes(suites, tiers)
        if self.detector is not None and not any(map(registry.looks_with_detector, self.methods)):
            raise ConfigError(
                f"detector {self.detector!r}: none of the methods looks with one: {', '.join(self.methods)}"
            )
        check_names(self.methods, models, self._asked(), self.trial_caps.tokens or self.caps.tokens)
        parts = tuple("" if name == WHOLE else name for name in split_names(_listed(self.isolate))) or ("",)
        for part in parts:
            if part:
                check_isolation(part, self.methods)
        self.plan = StudyPlan(
            suites,
            tuple(self.methods),
            tuple(models),
            None if self.seeds is None else tuple(self.seeds),
            self.repeats,
            tuple(self.controls),
            tuple(dict.fromkeys(parts)),
            tiers,
            self.replans,
            self.shard,
            self._how(),
            self.reobserve,
            {"command": self.command, **photo_counts(suites)},
        )
        self.store = sharded(Path(self.store), self.shard)

    @classmethod
    def from_options(cls, **options: Any) -> Study:
        """A study from the options of `bench`."""
        refused = split_names(options["refused"])
        wrong = [name for name in refused if name not in (*ALL_CONTROLS, "all")]
        if wrong:
            raise ConfigError(f"--no-control {wrong[0]}: valid are {', '.join(ALL_CONTROLS)}, all")
        return cls(
            options["suites"],
            split_names(options["methods"]),
            read_choices(options["models"], OFFLINE),
            None if options["seeds"] is None else read_seeds(options["seeds"]),
            options["store"],
            shard=(1, 1) if options["shard"] is None else read_shard(options["shard"]),
            controls=() if "all" in refused else tuple(name for name in ALL_CONTROLS if name not in refused),
            caps=Caps(options["max_calls"], options["max_tokens"], options["max_seconds"], options["max_usd"]),
            trial_caps=Caps(*(options[f"trial_max_{name}"] for name in ("calls", "tokens", "seconds", "usd"))),
            thinking=read_roles(options["thinking"], "--thinking", "LEVEL"),
            price=read_roles(options["price"], "--price", "IN,OUT"),
            command=options.get("command", ""),
            photo_set=options.get("photo_set"),
            set_format=options.get("set_format"),
            **{name: options[name] for name in _SAME_AS_OPTIONS},
        )

    @property
    def notes(self) -> list[str]:
        """What is not whole of the suites."""
        return [f"{suite.name}: {suite.note}" for suite in self.plan.suites if suite.note]

    def _settings(self) -> RunSettings:
        prompts = None if self.prompts is None else Path(self.prompts)
        out = runs_folder(self.out).absolute()
        tasks = [task for suite in self.plan.suites for task in suite.tasks]
        named = code_of_names((*tasks, *self.plan.methods), self.plan.models)
        return RunSettings(
            self.trial_caps, self.concurrency or 8, self.record, out, prompts, extra=self._asked(), named_code=named
        )

    def _asked(self) -> dict[str, Any]:
        """Options of the models and the team, as `Method` takes them."""
        asked = {name: getattr(self, name) for name in _OF_MODELS}
        if self.ray is not None and self.cache_file is not None:
            asked["cache_file"] = Path(self.cache_file).absolute()  # workers start in a folder that ends with the study
        return {"thinking": self.thinking or None, "price": self.price or None, **asked}

    def _how(self) -> str:
        """What of the options makes a trial another one, in words: it is part of what the store knows a trial by."""
        levels = {"*": self.thinking} if isinstance(self.thinking, str) else dict(self.thinking or {})
        said = [
            f"thinking {level}" if role == "*" else f"{role} thinking {level}" for role, level in sorted(levels.items())
        ]
        if self.encoding != "auto":
            said.append(f"pictures as {self.encoding}")
        if self.thorough:
            said.append("thorough")
        if self.prompts is not None:
            from wonderful_team.agents import Prompts

            said.append(f"own words {Prompts.load(Path(self.prompts)).hash[:8]}")
        said += [f"detector {self.detector}"] if self.detector else []
        units = {"calls": "calls", "tokens": "tokens", "seconds": "s", "usd": "USD"}
        said += [f"at most {value:g} {units[name]}" for name, value in self.trial_caps.given.items()]
        return ", ".join(said)

    def run(self, report: Report = lambda text, status: None) -> StudyResult:
        """Run what is missing; `report` is told how it goes.

        Raises:
            KeyboardInterrupt: After the trials in flight; the same study goes on where it stopped.
        """
        tasks = [task for suite in self.plan.suites for task in suite.tasks]
        needs_main = any(registry.made_in_main(task) for task in tasks)
        if needs_main and started_by_spawn():
            raise ConfigError(
                "a study of tasks that stand in the script itself starts processes that run the script again: put "
                'study.run() under if __name__ == "__main__":, or the tasks into a file of their own (FILE.py:NAME)'
            )
        return run_study(
            self.plan,
            self.store,
            run_trial,
            settings=self._settings(),
            caps=self.caps,
            jobs=self.jobs,
            at_once=self.at_once,
            calls_at_once=self.concurrency,
            retry_errors=self.retry_errors,
            ray=self.ray,
            shipment=None if self.ray is None else self._shipment(),
            needs_main=needs_main,
            report=report,
        )

    def _shipment(self) -> Shipment:
        prompts = None if self.prompts is None else Path(self.prompts)
        max_tokens = self.trial_caps.tokens or self.caps.tokens
        return shipment_of(self.plan, self._asked(), max_tokens, prompts, self.ship)

    def estimate(self, pilot: int = PILOT, paid_pilot: bool = False) -> Estimate:
        """What it would take, from what the store holds and a few pilot trials on development seeds.

        Args:
            pilot: Pilot trials for each condition of which nothing is recorded, spread over the tasks of a suite.
            paid_pilot: Run them also for models that may cost money.
        """
        path = Path(self.store)
        rows = []
        if path.is_file():
            with Store(path) as store:
                rows = store.rows()
        known = {row.spec.condition for row in rows if row.result is not None}
        pilots: dict[Condition, list[TrialRow]] = {}
        with tempfile.TemporaryDirectory() as scratch:
            self._run_pilots(pilots, known, pilot, paid_pilot, replace(self._settings(), out=Path(scratch)))
        return estimate(self.plan, rows, pilots, (self.jobs or os.cpu_count() or 1) * self.at_once)

    def _run_pilots(
        self,
        pilots: dict[Condition, list[TrialRow]],
        known: set[Condition],
        pilot: int,
        paid_pilot: bool,
        settings: RunSettings,
    ) -> None:
        for suite in self.plan.suites:
            for condition in self.plan.conditions(suite):
                if condition in known or condition in pilots or not (paid_pilot or _is_free(condition.model)):
                    continue
                # Photos have numbers instead of seeds: there is no development set of them.
                last = len(self.plan.seeds_of(suite)) if of_photos(suite) else pilot
                tasks = [suite.tasks[k * len(suite.tasks) // pilot] for k in range(pilot)]
                specs = [TrialSpec(task, k % last, condition) for k, task in enumerate(tasks)]
                pilots[condition] = [run_safely(run_trial, spec, settings) for spec in dict.fromkeys(specs)]

    def summary(self) -> Summary:
        """The figures so far, of this study's trials alone."""
        with Store(self.store, must_exist=True) as store:
            return summarise(store.rows(self.plan.name), [self.plan.request()])

    def lines(self) -> list[str]:
        """The figures so far as text: one line per condition, then the answer."""
        summary = self.summary()
        conditions = (*summary.compared, *summary.bounds)
        width = max((len(one.label) for one in conditions), default=0)
        found = []
        for one in conditions:
            cell = summary.cell(one)
            rest = "".join(f"  {cell.count(name)} {name}" for name in ("error", "unscored") if cell.count(name))
            badges = f"  [{', '.join(cell.badges)}]" if cell.badges else ""
            found.append(f"{one.label:<{width}}  {cell.rate}{rest}{badges}")
        return [*found, *summary.headline(), *(f"warning: {text}" for text in summary.warnings())]

    def kept_line(self) -> str:
        """How many trials keep their run folder, and how to see those that do not."""
        with Store(self.store, must_exist=True) as store:
            ended = [row for row in store.rows(self.plan.name) if row.result is not None]
        kept = sum(bool(row.result.page) for row in ended if row.result is not None)
        more = "" if kept == len(ended) else f"; how to run the others again: wonderful-team show {self.store}"
        return f"records: {kept} of {counted(len(ended), 'trial')} keep a run folder (--record {self.record}){more}"

    def report(self, path: str | Path, baseline: str | None = None) -> Path:
        """Write the page; its CSV and LaTeX tables lie beside it."""
        from wonderful_team.evals.report import write_all

        return write_all([self.store], path, baseline=baseline).page

    def to_pandas(self) -> Any:
        """One line per trial of the store, as a pandas frame."""
        from wonderful_team.evals.report.tables import to_frame

        with Store(self.store, must_exist=True) as store:
            return to_frame(store.rows())

    def to_json(self, ended: StudyResult) -> dict[str, Any]:
        """For machines: the figures per condition."""
        from wonderful_team.evals.report.tables import condition_json

        summary = self.summary()
        return {
            "store": str(self.store),
            "total": ended.status.total,
            "done": ended.status.done,
            "stopped": ended.why,
            "conditions": [condition_json(summary.cell(one)) for one in (*summary.compared, *summary.bounds)],
            "answer": summary.headline(),
            "warnings": summary.warnings(),
        }


def _listed(words: str | Sequence[str]) -> list[str]:
    return [words] if isinstance(words, str) else list(words)


def new_name_of(record: str) -> Recorded:
    """Which trials keep their run folder, "all" being the old name of "full".

    Raises:
        ConfigError: Another word.
    """
    word = "full" if record == "all" else record
    for one in RECORDED:
        if one == word:
            return one
    raise ConfigError(f"record {record!r}: valid are {', '.join(RECORDED)}")


def _is_free(text: str) -> bool:
    chosen = choice_of(text)
    names = [chosen] if isinstance(chosen, str) else list(chosen.values())
    return all(name in FREE or name.startswith("simulated:") for name in names)


def sharded(store: Path, shard: tuple[int, int]) -> Path:
    """The store file of a shard: `study.db` becomes `study.1-of-4.db`."""
    return store if shard[1] == 1 else store.with_name(f"{store.stem}.{shard[0]}-of-{shard[1]}{store.suffix}")
