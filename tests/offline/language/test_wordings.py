"""Other words for all 17 VIMA tasks come to what the task's own words come to; words that say something else to nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.offline.language.scenes import told_for
from tests.offline.language.wordings import Wording, filled, gist, read_wordings
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.sims.tabletop import task_names

HERE = Path(__file__).parent
SAME = read_wordings((HERE / "wordings.txt").read_text(encoding="utf-8"))
OTHER = read_wordings((HERE / "nonsense.txt").read_text(encoding="utf-8"))


@pytest.mark.parametrize("wording", SAME, ids=lambda wording: f"{wording.task}: {wording.text[:60]}")
def test_read_as_the_tasks_own_words_are(wording: Wording) -> None:
    scene = told_for(wording)
    assert gist(scene.read(filled(wording.text, scene.words))) == gist(scene.read(scene.instruction))


@pytest.mark.parametrize("wording", OTHER, ids=lambda wording: f"{wording.task}: {wording.text[:60]}")
def test_a_wrong_plan_is_worse_than_a_refusal(wording: Wording) -> None:
    scene = told_for(wording)
    with pytest.raises(NotUnderstoodError, match="I do not know: ") as refused:
        scene.read(filled(wording.text, scene.words))
    assert refused.value.exit_code == 7


def test_every_task_has_other_words() -> None:
    vima = {name for name in task_names() if "/" not in name}
    for wordings, fewest in ((SAME, 8), (OTHER, 2)):
        counts = {name: sum(wording.task == name for wording in wordings) for name in vima}
        assert min(counts.values()) >= fewest, counts
