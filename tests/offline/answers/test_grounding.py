"""Finding targets on the whole view, judging and moving boxes on crops, choosing points; shifted pixels change answers."""

from __future__ import annotations

import numpy as np
import pytest

from tests.offline.answers.tables import SIZE, ask, picture, slot, table
from wonderful_team.contracts import (
    BoxAnswer,
    BoxMove,
    BoxVerdict,
    ChooseMark,
    ChoosePoint,
    GiveBox,
    JudgeBox,
    JudgeRevision,
    LocatePoints,
    MarkChoice,
    MoveBox,
    PointChoice,
    Points,
    Presence,
    PresenceAnswer,
    ReadScene,
    RevisionVerdict,
    SceneReading,
    Strip,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Candidates, Picture, PointMark
from wonderful_team.core.values import Target, View
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.images import crop, edge_strips, inside_points

SCENE = table(
    ("square", "red", 80, 80, 26),
    ("ring", "blue", 300, 160, 52),
    ("star", "green", 500, 80, 36),
    ("disc", "yellow", 520, 240, 30),
)
STAR = Target("T1", "object", "green star", use=("pick",))
RING = Target("T2", "object", "blue ring", use=("pick", "place"))
ABSENT = Target("T3", "object", "purple triangle")
STAR_BOX = Box(465, 44, 535, 110)
RING_BOX = Box(248, 108, 353, 213)


def read(view: View, *targets: Target, slots: tuple[object, ...] = ()) -> SceneReading:
    answer = ask(ReadScene(targets, (), picture(view), (), slots))  # type: ignore[arg-type]
    assert isinstance(answer, SceneReading)
    return answer


def in_view(answer_box: object, view: View) -> Box:
    return picture(view).frame.box_to_view(answer_box.as_box)  # type: ignore[attr-defined]


def boxed(view: View, box: Box, window: Box | None = None) -> Picture:
    shown = crop(view, window or box, "crop")
    return shown.marked(BoxMark(shown.frame.box_to_picture(box)))


def shifted(view: View, dx: int, dy: int) -> View:
    return View(view.id, view.camera_name, 0.0, np.roll(view.rgb, (dy, dx), axis=(0, 1)))


def noise(view: View) -> View:
    random = np.random.default_rng(3)
    return View(view.id, view.camera_name, 0.0, random.integers(0, 255, view.rgb.shape).astype(np.uint8))


def test_boxes_and_points_in_one_answer() -> None:
    star, ring = read(SCENE, STAR, RING).targets
    assert star.box is not None
    assert ring.box is not None
    assert in_view(star.box, SCENE).iou(STAR_BOX) > 0.85
    assert in_view(ring.box, SCENE).iou(RING_BOX) > 0.85
    points = {point.role: picture(SCENE).frame.point_to_view(point.point.as_tuple) for point in ring.points}
    distance = {role: float(np.hypot(x - 300, y - 160)) for role, (x, y) in points.items()}
    assert distance["place"] < 6, "things are put into the middle of a ring"
    assert 30 < distance["pick"] < 54, "a ring is picked on its material, not in its hole"


def test_what_is_not_there_is_not_here() -> None:
    (absent,) = read(SCENE, ABSENT).targets
    assert not absent.found
    assert absent.box is None


def test_a_pictured_target_is_found_by_its_picture() -> None:
    target = Target("T1", "object", "the granite doodah", like=("a",), source="slot")
    (item,) = read(SCENE, target, slots=(slot("a", "star", "green"),)).targets
    assert item.box is not None
    assert in_view(item.box, SCENE).iou(STAR_BOX) > 0.85


def test_unknown_words_without_a_picture_are_refused() -> None:
    with pytest.raises(NotUnderstoodError, match="doodah"):
        read(SCENE, Target("T1", "object", "the doodah"))


def test_relations_and_free_areas() -> None:
    left = Target("T1", "object", "thing", where="left of the blue ring")
    spot = Target("T2", "area", "free area", where="between the blue ring and the green star")
    thing, area = read(SCENE, left, spot).targets
    assert thing.box is not None
    assert in_view(thing.box, SCENE).iou(Box(54, 54, 107, 107)) > 0.8
    assert area.found
    x, y = picture(SCENE).frame.point_to_view(area.points[0].point.as_tuple)
    assert 330 < x < 480
    assert 60 < y < 200


def test_shifted_pixels_shift_the_answer() -> None:
    (star,) = read(shifted(SCENE, 35, 33), STAR).targets
    assert star.box is not None
    assert in_view(star.box, SCENE).iou(STAR_BOX) < 0.4


def test_noise_holds_nothing() -> None:
    assert not any(item.found for item in read(noise(SCENE), STAR, RING).targets)


def test_samples_differ_but_stay_on_the_target() -> None:
    question = LocatePoints(STAR, "centre", (), picture(SCENE))
    points = set()
    for sample in range(3):
        answer = ask(question, sample=sample)
        assert isinstance(answer, Points)
        x, y = picture(SCENE).frame.point_to_view(answer.points[0].as_tuple)
        assert float(np.hypot(x - 500, y - 80)) < 20
        points.add((x, y))
    assert len(points) == 3
    absent = ask(LocatePoints(ABSENT, "centre", (), picture(SCENE)))
    assert isinstance(absent, Points)
    assert not absent.found


def test_rejected_points_are_left_out() -> None:
    view = table(("square", "red", 80, 80, 26), ("square", "red", 400, 200, 26))
    first = ask(LocatePoints(Target("T1", "object", "red square"), "centre", (), picture(view)))
    assert isinstance(first, Points)
    marked = picture(view).marked(PointMark(first.points[0].as_tuple))
    second = ask(LocatePoints(Target("T1", "object", "red square"), "centre", (), marked))
    assert isinstance(second, Points)
    assert abs(second.points[0].x - first.points[0].x) > 100


def test_choose_the_mark_on_the_target() -> None:
    frame = picture(SCENE).frame
    spots = [frame.point_to_picture(p) for p in ((80.0, 80.0), (520.0, 100.0), (500.0, 80.0))]
    answer = ask(ChooseMark(STAR, "centre", (), picture(SCENE).marked(Candidates(tuple(spots)))))
    assert isinstance(answer, MarkChoice)
    assert answer.number == 3
    none = ask(ChooseMark(STAR, "centre", (), picture(SCENE).marked(Candidates(tuple(spots[:1])))))
    assert isinstance(none, MarkChoice)
    assert none.number is None


def test_box_at_the_mark() -> None:
    view = table(("square", "red", 80, 80, 26), ("square", "red", 400, 200, 26))
    mark = picture(view).frame.point_to_picture((402.0, 205.0))
    answer = ask(GiveBox(Target("T1", "object", "red square"), (), picture(view).marked(PointMark(mark))))
    assert isinstance(answer, BoxAnswer)
    assert answer.box is not None
    assert in_view(answer.box, view).iou(Box(374, 174, 427, 227)) > 0.85
    gone = ask(GiveBox(ABSENT, (), picture(view)))
    assert isinstance(gone, BoxAnswer)
    assert gone.box is None


def judged(view: View, target: Target, box: Box) -> str:
    answer = ask(JudgeBox(target, boxed(view, box)))
    assert isinstance(answer, BoxVerdict)
    return answer.decision


@pytest.mark.parametrize(("target", "box"), [(STAR, STAR_BOX), (RING, RING_BOX)])
def test_checker_accepts_what_is_tight(target: Target, box: Box) -> None:
    assert judged(SCENE, target, box) == "accept"


@pytest.mark.parametrize("radii", [0.5, 0.8, 1.2, 2.0, 4.0])
def test_checker_refuses_a_shifted_box(radii: float) -> None:
    assert judged(SCENE, STAR, STAR_BOX.shifted(-35 * radii, 20 * radii)) != "accept"


def test_checker_refuses_another_thing_bare_table_and_noise() -> None:
    assert judged(SCENE, STAR, Box(54, 54, 107, 107)) == "reject"
    assert judged(SCENE, STAR, Box(150, 250, 210, 310)) == "reject"
    assert judged(noise(SCENE), STAR, STAR_BOX) != "accept"
    assert judged(shifted(SCENE, 35, 33), STAR, STAR_BOX) != "accept"


@pytest.mark.parametrize(
    "start", [Box(447, 60, 517, 126), Box(440, 20, 580, 150), Box(480, 60, 520, 95), Box(430, 30, 500, 96)]
)
def test_mover_brings_a_box_onto_its_target(start: Box) -> None:
    box = start
    for _ in range(5):
        shown = boxed(SCENE, box)
        strips = tuple(Strip(edge, side, cut) for (edge, side), cut in edge_strips(SCENE, box).items())
        move = ask(MoveBox(STAR, shown, strips))
        assert isinstance(move, BoxMove)
        before, box = box, shown.frame.box_to_view(move.apply(shown.marks[0].box))  # type: ignore[union-attr]
        both = Box.bounding([*before.corners, *box.corners])
        verdict = ask(JudgeRevision(STAR, boxed(SCENE, before, both), boxed(SCENE, box, both)))
        assert isinstance(verdict, RevisionVerdict)
        assert verdict.decision != "keep_before"
        if verdict.decision == "take_after_stop":
            break
    assert box.iou(STAR_BOX) > 0.8


def test_a_worse_revision_is_not_taken() -> None:
    both = Box.bounding([*STAR_BOX.corners, *STAR_BOX.shifted(-40, 0).corners])
    question = JudgeRevision(STAR, boxed(SCENE, STAR_BOX, both), boxed(SCENE, STAR_BOX.shifted(-40, 0), both))
    verdict = ask(question)
    assert isinstance(verdict, RevisionVerdict)
    assert verdict.decision == "keep_before"


def test_stop_only_where_it_is_offered() -> None:
    shown = boxed(SCENE, STAR_BOX)
    stop = ask(MoveBox(STAR, shown, (), may_stop=True))
    assert isinstance(stop, BoxMove)
    assert stop.action == "stop"
    move = ask(MoveBox(STAR, shown, ()))
    assert isinstance(move, BoxMove)
    assert move.action != "stop"


def test_strips_show_where_the_target_reaches() -> None:
    box = Box(480, 44, 535, 110)
    strips = tuple(Strip(edge, side, cut) for (edge, side), cut in edge_strips(SCENE, box).items())
    answer = ask(Presence(STAR, strips))
    assert isinstance(answer, PresenceAnswer)
    edges = {item.edge: item for item in answer.edges}
    assert edges["left"].outside
    assert edges["left"].inside
    assert not edges["bottom"].outside
    none = ask(Presence(STAR, ()))
    assert isinstance(none, PresenceAnswer)
    assert not any(item.inside or item.outside for item in none.edges)


@pytest.mark.parametrize(("role", "low", "high"), [("pick", 25.0, 55.0), ("place", 0.0, 20.0)])
def test_points_in_and_on_a_ring(role: str, low: float, high: float) -> None:
    shown = boxed(SCENE, RING_BOX)
    points = inside_points(shown.frame.box_to_picture(RING_BOX), 5, 5)
    answer = ask(ChoosePoint(RING, role, (), shown.marked(Candidates(points))))  # type: ignore[arg-type]
    assert isinstance(answer, PointChoice)
    x, y = shown.frame.point_to_view(points[answer.number - 1])
    assert low <= float(np.hypot(x - 300, y - 160)) <= high


def test_a_push_starts_on_the_far_side() -> None:
    shown = boxed(SCENE, STAR_BOX)
    around = tuple(
        shown.frame.point_to_picture(p) for p in ((450.0, 77.0), (550.0, 77.0), (500.0, 30.0), (500.0, 77.0))
    )
    target = Target("T1", "object", "green star", use=("push_start",))
    plan = ("G1: push the green star to the left",)
    answer = ask(ChoosePoint(target, "push_start", plan, shown.marked(Candidates(around))))
    assert isinstance(answer, PointChoice)
    assert answer.number == 2


def test_the_scene_has_the_size_that_the_boxes_assume() -> None:
    assert SCENE.size_px == SIZE


def test_a_free_area_keeps_off_the_places_that_others_need() -> None:
    from wonderful_team.contracts import ShownSlot

    free = Target("T1", "area", "free area", use=("place",))
    (alone,) = read(SCENE, free).targets
    assert alone.box is not None
    x, y = (int(value) for value in in_view(alone.box, SCENE).centre)
    goal = table(("star", "green", x, y, 36))
    place = Target("T2", "area", "place of the green star", source="slot", like=("goal",), use=("place",))
    slots = (ShownSlot("goal", "scene", (picture(goal),)),)
    spot, there = read(SCENE, free, place, slots=slots).targets
    assert spot.box is not None
    assert there.box is not None
    assert in_view(spot.box, SCENE).intersection(in_view(there.box, SCENE)) is None
