"""How often the whole chain solves a task when the model makes no errors: subgoals, targets, frames, motion and gate.

Run: python benchmarks/perfect.py [--world tabletop|vimabench] [--first 500] [--seeds 6] [--task NAME ...] [--mode lean|paper]
     [--replans N] [--reobserve N] [--show shifted|flipped|noised|blank] [--isolate planning|grounding] [--jobs N] [--model NAME]

Every scene is run twice: by the oracle, which looks after every action, and by the team with `simulated:perfect`, which answers
from truth as it is seen through the pictures that it is shown. Whatever the oracle solves and the team does not is listed
with its stage and cause. With `--show` every picture is changed on its way to the model: success must fall.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
from dataclasses import dataclass
from typing import Any

from wonderful_team import registry
from wonderful_team.api.trial import model_of
from wonderful_team.core.intervals import wilson_interval
from wonderful_team.evals.suites import VIMA_TASKS
from wonderful_team.models.image_corruption import CHANGES, ImageCorruption
from wonderful_team.planning import ABLATIONS, TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout


@dataclass(frozen=True)
class Job:
    """One scene and how it is run."""

    task: str
    seed: int
    mode: str
    ablation: str
    model: str
    replans: int
    reobserve: int | None
    show: str
    isolate: str


@dataclass(frozen=True)
class Done:
    """What came of one scene."""

    job: Job
    solved: bool
    stage: str
    reason: str
    oracle: bool
    cpu_s: float
    oracle_cpu_s: float


def by_oracle(job: Job) -> bool:
    """Whether the oracle, looking after every action, solves the scene."""
    world: Any = registry.make_world(job.task, job.seed)
    try:
        for _ in range(world.horizon):
            actions = world.privileged.oracle()
            if not actions:
                break
            world.execute(actions[0])
        return bool(world.privileged.score().success)
    finally:
        world.close()


def by_team(job: Job) -> tuple[bool, str, str]:
    """Whether the team solves the scene; its stage and reason if not."""
    world: Any = registry.make_world(job.task, job.seed)
    try:
        model = _model(job, world)
        # A scene of pushes is looked at after every push, as long as it lasts.
        sweeping = "push" in world.vocabulary.kinds
        reobserve = job.reobserve if job.reobserve is not None else world.horizon if sweeping else 0
        team = TeamPolicy(model, TeamConfig(mode=job.mode, ablation=job.ablation))  # type: ignore[arg-type]
        trial = rollout(
            team,
            world,
            replans=job.replans,
            reobserve=reobserve,
            scorer=world.privileged,
            seed=job.seed,
            max_age_s=None,
        )
        return trial.outcome == "success", trial.stage or "", trial.reason
    finally:
        world.close()


def _model(job: Job, world: Any) -> Any:
    if job.isolate:
        made = registry.make_models(model_of(job.model, job.isolate, world), ROLES, world=world)
    else:
        made = {"*": registry.make_model(job.model, world=world)}
    if not job.show:
        return made
    wrapped = {id(model): ImageCorruption(model, CHANGES[job.show]) for model in made.values()}
    return {role: wrapped[id(model)] for role, model in made.items()}


ROLES = ("supervisor", "verification", "manager", "checker", "mover", "memory", "replanner")


def run(job: Job) -> Done:
    """One scene, by both."""
    start = time.process_time()
    oracle = by_oracle(job)
    between = time.process_time()
    solved, stage, reason = by_team(job)
    return Done(job, solved, stage, reason, oracle, time.process_time() - between, between - start)


def told(task: str, done: list[Done]) -> str:
    """One line for a task."""
    count, solved, oracle = len(done), sum(one.solved for one in done), sum(one.oracle for one in done)
    low, high = wilson_interval(solved, count)
    missed = sum(one.oracle and not one.solved for one in done)
    cpu, alone = (sum(getattr(one, name) for one in done) / count for name in ("cpu_s", "oracle_cpu_s"))
    return (
        f"{task:<44} {solved:>3}/{count:<3} {100 * solved / count:5.1f} % [{100 * low:.1f}, {100 * high:.1f}]   "
        f"oracle {oracle:>3}/{count:<3}   missed {missed}   {cpu:.2f} s CPU a trial (oracle {alone:.2f})"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--world", default="tabletop", help="whose tasks")
    parser.add_argument("--task", action="append", help="only this task, such as rotate or rotate@L3; may be repeated")
    parser.add_argument("--first", type=int, default=500, help="first seed")
    parser.add_argument("--seeds", type=int, default=6, help="scenes per task")
    parser.add_argument("--mode", choices=("lean", "paper"), default="lean")
    parser.add_argument("--ablation", choices=tuple(ABLATIONS), default="full", help="members switched off")
    parser.add_argument("--model", default="simulated:perfect")
    parser.add_argument("--replans", type=int, default=0)
    parser.add_argument("--reobserve", type=int, help="default 0; for pushes the task's horizon, one after every push")
    parser.add_argument(
        "--show", choices=tuple(CHANGES), default="", help="change every picture on its way to the model"
    )
    parser.add_argument("--isolate", choices=("planning", "grounding"), default="", help="the part that --model does")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    options = parser.parse_args()
    names = options.task or VIMA_TASKS
    jobs = [
        Job(
            f"{options.world}/{name}", seed, options.mode, options.ablation, options.model, options.replans, options.reobserve,
            options.show, options.isolate,
        )
        for name in names
        for seed in range(options.first, options.first + options.seeds)
    ]  # fmt: skip
    started = time.monotonic()
    everything: list[Done] = []
    # A fresh process for every few scenes: simulators keep memory.
    with multiprocessing.get_context("spawn").Pool(options.jobs, maxtasksperchild=50) as pool:
        for done in pool.imap(run, jobs):
            everything.append(done)
            if len(everything) % options.seeds == 0:
                print(told(done.job.task, everything[-options.seeds :]), flush=True)
                for one in everything[-options.seeds :]:
                    if one.oracle and not one.solved:
                        print(f"    seed {one.job.seed}: {one.stage}: {one.reason}", flush=True)
    print(told("all", everything), f"  {time.monotonic() - started:.0f} s with {options.jobs} processes")


if __name__ == "__main__":
    main()
