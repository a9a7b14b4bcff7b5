"""The judgement of one's own actions against truth: counted where it is made, and a table of the report."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest

import wonderful_team as wt
from wonderful_team.api.judgements import Judgements
from wonderful_team.core.protocols import CHECK, Event, privileged
from wonderful_team.core.values import StepReport, SubgoalRun, Verdict
from wonderful_team.evals.report.judgements import HEAD, lines
from wonderful_team.evals.report.tables import fact_tables, to_markdown
from wonderful_team.evals.summary import Summary
from wonderful_team.evals.trials import JUDGED, JUDGED_SUBGOAL, Condition, Row, TrialRow, TrialSpec

TASK = "tabletop/visual_manipulation"


def said(*statuses: str) -> Event:
    return Event("verdicts", "judge", tuple(Verdict(f"S{k}", status) for k, status in enumerate(statuses)))  # type: ignore[arg-type]


def test_what_is_said_is_held_against_the_world_at_that_moment() -> None:
    world = wt.make_world(TASK, seed=3)
    judgements = Judgements(world)
    judgements.on_event(said("done", "done"))
    judgements.on_event(said("done", "unclear"))
    wt.rollout(wt.Team(model="simulated:perfect"), world, seed=3, scene=f"{TASK}#3")
    judgements.on_event(said("done"))
    world.close()
    told = {JUDGED[True, False]: 1.0, JUDGED[False, False]: 1.0, JUDGED[True, True]: 1.0, JUDGED[False, True]: 0.0}
    assert judgements.facts == told


def test_a_trial_in_which_nothing_was_judged_has_no_such_facts() -> None:
    world = wt.make_world(TASK, seed=3)
    assert Judgements(world).facts == {}
    world.close()


def test_a_study_that_replans_counts_them_and_one_that_does_not_has_none(tmp_path: Path) -> None:
    for replans, judged in ((1, True), (0, False)):
        study = wt.Study(
            suite=TASK, models="simulated:perfect", seeds=range(3, 4), replans=replans, controls=(), jobs=1,
            store=tmp_path / f"{replans}.db", record="none",
        )  # fmt: skip
        study.run()
        summary = study.summary()
        (result,) = summary.cell(summary.compared[0]).results
        assert (result.facts.get(JUDGED[True, True]) == 1.0) is judged
        assert ("What methods said became of their actions" in to_markdown(summary)) is judged


def carried(world: wt.World, action: wt.PickPlace, *, runs: bool, reports: bool = True) -> SubgoalRun:
    """A subgoal that carries a thing, or is only said to."""
    seen = world.observe()
    if runs:
        world.execute(action)
    return SubgoalRun("G1", seen, world.observe(), (StepReport(action, True),) if reports else ())


@pytest.mark.parametrize(
    ("runs", "reports", "status", "key"),
    [
        (True, True, "done", (True, True)),
        (False, True, "done", (True, False)),
        (False, True, "not_done", (False, False)),
        (True, True, "not_done", (False, True)),
        (True, False, "done", (True, None)),
    ],
)
def test_a_single_subgoal_is_held_against_where_its_thing_lies(
    runs: bool, reports: bool, status: Literal["done", "not_done"], key: tuple[bool, bool | None]
) -> None:
    world = wt.make_world(TASK, seed=3)
    judgements = Judgements(world)
    truth = privileged(world)
    assert truth is not None
    judgements.on_event(Event("observe", "before", world.observe()))
    run = carried(world, truth.oracle()[0], runs=runs, reports=reports)
    judgements.on_event(Event("observe", "after G1", run.after))
    judgements.on_event(Event("subgoal", "G1", run))
    judgements.on_event(Event("verdicts", CHECK, (Verdict("G1", status),)))
    world.close()
    assert judgements.facts == {name: float(name == JUDGED_SUBGOAL[key]) for name in JUDGED_SUBGOAL.values()}


def test_single_subgoals_have_a_line_of_their_own_and_what_is_not_known_counts_in_no_rate() -> None:
    team = Condition("team", "m", replans=3)
    facts = {JUDGED_SUBGOAL[True, True]: 3.0, JUDGED_SUBGOAL[False, False]: 1.0, JUDGED_SUBGOAL[True, None]: 2.0}
    row = Row(TrialSpec(TASK, 1000, team), TrialRow("success", facts={JUDGED[True, True]: 1.0, **facts}))
    whole, single = lines(Summary((row,), (), (team,), ()))
    assert dict(zip(HEAD, whole, strict=True))["judgements"] == "1"
    told = dict(zip(HEAD, single, strict=True))
    assert told["method · model"].endswith("after a subgoal")
    assert [told[name] for name in HEAD[1:7]] == ["6", "3", "0", "1", "0", "2"]
    assert told["of what was not done, seen"].startswith("100.0 % (1/1;")


def test_the_table_is_a_confusion_matrix_with_intervals() -> None:
    team = Condition("team", "m", replans=3)
    counts = [{(True, True): 1, (False, False): 1}, {(True, False): 1}, {(False, True): 1, (False, False): 2}]
    rows = [
        Row(
            TrialSpec(TASK, 1000 + seed, team),
            TrialRow("success", facts={JUDGED[key]: float(found.get(key, 0)) for key in JUDGED}),
        )
        for seed, found in enumerate(counts)
    ]
    summary = Summary(tuple(rows), (), (team,), ())
    (line,) = lines(summary)
    told = dict(zip(HEAD, line, strict=True))
    assert [told[name] for name in HEAD[1:6]] == ["6", "1", "1", "3", "1"]
    assert told["of what was not done, seen"].startswith("75.0 % (3/4; 95 % interval ")
    assert told["of what was done, doubted"].startswith("50.0 % (1/2; 95 % interval ")
    # The counts stand there alone, not as means among the other figures.
    assert fact_tables(summary) == []
