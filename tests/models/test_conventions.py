"""Every family's convention is undone exactly, at any picture size and aspect."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from wonderful_team.models.conventions import CONVENTIONS, PIXELS, Convention, Resize

sides = st.integers(28, 4000)
sizes = st.tuples(sides, sides).filter(lambda size: max(size) / min(size) <= 100)
shares = st.lists(st.tuples(st.floats(-0.1, 1.1), st.floats(-0.1, 1.1)), min_size=1, max_size=5)
names = st.sampled_from(sorted(CONVENTIONS))


@settings(deadline=None)
@given(names, sizes, shares)
def test_points_come_back_from_every_family(name, size, shares):
    points = np.array(shares) * size
    convention = CONVENTIONS[name]
    assert np.allclose(convention.to_px(convention.to_model(points, size), size), points, atol=1e-6)


@settings(deadline=None)
@given(names, sizes, st.tuples(st.floats(-30, 30), st.floats(-30, 30)), st.floats(0.5, 2), st.floats(0.5, 2), shares)
def test_points_come_back_from_a_fitted_convention(name, size, offset, sx, sy, shares):
    row = CONVENTIONS[name]
    fitted = Convention("fitted", row.order, row.unit, row.resize, offset, (sx, sy))
    points = np.array(shares) * size
    assert np.allclose(fitted.to_px(fitted.to_model(points, size), size), points, atol=1e-6)


@settings(deadline=None)
@given(names, sizes)
def test_edges_of_the_picture_are_the_ends_of_the_scale(name, size):
    convention = CONVENTIONS[name]
    far = convention.to_model([size], size)[0]
    span = convention.span(size)
    assert np.allclose(far, span[::-1] if convention.order == "yx" else span)
    assert np.allclose(convention.to_model([(0, 0)], size), 0)


@settings(deadline=None)
@given(st.sampled_from(["claude", "qwen2.5-vl"]), sizes)
def test_a_models_own_resize_settles_after_one_pass(name, size):
    resize = CONVENTIONS[name].resize
    once = resize.size(size)
    assert resize.size(once) == once
    assert once[0] % resize.multiple == 0
    assert once[1] % resize.multiple == 0


@settings(deadline=None)
@given(sizes)
def test_claude_is_never_sent_more_than_it_looks_at(size):
    width, height = CONVENTIONS["claude"].seen_size(size)
    assert max(width, height) <= 1568
    assert width * height <= 1_176_000
    assert (width, height) == size or abs(width / height - size[0] / size[1]) < 0.05 * size[0] / size[1] + 0.2


@pytest.mark.parametrize(
    ("name", "size", "point", "expected"),
    [
        ("gemini", (640, 480), (320, 120), (250, 500)),  # y first, thousandths
        ("claude", (3136, 800), (1568, 400), (784, 200)),  # halved to 1568 x 400
        ("claude", (640, 480), (320, 120), (320, 120)),  # small pictures stay
        ("claude-4.7", (5152, 1288), (2576, 644), (1288, 322)),  # halved to 2576 x 644
        ("gpt", (640, 480), (320, 120), (320, 120)),
        ("gpt-tiles", (1536, 1536), (768, 384), (384, 192)),  # halved to 768 x 768
        ("gpt-patches", (4096, 512), (2048, 256), (1024, 128)),  # halved to 2048 x 256
        ("glm-v", (640, 480), (320, 120), (500, 250)),
        ("kimi-vl", (640, 480), (320, 120), (0.5, 0.25)),
        ("qwen2-vl", (640, 480), (320, 120), (500, 250)),
        ("qwen2.5-vl", (640, 480), (320, 120), (322, 119)),  # 644 x 476
        ("qwen3-vl", (640, 480), (320, 120), (500, 250)),
        ("molmo1", (640, 480), (320, 120), (50, 25)),
        ("molmo2", (640, 480), (320, 120), (500, 250)),
        ("internvl", (640, 480), (320, 120), (500, 250)),
        ("gemma", (640, 480), (320, 120), (500, 250)),
        ("moondream", (640, 480), (320, 120), (0.5, 0.25)),
        ("pixels", (640, 480), (320, 120), (320, 120)),
    ],
)
def test_what_each_family_says_of_one_point(name, size, point, expected):
    assert CONVENTIONS[name].to_model([point], size)[0] == pytest.approx(expected)


def test_every_family_of_the_table_has_a_worked_example():
    assert set(CONVENTIONS) == {
        "pixels", "gemini", "claude", "gpt", "qwen2-vl", "qwen2.5-vl", "qwen3-vl", "molmo1", "molmo2", "internvl",
        "gemma", "moondream", "claude-4.7", "gpt-tiles", "gpt-patches", "glm-v", "kimi-vl",
    }  # fmt: skip


def test_an_own_offset_and_scale_are_undone():
    odd = Convention("odd", "yx", "pixels", offset_px=(10, -4), scale=(2.0, 0.5))
    assert odd.to_model([(100, 50)], (640, 480))[0] == pytest.approx((21, 210))
    assert odd.to_px([(21, 210)], (640, 480))[0] == pytest.approx((100, 50))


def test_impossible_numbers_are_refused():
    with pytest.raises(ValueError, match="scale must be positive"):
        Convention("bad", scale=(0.0, 1.0))
    with pytest.raises(ValueError, match="at least 1"):
        Resize(multiple=0)
    assert PIXELS.span((640, 480)) == (640, 480)
