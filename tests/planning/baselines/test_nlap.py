"""`nlap`: what each row is told and shown, read from its record; truth only where the name says so."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wonderful_team as wt
from tests.desk import read_record
from tests.planning.baselines.runs import Listening, contracts, decided, photo, pictures, requests, run, words
from wonderful_team.agents.common import PLAIN_GREY
from wonderful_team.core.protocols import Act, GaveUp
from wonderful_team.errors import ConfigError
from wonderful_team.evals.paper import paper_figure
from wonderful_team.evals.trials import Condition
from wonderful_team.planning.baselines.nlap import EXAMPLE_WORDS, example_picture, example_text
from wonderful_team.registry.methods import METHODS

ROWS = [name for name in METHODS if name.startswith("nlap")]
PRIVILEGED = [name for name in ROWS if "privileged" in name]


@pytest.fixture(scope="module", params=ROWS)
def row(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """One trial of each row."""
    return run(request.param, "visual_manipulation", tmp_path_factory.mktemp("nlap"))


def planned(trial: Any) -> dict[str, Any]:
    """The request for the plan."""
    (found,) = [request for request in requests(trial) if request["contract"] == "PlanFromList"]
    return found


def test_each_row_asks_what_it_has_to_and_solves_a_plain_task(row: Any) -> None:
    assert row.outcome == "success"
    asked = ["PlanFromList"] if "privileged" in row.method else ["ListObjects", "PlanFromList"]
    assert contracts(row) == asked
    assert row.usage.calls == len(asked)
    assert row.page.is_file()


def test_rows_of_text_alone_hold_no_picture(row: Any) -> None:
    shown = [part["picture"] for part in pictures(planned(row))]
    if row.method.startswith(("nlap:text", "nlap:privileged")):
        assert shown == []
    else:
        # The example's scene, both views of the table, and what the instruction shows.
        assert shown[:3] == ["example view", "top view", "front view"]
        assert len(shown) > 3
    extraction = [request for request in requests(row) if request["contract"] == "ListObjects"]
    assert all(pictures(request)[0]["picture"] == "top view" for request in extraction)
    assert bool(extraction) == ("privileged" not in row.method)


def test_every_row_is_told_that_a_plain_grey_example_stands_for_its_shape(row: Any) -> None:
    assert PLAIN_GREY in words(planned(row))
    assert ("A plain\n  grey example on white" in words(planned(row))) == bool(pictures(planned(row)))


def test_every_row_has_one_worked_example_and_thinks_only_where_it_is_meant_to(row: Any) -> None:
    request = planned(row)
    said = words(request)
    assert said.count(EXAMPLE_WORDS) == 1
    thinks = "no-cot" not in row.method
    assert ("Thoughts: The instruction speaks of" in said) == thinks
    assert ("First think step by step" in said) == thinks
    answer = request["answer"]["parsed"]
    assert (next(iter(answer)) == "thoughts") == thinks
    assert ("thoughts" in answer) == thinks
    # A plan that may not think has no place for it.
    assert "reasoning" not in answer


def test_the_list_is_what_the_model_said_or_what_is_true(row: Any) -> None:
    said = words(planned(row))
    world = wt.make_world("tabletop/visual_manipulation", seed=500)
    world.observe()
    truth: Any = world.privileged  # type: ignore[attr-defined]
    names = {thing.words for thing in truth.things().values()}
    world.close()
    assert all(name in said for name in names)
    if "privileged" in row.method:
        assert "{dragged_obj_1}: pink letter R" in said
        return
    listed = next(request for request in requests(row) if request["contract"] == "ListObjects")
    for item in listed["answer"]["parsed"]["objects"]:
        point = item["point"]
        assert f"{item['name']}: x {round(point['x'])}, y {round(point['y'])}" in said


@pytest.mark.parametrize("name", PRIVILEGED)
def test_privileged_rows_say_so_everywhere(name: str, tmp_path: Path) -> None:
    trial = run(name, "rotate", tmp_path)
    assert METHODS[name].words.startswith("PRIVILEGED")
    assert trial.setting["PRIVILEGED"] == "true object names and positions, as text"
    assert any(text.startswith(f"PRIVILEGED: method '{name}'") for text in trial.warnings)
    record = json.dumps(read_record(trial.folder))
    assert "PRIVILEGED: method" in record
    page = trial.page.read_text(encoding="utf-8")
    assert "PRIVILEGED" in page
    assert name in page
    assert Condition(name, "m").label.count("PRIVILEGED") == 1


@pytest.mark.parametrize("name", sorted(set(METHODS) - set(PRIVILEGED)))
def test_no_other_method_is_given_a_world(name: str) -> None:
    assert not METHODS[name].privileged
    assert "PRIVILEGED" not in Condition(name, "m").label
    world = wt.make_world("tabletop/rotate", seed=500)
    assert wt.Method(method=name, world=world)._setup(()).world is None
    world.close()


def test_what_is_told_are_names_and_positions_and_nothing_else(tmp_path: Path) -> None:
    """Where a picture of the instruction shows a scene, what stands where in it; no heights, angles, masks or goals."""
    trial = run("nlap:privileged", "rearrange", tmp_path)
    assert trial.outcome == "success"
    said = words(planned(trial))
    lines = [line for line in said.splitlines() if line.startswith(("- 1. ", "- 2. ", "- 3. ", "- {"))]
    told = [line for line in lines if line not in example_text(("pick_place",), thoughts=True)]
    assert told
    (scene,) = [line for line in told if line.startswith("- {")]
    assert scene == "- {scene}: blue letter M at x 965, y 171"
    assert not any(word in "\n".join(told) for word in ("height", "degrees", "metre", "yaw", "goal"))


@pytest.mark.parametrize("name", PRIVILEGED)
def test_without_a_truth_that_is_right_a_privileged_row_is_refused_before_anything_runs(
    name: str, tmp_path: Path
) -> None:
    other = wt.make_world("tabletop/rotate", seed=500, instruction="put the red block into the bowl")
    with pytest.raises(ConfigError, match=f"method '{name}' is told a simulator's truth.*nlap:text"):
        wt.rollout(wt.Method(method=name), other, out=tmp_path)
    other.close()
    with pytest.raises(ConfigError, match=r"run it with wt\.rollout"):
        decided(name, photo(tmp_path))
    assert not list(tmp_path.glob("*/record.json"))


def test_offline_plans_from_pictures_and_refuses_words_alone_by_name(tmp_path: Path) -> None:
    made = decided("nlap:text", photo(tmp_path))
    assert isinstance(made, GaveUp)
    assert "model 'offline' cannot answer PlanFromList: it plans from pictures" in made.reason
    assert isinstance(decided("nlap", photo(tmp_path)), Act)


def test_coordinates_come_from_the_list_as_it_stands(tmp_path: Path) -> None:
    """A list that is off leads a model that reasons rightly to the wrong place."""
    world = wt.make_world("tabletop/visual_manipulation", seed=500)

    class Off:
        name = "off"
        model = wt.make_model("simulated:perfect", world=world)

        async def answer(self, request: wt.Request) -> Any:
            said = await self.model.answer(request)  # type: ignore[misc]
            if request.contract != "ListObjects":
                return said
            wrong = said.value.model_dump()
            for item in wrong["objects"]:
                item["point"]["x"] -= 60
            return wrong

    model = Listening(Off())
    trial = wt.rollout(wt.Method(method="nlap:text", model=model), world, out=tmp_path)
    world.close()
    right = run("nlap:text", "visual_manipulation", tmp_path / "right")
    off, true = (one.plans[0].grounded["T1"].points["pick"] for one in (trial, right))
    # The view of 640 px is shown at twice its size.
    assert np.subtract(off, true) == pytest.approx((-30, 0), abs=0.6)
    assert trial.outcome == "failure"


def test_points_outside_of_the_view_go_back_to_the_model(tmp_path: Path) -> None:
    class Far:
        name = "far"
        model = wt.make_model("offline")

        def answer(self, request: wt.Request) -> Any:
            said = self.model.answer(request)
            if request.contract != "PlanFromList" or request.attempt:
                return said
            wrong = said.value.model_dump()  # type: ignore[union-attr]
            wrong["targets"][0]["points"][0]["x"] = 5000
            return wrong

    model = Listening(Far())
    assert isinstance(decided("nlap", photo(tmp_path), model), Act)
    assert "x = 5000 of T1 lies outside the view, which spans 0 to 1280" in {one.feedback for one in model.heard}


@pytest.mark.parametrize("kinds", [("pick_place",), ("push",), ("move", "open", "close"), ("home",)])
def test_the_example_is_in_what_the_robot_can_do(kinds: tuple[str, ...]) -> None:
    text = example_text(kinds, thoughts=False)
    assert "Thoughts" not in text
    other = (
        {"pick_place", "push,", "move down"}
        - {"push," if "push" in kinds else "", *kinds}
        - {"move down" if "move" in kinds else ""}
    )
    assert not any(step in text for step in other)


def test_the_examples_picture_shows_what_its_list_says() -> None:
    picture = example_picture()
    scale = picture.frame.scale
    for (x, y), colour in {(220, 150): (235, 130, 30), (700, 330): (245, 245, 245), (480, 90): (25, 25, 25)}.items():
        assert tuple(picture.rgb[round(y * scale), round(x * scale)]) == colour
    assert picture.size_px == (round(960 * scale), round(480 * scale))


def test_the_papers_column_stands_beside_the_rows_that_it_measured() -> None:
    with_thoughts = paper_figure("tabletop/novel_adj", "nlap:privileged")
    assert with_thoughts is not None
    assert with_thoughts.percent == 43
    without = paper_figure("tabletop/novel_adj", "nlap:privileged:no-cot")
    assert without is not None
    assert without.percent == 13
    assert (paper_figure("tabletop/rotate", "nlap"), paper_figure("tabletop/rotate", "nlap:text")) == (None, None)
