"""Words of a request say what its pictures and its answer's form say: sizes, lines, arrows, and what may be left out."""

from __future__ import annotations

import numpy as np
import pytest

from tests.agents.test_scene_shown import LIMITS, NOW, look
from wonderful_team.agents import build_request
from wonderful_team.agents.prompts import Prompts
from wonderful_team.agents.rendering import slot_parts
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import BoxVerdict, JudgeBox, ReadScene, ReviewPlan
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, PointMark
from wonderful_team.core.values import Instruction, Observation, Slot, Target, View, Words
from wonderful_team.images import crop, draw, line_width_px


def thing(side: int, camera: str) -> View:
    rgb = np.full((160, 320, 3), 255, np.uint8)
    rgb[40 : 40 + side, 100 : 100 + side] = (190, 40, 45)
    return View("slot:mug:top", camera, 0.0, rgb)


def shown(side: int, camera: str) -> SceneShown:
    slot = Slot("mug", "object", {camera: thing(side, camera)})
    return SceneShown(
        Observation({"top": look("top", *NOW)}), Instruction("take {mug}", {"mug": slot}), PICK_PLACE, LIMITS
    )


@pytest.mark.parametrize("side", [16, 60, 90])
def test_a_cut_out_says_how_large_it_is_beside_the_main_view_as_it_is_shown(side: int) -> None:
    scene = shown(side, "top")
    (slot,) = scene.slots
    words, sheet = slot_parts(scene.slots)
    assert isinstance(words, Words)
    # The same thing in the main view has side * scale pixels; in its own picture it is so many times as large.
    times = slot.pictures[0].frame.scale / scene.views[0].frame.scale
    said = "as large as in the main view" if round(times, 1) == 1 else f"{times:.2g} times as large as in the main view"
    assert said in words.text
    assert "as large as in the views" not in words.text


def test_a_picture_by_another_camera_is_not_compared() -> None:
    words, _ = slot_parts(shown(16, "phone").slots)
    assert isinstance(words, Words)
    assert "enlarged" in words.text
    assert "main view" not in words.text


def test_one_thing_alone_is_not_called_each() -> None:
    words, _ = slot_parts(shown(16, "top").slots)
    assert isinstance(words, Words)
    assert "over its name, {mug}" in words.text
    assert "each over" not in words.text


def test_the_width_that_is_said_is_that_of_the_drawn_line_and_the_points_name_stands_off_the_thing() -> None:
    view = look("top", *NOW)
    picture = crop(view, Box(20, 20, 120, 100), "crop")
    box = picture.frame.box_to_picture(Box(20, 20, 120, 100))
    middle = int((box.x0 + box.x1) / 2), int((box.y0 + box.y1) / 2)
    bare, lined = draw(picture), draw(picture.marked(BoxMark(box)))
    across = np.abs(lined.astype(int) - bare)[middle[1], : middle[0]].max(axis=-1) > 0
    assert across.sum() == pytest.approx(line_width_px(picture), abs=2)
    named = draw(picture.marked(BoxMark(box), PointMark(middle, "pick")))
    inside = np.abs(named.astype(int) - lined)[int(box.y0) + 12 : int(box.y1) - 12, int(box.x0) + 12 : int(box.x1) - 12]
    # A cross and a thin line lie on the thing; a plate with a name would cover far more.
    assert (inside.max(axis=-1) > 0).mean() < 0.05
    request = build_request(
        JudgeBox(Target("T1", "object", "mug"), picture.marked(BoxMark(box))), id="x", stage="ground"
    )
    assert f"whole line is {line_width_px(picture)} px wide" in "\n".join(
        part.text for part in request.parts if isinstance(part, Words)
    )


def test_forms_of_answers_say_what_the_words_say() -> None:
    assert "left out" not in str(ReadScene.output(None).model_json_schema())  # type: ignore[arg-type]
    assert "within the limits" in str(BoxVerdict.model_json_schema())
    assert "nothing else is in doubt" in str(ReviewPlan.output(None).model_json_schema())  # type: ignore[arg-type]


def test_verification_knows_where_a_pushs_arrow_begins_and_ends() -> None:
    said = " ".join(Prompts.default().ask("verification", "ReviewSteps").split())
    assert "The arrow of a push begins beside the thing instead" in said
    assert "ends where the front of the tool stops: the thing then lies before it" in said


def test_rules_for_targets_say_when_they_hold() -> None:
    """In the paper's way targets are listed by a question of their own, and the draft leaves them empty."""
    assert "How to write targets, where they are to be listed now" in Prompts.default().ask("supervisor", "DraftPlan")
    assert "only the part that is named" in " ".join(Prompts.default().ask("manager", "Presence").split())
