"""What every drawn picture keeps: inputs untouched, marks seen on any ground, plates inside, apart and off the points."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.images.scenes import view
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Axes, BoxMark, Candidates, LineMark, Mark, PathMark, Picture, Point, PointMark
from wonderful_team.core.values import GroundedTarget, KeepOut, Limits, Target, View
from wonderful_team.images import Ticks, crop, draw, inside_points, overview, whole
from wonderful_team.images.axes import SPANS, axis_step, axis_ticks, round_step
from wonderful_team.images.canvas import INK, Canvas, Rectangle
from wonderful_team.images.draw import candidate_radius, draw_box
from wonderful_team.images.lettering import plain
from wonderful_team.images.overview import MOST_IN_WORDS
from wonderful_team.images.placing import PointLabel, label_box, label_points

MARKS: dict[str, Mark] = {
    "axes": Axes(),
    "target box": BoxMark(Box(100, 80, 220, 200), "target"),
    "before box": BoxMark(Box(100, 80, 220, 200), "before"),
    "after box": BoxMark(Box(100, 80, 220, 200), "after"),
    "keep-out box": BoxMark(Box(100, 80, 220, 200), "keep_out"),
    "workspace box": BoxMark(Box(100, 80, 220, 200), "workspace"),
    "point": PointMark((150.0, 120.0)),
    "candidates": Candidates(((150.0, 120.0), (200.0, 160.0))),
    "path": PathMark(((60.0, 60.0), (200.0, 150.0))),
    "line": LineMark((0.0, 0.0), (0.0, 240.0)),
}


def flat(grey: int, width: int = 320, height: int = 240) -> Picture:
    rgb = np.full((height, width, 3), grey, np.uint8)
    return Picture("flat", rgb, Frame.whole("v", (width, height)))


def luminance(rgb: Array) -> Array:
    return np.asarray(rgb.astype(float) @ (0.2126, 0.7152, 0.0722))


@pytest.mark.parametrize("name", list(MARKS))
@pytest.mark.parametrize("grey", [0, 64, 128, 192, 255])
def test_every_mark_shows_on_any_ground(name: str, grey: int) -> None:
    clean = flat(grey)
    drawn = draw(clean.marked(MARKS[name]))
    contrast = np.abs(luminance(drawn) - luminance(clean.rgb))
    assert (contrast > 60).sum() >= 30
    assert drawn.shape == clean.rgb.shape
    assert (clean.rgb == grey).all()


def test_without_marks_the_pixels_stay() -> None:
    picture = whole(view(), "top")
    drawn = draw(picture)
    assert np.array_equal(drawn, picture.rgb)
    assert drawn.flags.writeable
    assert not np.shares_memory(drawn, picture.rgb)


def test_a_box_is_drawn_on_its_edges_and_nowhere_else() -> None:
    clean = flat(128)
    changed = (draw(clean.marked(MARKS["target box"])) != clean.rgb).any(axis=2)
    rows, columns = np.nonzero(changed)
    assert (columns.min() + columns.max() + 1) / 2 == pytest.approx(160, abs=0.5)
    assert (rows.min() + rows.max() + 1) / 2 == pytest.approx(140, abs=0.5)
    assert not changed[90:190, 110:210].any()
    for x, y in ((100, 140), (219, 140), (160, 80), (160, 199)):
        assert changed[y, x]


def test_a_line_along_the_border_shows_inside() -> None:
    clean = flat(128)
    for line in (LineMark((0, 0), (0, 240)), LineMark((320, 0), (320, 240)), LineMark((0, 240), (320, 240))):
        changed = (draw(clean.marked(line)) != clean.rgb).any(axis=2)
        assert changed.sum() > 2 * 230


def overlap(a: Rectangle, b: Rectangle) -> float:
    return max(0.0, min(a[2], b[2]) - max(a[0], b[0])) * max(0.0, min(a[3], b[3]) - max(a[1], b[1]))


def plates_of(points: tuple[Point, ...], width: int, height: int) -> tuple[list[Rectangle], float]:
    """Where the number plates of candidates come to stand, and the radius of a dot."""
    canvas = Canvas.over(np.zeros((height, width, 3), np.uint8))
    radius = candidate_radius(canvas)
    for point in points:
        canvas.keep_clear(point, radius - 1)
        canvas.named.append(point)
    placed = label_points(canvas, [PointLabel(point, str(k), radius, INK) for k, point in enumerate(points, start=1)])
    return [spot for _, spot in placed], radius


@pytest.mark.parametrize("pitch", [16, 22, 34, 60])
def test_number_plates_never_cover_each_other_or_a_point(pitch: int) -> None:
    points = inside_points(Box.around((320, 240), 5 * pitch, 5 * pitch), 5, 5)
    plates, radius = plates_of(points, 640, 480)
    assert len(plates) == 25
    for first, second in itertools.combinations(plates, 2):
        assert overlap(first, second) == 0
    for plate, (x, y) in itertools.product(plates, points):
        assert overlap(plate, (x - radius + 1, y - radius + 1, x + radius - 1, y + radius - 1)) == 0


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.lists(st.tuples(st.floats(0, 320), st.floats(0, 240)), min_size=1, max_size=9))
def test_number_plates_stay_inside_the_picture(points: list[Point]) -> None:
    plates, _ = plates_of(tuple(points), 320, 240)
    assert all(x0 >= 0 and y0 >= 0 and x1 <= 320 and y1 <= 240 for x0, y0, x1, y1 in plates)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    corner=st.tuples(st.floats(-60, 310), st.floats(-60, 230)), sides=st.tuples(st.floats(2, 400), st.floats(2, 300))
)
def test_box_labels_stay_inside_the_picture(corner: Point, sides: tuple[float, float]) -> None:
    canvas = Canvas.over(np.zeros((240, 320, 3), np.uint8))
    label_box(canvas, Box(*corner, corner[0] + sides[0], corner[1] + sides[1]), "T1 red block", back=INK)
    (plate,) = canvas.taken
    assert plate[0] >= 0
    assert plate[1] >= 0
    assert plate[2] <= 320
    assert plate[3] <= 240


def test_two_labels_of_one_box_do_not_cover_each_other() -> None:
    canvas = Canvas.over(np.zeros((240, 320, 3), np.uint8))
    for text in ("T1 red block", "T2 blue bowl", "T3 star"):
        label_box(canvas, Box(0, 0, 100, 60), text, back=INK)
    assert all(overlap(a, b) == 0 for a, b in itertools.combinations(canvas.taken, 2))


@settings(max_examples=80, deadline=None, derandomize=True)
@given(
    size=st.tuples(st.integers(60, 1600), st.integers(60, 1600)),
    ticks=st.sampled_from(list(Ticks)),
    spacing=st.floats(20, 120),
)
def test_ticks_stand_at_the_number_they_carry(size: tuple[int, int], ticks: Ticks, spacing: float) -> None:
    frame = Frame.whole("v", size)
    for axis in (0, 1):
        step = axis_step(frame, Axes(), ticks, axis, spacing)
        row = axis_ticks(frame, Axes(), ticks, axis, step)
        unit = 1.0 if ticks is Ticks.PIXELS else size[axis] / SPANS[ticks]
        assert [tick.at_px for tick in row] == pytest.approx([tick.value * unit for tick in row])
        assert all(b.at_px - a.at_px >= spacing - 1e-6 for a, b in itertools.pairwise(row))
        assert all(0 <= tick.at_px <= size[axis] for tick in row)


def test_reference_axes_name_the_other_pictures_pixels() -> None:
    source = view(256, 128)
    sent = whole(source, "top")
    part = crop(source, Box(40, 50, 90, 90), "crop")
    for tick in axis_ticks(part.frame, Axes(reference=sent.frame), Ticks.PIXELS, 0, 20):
        in_view = part.frame.point_to_view((tick.at_px, 0.0))
        assert sent.frame.point_to_picture(in_view)[0] == pytest.approx(tick.value)


def test_steps_are_round() -> None:
    assert [round_step(v) for v in (0.2, 1, 1.5, 7, 12, 21, 26, 51, 130, 240, 900)] == [
        1, 1, 2, 10, 20, 25, 50, 100, 200, 250, 1000,
    ]  # fmt: skip


def test_labels_are_plain_and_short() -> None:
    assert plain("  grüne  Tasse ") == "grune Tasse"
    assert plain("a\nb\tc") == "a b c"
    assert plain("杯") == "?"
    assert len(plain("the long thin wooden spoon beside the bowl")) == 28


def test_marks_past_the_picture_are_drawn_without_error() -> None:
    picture = flat(128).marked(
        Axes(),
        BoxMark(Box(-500, -500, 900, 900), "target", "all"),
        BoxMark(Box(400, 400, 500, 500), "keep_out", "away"),
        PointMark((-40.0, 700.0), "far"),
        PathMark(((5.0, 5.0),), "still"),
        PathMark(()),
        PathMark(((5.0, 5.0), (5.0, 5.0))),
        Candidates(((0.0, 0.0), (320.0, 240.0))),
    )
    assert draw(picture).shape == (240, 320, 3)
    tiny = Picture("tiny", np.zeros((3, 5, 3), np.uint8), Frame.whole("v", (5, 3)))
    assert draw(tiny.marked(*MARKS.values())).shape == (3, 5, 3)


class TableCamera:
    """A camera straight above: 400 px per metre, table centre (0.5, 0) at (160, 120) px."""

    def project(self, points_m: Array) -> Array:
        points = np.asarray(points_m, dtype=float)
        return np.column_stack([160 + 400 * points[:, 1], 120 + 400 * (points[:, 0] - 0.5)])

    def deproject(self, points_px: Array, depth_m: Array) -> Array:
        raise NotImplementedError

    def on_plane(self, points_px: Array, z_m: float) -> Array:
        raise NotImplementedError


def test_overview_puts_metres_and_pixels_in_one_picture() -> None:
    rgb = np.full((240, 320, 3), 128, np.uint8)
    limits = Limits((0.25, -0.3, 0.0), (0.75, 0.3, 0.4), keep_out=(KeepOut("", Box(0.6, 0.1, 0.7, 0.2), "m"),))
    scene = View("top", "top", 0.0, rgb, camera=TableCamera())
    drawn = overview(scene, workspace=limits)
    changed = (drawn != 128).any(axis=2)
    assert drawn.shape == (480, 640, 3)
    assert changed[2 * 20, 200:400].any()  # workspace: x = 0.25 m lies at row 20
    assert changed[2 * 180, 2 * 220]  # keep-out: its middle (0.65, 0.15) m is tinted
    assert not changed[2 * 120, 2 * 160]
    without_camera = overview(View("top", "top", 0.0, rgb), workspace=limits)
    assert (without_camera == 128).all()


def test_in_a_crowd_targets_are_named_by_their_ids_alone() -> None:
    """Words of six blocks a row would lie over the blocks beside."""

    def drawn(words: str, count: int) -> Array:
        places = [
            Box(10 + 90 * (k % 6), 20 + 90 * (k // 6), 50 + 90 * (k % 6), 60 + 90 * (k // 6)) for k in range(count)
        ]
        found = [
            GroundedTarget(Target(f"T{k + 1}", "object", words), "found", "top", box) for k, box in enumerate(places)
        ]
        return overview(View("top", "top", 0.0, np.full((480, 640, 3), 200, np.uint8)), found)

    assert np.array_equal(drawn("red block", MOST_IN_WORDS + 1), drawn("a much longer name", MOST_IN_WORDS + 1))
    assert not np.array_equal(drawn("red block", MOST_IN_WORDS), drawn("a much longer name", MOST_IN_WORDS))


def test_overview_leaves_out_what_was_not_found() -> None:
    target = Target("T1", "object", "red block")
    lost = GroundedTarget(target, "gave_up", "top", Box(10, 10, 50, 50))
    found = GroundedTarget(target, "found", "top", Box(10, 10, 50, 50), {"pick": (30.0, 30.0)})
    plainly = whole(view(), "overview").rgb
    assert np.array_equal(overview(view(), {"T1": lost}), plainly)
    assert not np.array_equal(overview(view(), {"T1": found}), plainly)
    assert not np.array_equal(overview(view(), [found], arrows=[((30, 30), (300, 200))]), overview(view(), [found]))


FAR = (1e3, 1e5, 1e9, 1e18, 1e60, 1e154, 1e300, 1.7e308, float("inf"), float("nan"))


@pytest.mark.parametrize("far", FAR)
def test_outlines_that_reach_as_far_as_numbers_go_are_drawn_at_once(far: float) -> None:
    """A workspace out of a file may have any size; its dashes are laid along what is seen."""
    for corners in (
        [(-far, -far), (far, -far), (far, far), (-far, far)],
        [(20, 20), (far, 20), (far, 60), (20, 60)],
        [(-far, 30), (far, 31), (30, far), (31, -far)],
    ):
        canvas = Canvas.over(np.zeros((120, 160, 3), np.uint8))
        draw_box(canvas, corners, "workspace")
        if np.isfinite(far):
            draw_box(canvas, corners, "keep_out")


def test_a_side_that_leaves_the_picture_is_dashed_as_far_as_it_is_seen() -> None:
    canvas = Canvas.over(np.zeros((120, 160, 3), np.uint8))
    draw_box(canvas, [(20, 20), (1e4, 20), (1e4, 1e4), (20, 1e4)], "workspace")
    bright = canvas.rgb[20].max(axis=1) > 60
    assert not bright[:10].any()
    # Dashes and gaps take turns up to the border.
    assert np.count_nonzero(np.diff(bright[20:].astype(int))) >= 6
    assert bright[-40:].any()
