"""What a model's name suggests, and what it does not."""

from __future__ import annotations

import pytest

from wonderful_team.models.families import guess_family


@pytest.mark.parametrize(
    ("model", "family"),
    [
        ("gemini-2.5-pro", "gemini"),
        ("google/gemini-3-flash", "gemini"),
        ("gemini-robotics-er-1.5-preview", "gemini"),
        ("claude-opus-5", "claude"),
        ("anthropic/claude-sonnet-4.5", "claude"),
        ("gpt-5.2", "gpt"),
        ("openai/gpt-4o", "gpt"),
        ("o4-mini", "gpt"),
        ("Qwen/Qwen2-VL-2B-Instruct", "qwen2-vl"),
        ("Qwen/Qwen2.5-VL-7B-Instruct", "qwen2.5-vl"),
        ("qwen2.5vl:7b", "qwen2.5-vl"),
        ("qwen3-vl:8b", "qwen3-vl"),
        ("Qwen/Qwen3.5-27B", "qwen3-vl"),
        ("allenai/Molmo-7B-D-0924", "molmo1"),
        ("allenai/Molmo2-8B", "molmo2"),
        ("OpenGVLab/InternVL2_5-8B", "internvl"),
        ("google/gemma-3-12b-it", "gemma"),
        ("vikhyatk/moondream2", "moondream"),
    ],
)
def test_families_are_told_by_their_names(model: str, family: str) -> None:
    assert guess_family(model).name == family


@pytest.mark.parametrize("model", ["my-planner-v3", "test-model", "llava", "phi-4"])
def test_an_unknown_name_gets_pixels_with_labelled_axes_and_no_native_boxes(model: str) -> None:
    family = guess_family(model)
    assert (family.name, family.convention.name, family.sure) == ("unknown", "pixels", "unknown")
    assert family.weak_pointing
    assert not family.native_boxes


def test_gpt_points_weakly() -> None:
    assert guess_family("gpt-5").weak_pointing
    assert not guess_family("gemini-2.5-pro").weak_pointing
