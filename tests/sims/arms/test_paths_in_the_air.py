"""A path in the air from question to answer: written from truth, run in the sandbox, and refused where it rises otherwise."""

from __future__ import annotations

import asyncio
from typing import Any

import numpy as np

from tests.sims.arms.needed import needs_arms
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import DraftPlan, EarlierFunction, ReviewPath, WriteFunction
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.pictures import PathMark, PathPoint, Picture, rises_of
from wonderful_team.core.values import Request
from wonderful_team.sandbox import run_path
from wonderful_team.sims.arms import ArmWorld
from wonderful_team.simulated import PROFILES, SimulatedModel


def reviewed(ask: Any, subgoal: Any, view: Any, path: tuple[PathPoint, ...]) -> str:
    mark = PathMark(tuple((point[0], point[1]) for point in path))
    return str(ask(ReviewPath(subgoal, view.marked(mark), rises_of(path))).problem)


def again(ask: Any, subgoal: Any, view: Any, box: Box, purpose: str, error: str = "") -> str:
    """The code that is written where a function of that purpose was accepted before."""
    drawn = Picture("path_1", np.full((8, 8, 3), 255, np.uint8), Frame.whole("path_1", (8, 8)))
    earlier = EarlierFunction("path_1", purpose, {"T9": "the bottle"}, "def path(boxes): ...", drawn)
    return str(ask(WriteFunction(subgoal, view, {subgoal.targets[0]: box}, error, earlier=(earlier,))).code)


@needs_arms
def test_a_written_path_is_accepted_and_one_that_rises_otherwise_is_refused() -> None:
    world = ArmWorld("shake", 3)
    try:
        scene = SceneShown(world.observe(), world.instruction, world.vocabulary, world.limits, world.facts)
        model = SimulatedModel(world.privileged, world.instruction, PROFILES["perfect"])

        def ask(question: Any) -> Any:
            view = getattr(question, "view", None)
            parts = () if view is None else (view,)
            request = Request("0/act/main/0", "act", "any", question, parts, question.output())
            return asyncio.run(model.answer(request)).value

        draft = ask(DraftPlan(scene.task, world.vocabulary.step_kinds, True))
        (subgoal,) = (item.to_subgoal() for item in draft.subgoals)
        name = world._table.work.wanted.name  # type: ignore[union-attr]
        mask = world.privileged.observation_log(scene.view.id)[0].masks[name]
        rows, columns = mask.any(axis=1).nonzero()[0], mask.any(axis=0).nonzero()[0]
        view = scene.labelled
        box = view.frame.box_to_picture(Box(columns[0], rows[0], columns[-1] + 1, rows[-1] + 1))
        written = ask(WriteFunction(subgoal, view, {subgoal.targets[0]: box}))
        path = run_path(written.code, {subgoal.targets[0]: box})
        assert len(path) == 9
        assert max(rises_of(path)) > 0.05
        assert reviewed(ask, subgoal, view, path) == ""
        flat = tuple((point[0], point[1]) for point in path)
        assert "0 of its points say how far up" in reviewed(ask, subgoal, view, flat)
        lower = tuple((point[0], point[1], 0.3 * up) for point, up in zip(path, rises_of(path), strict=True))
        assert "its points should lie 0.00, 0.07," in reviewed(ask, subgoal, view, lower)
        assert (
            again(ask, subgoal, view, box, subgoal.function)
            == "def path(boxes):\n    return path_1({'T9': boxes['T1']})\n"
        )
        assert again(ask, subgoal, view, box, subgoal.function, "it lies beside it") == written.code
        assert again(ask, subgoal, view, box, "a circle round it") == written.code
        beside = tuple((point[0] + 30, point[1], up) for point, up in zip(path, rises_of(path), strict=True))
        assert "px from where it should" in reviewed(ask, subgoal, view, beside)
    finally:
        world.close()
