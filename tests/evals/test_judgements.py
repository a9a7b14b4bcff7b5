"""The judgement of one's own actions against truth: counted where it is made, and a table of the report."""

from __future__ import annotations

from pathlib import Path

import wonderful_team as wt
from wonderful_team.api.judgements import Judgements
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import Verdict
from wonderful_team.evals.report.judgements import HEAD, lines
from wonderful_team.evals.report.tables import fact_tables, to_markdown
from wonderful_team.evals.summary import Summary
from wonderful_team.evals.trials import JUDGED, Condition, Row, TrialRow, TrialSpec

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
