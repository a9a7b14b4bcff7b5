"""`demo`: the whole team at work on a rendered scene, with two planted mistakes that it has to catch."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wonderful_team.cli.options import PATH
from wonderful_team.cli.output import finish
from wonderful_team.cli.run_summary import program, shown_path, trial_json
from wonderful_team.cli.wording import action_line, said_of, trial_exit_code, trial_lines, words_of

if TYPE_CHECKING:
    from wonderful_team.api.results import TrialResult
    from wonderful_team.contracts import BoxAnswer, PlanDraft
    from wonderful_team.core.values import Request
    from wonderful_team.models.wrappers import Injection

WORLD = "tabletop/everyday/tidy_up"
SEED = 3
RIGHT, WRONG = "blue bowl", "green bowl"
NEXT = (
    "show latest --role verification",
    "run tabletop/rotate --seed 3",
    'plan YOUR_PHOTO.jpg "put the red cube to the left of the blue bowl"',
)


@click.command(short_help="Watch the team plan, catch two planted mistakes, and act, on a rendered scene.")
@click.option("--seed", type=click.IntRange(0), default=SEED, show_default=True, help="Of the scene.")
@click.option("--out", type=PATH, metavar="DIR", help="Where run folders go. [default: runs]")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
@click.option("--open", "open_page", is_flag=True, help="Open the page when done.")
def command(seed: int, out: Path | None, as_json: bool, open_page: bool) -> int:
    """Run the team on a tabletop scene without a key, a GPU or a robot.

    Two mistakes are planted and labelled INJECTED: a plan that fills the wrong bowl, and a first box beside its object.
    Verification and the Checker have to catch them.
    """
    from wonderful_team.api.rollout import make_world, rollout
    from wonderful_team.api.team import Team
    from wonderful_team.cli.progress import ProgressLine
    from wonderful_team.models.wrappers import Injecting
    from wonderful_team.registry.models import make_model
    from wonderful_team.registry.worlds import scene_name

    progress = ProgressLine(live=not as_json)
    injections = planted_mistakes()
    model = Injecting(make_model("offline"), injections)
    progress.note("`offline` is classical vision and a grammar, not a vision-language model: no key, no weights.")
    progress.note("Two mistakes are planted, labelled INJECTED: the team has to catch them.")
    team = Team(
        model=model, method="team:paper", out=out, subscribers=(progress,), command=f"wonderful-team demo --seed {seed}"
    )
    progress.header(team)
    world = make_world(WORLD, seed)
    try:
        progress.task(scene_name(WORLD, seed), world.instruction)
        trial = rollout(team, world, replans=1, seed=seed, scene=scene_name(WORLD, seed))
    finally:
        world.close()
    progress.end(trial.usage)
    planted = [injection.label for injection in injections if injection.struck]
    result = {**trial_json(trial), "injected": planted, "caught": caught(trial)}
    text = "\n".join([*_story(trial, planted), "", "next:", *(f"  {program()} {line}" for line in NEXT)])
    if open_page and trial.page is not None:
        click.launch(trial.page.resolve().as_uri())
    last = "" if trial.page is None else f"page: {shown_path(trial.page)}"
    return finish("demo", text=text, result=result, as_json=as_json, code=trial_exit_code(trial), last_line=last)


def planted_mistakes() -> tuple[Injection, Injection]:
    """The two mistakes: each strikes one answer of the model, once."""
    from wonderful_team.models.wrappers import Injection

    return (
        Injection(("DraftPlan",), wrong_bowl, f"the first plan fills the {WRONG} instead of the {RIGHT}"),
        Injection(("GiveBox",), shift_first_box, "the first box lies beside its object"),
    )


def wrong_bowl(draft: PlanDraft, request: Request) -> PlanDraft | None:
    """A wrong plan: its first subgoal and the targets speak of the other bowl."""
    if not draft.subgoals or RIGHT not in draft.subgoals[0].text:
        return None
    first = draft.subgoals[0].model_copy(update={"text": draft.subgoals[0].text.replace(RIGHT, WRONG)})
    targets = [target.model_copy(update={"words": target.words.replace(RIGHT, WRONG)}) for target in draft.targets]
    return draft.model_copy(update={"subgoals": [first, *draft.subgoals[1:]], "targets": targets})


def shift_first_box(answer: BoxAnswer, request: Request) -> BoxAnswer | None:
    """A wrong box for T1. Targets are looked for all at once: naming one keeps the demo the same every time."""
    from wonderful_team.models.wrappers import shift_box

    wrong: BoxAnswer | None = shift_box(answer, request) if request.question.target.id == "T1" else None
    return wrong


def caught(trial: TrialResult) -> dict[str, list[str]]:
    """What the checking members said against the planted mistakes: doubts that changed the plan, boxes not accepted."""
    if not trial.plans:
        return {"verification": [], "checker": []}
    plan = trial.plans[0]
    doubts = [f"{doubt.about}: {doubt.question}" for doubt in plan.questions if doubt.changed]
    verdicts = []
    for target, grounded in plan.grounded.items():
        told = [event for event in grounded.history if event.what in ("verdict", "move")]
        if any(event.provenance == "injected" for event in grounded.history):
            verdicts += [f"{target} {grounded.target.words}: {event.text}" for event in told]
    return {"verification": doubts, "checker": verdicts}


def _story(trial: TrialResult, planted: list[str]) -> list[str]:
    """Each planted mistake with what caught it below, then the plan and how it went."""
    found = caught(trial)
    plan = trial.plans[-1] if trial.plans else None
    told = [[f"Verification, {text}" for text in found["verification"]], found["checker"]]
    lines = []
    for label, said in zip(planted, told, strict=False):
        lines.append(f"INJECTED  {label}")
        lines += [f"CAUGHT    {text if plan is None else said_of(plan.instruction, text)}" for text in said]
    if plan is not None:
        lines += [f"PLAN      {action_line(planned, words_of(plan))}" for planned in plan.actions]
    return [*lines, *trial_lines(trial)]
