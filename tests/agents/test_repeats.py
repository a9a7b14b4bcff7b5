"""No picture is sent twice in one request: words that name the other one stand in its place."""

from __future__ import annotations

from dataclasses import replace

from tests.agents.question_samples import KINDS, SAMPLES, TASK, picture
from wonderful_team.agents import build_request
from wonderful_team.agents.rendering import picture_parts
from wonderful_team.agents.repeats import without_repeats
from wonderful_team.contracts import DraftPlan, ReviewSteps, ShownSlot, ShownTask
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes, BoxMark, Picture
from wonderful_team.core.values import Part, Request, Words


def shown(request: Request) -> str:
    return "\n".join(part.text for part in request.parts if isinstance(part, Words))


def copy(of: Picture, name: str) -> Picture:
    """The same pixels under another name, in an array of its own."""
    return replace(of, name=name, rgb=of.rgb.copy(), marks=())


def test_a_scene_that_is_the_scene_as_it_is_now_is_said_and_not_sent_again() -> None:
    views = (picture("top view"), picture("front view"))
    scene = ShownSlot("scene", "scene", (copy(views[0], "{scene} top"), copy(views[1], "{scene} front")))
    task = ShownTask("Put the mug in {scene} away.", views, (scene,))
    request = build_request(DraftPlan(task, KINDS, True), id="q", stage="plan")
    assert [part.name for part in request.pictures] == ["top view", "front view"]
    text = shown(request)
    assert (
        'Picture "{scene} top", {scene}: a whole scene: the same as picture "top view" below (the scene now, the main view)'
        in text
    )
    assert 'Picture "{scene} top" (' not in text  # no size of a picture that is not there


def test_the_view_without_marks_is_not_sent_beside_the_plan_drawn_on_it() -> None:
    review = next(sample for sample in SAMPLES if isinstance(sample, ReviewSteps))
    overview = replace(TASK.main, name="top view with the plan", marks=(*TASK.main.marks, *review.overview.marks))
    request = build_request(replace(review, overview=overview), id="q", stage="act")
    assert [part.name for part in request.pictures].count("top view") == 0
    assert 'the same as picture "top view with the plan" below (the plan drawn over the main view)' in shown(request)


def test_pictures_with_different_marks_or_pixels_are_all_sent() -> None:
    clean = picture("crop")
    before, after = clean.marked(BoxMark(Box(1, 1, 9, 9), "before")), clean.marked(BoxMark(Box(2, 2, 9, 9), "after"))
    parts: list[Part] = [*picture_parts(before, "before"), *picture_parts(replace(after, name="after"), "after")]
    assert without_repeats(parts) == tuple(parts)
    ticked = picture_parts(clean.marked(Axes())) + picture_parts(replace(before, name="before"))
    assert len([part for part in without_repeats(ticked) if isinstance(part, Picture)]) == 2


def test_the_picture_that_an_answer_is_about_always_stays() -> None:
    view, same = picture("view", Axes()), replace(picture("view", Axes()), name="later")
    parts = [*picture_parts(view), *picture_parts(same), Words("Answer in it.", "positions", view)]
    kept = [part.name for part in without_repeats(parts) if isinstance(part, Picture)]
    assert kept == ["view"]


def test_of_three_alike_one_is_sent_and_the_others_name_it() -> None:
    three = [replace(picture("view"), name=name) for name in ("one", "two", "three")]
    parts = without_repeats([part for item in three for part in picture_parts(item)])
    assert [part.name for part in parts if isinstance(part, Picture)] == ["three"]
    assert all('"three" below' in part.text for part in parts[:2] if isinstance(part, Words))
