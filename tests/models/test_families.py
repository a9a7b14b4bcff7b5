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
        ("claude-opus-5", "claude-4.7"),
        ("claude-opus-4-7", "claude-4.7"),
        ("anthropic/claude-sonnet-4.8", "claude-4.7"),
        ("claude-haiku-5-20260801", "claude-4.7"),
        ("claude-opus-4-1-20250805", "claude"),
        ("claude-opus-4-20250514", "claude"),
        ("claude-3-7-sonnet-latest", "claude"),
        ("anthropic/claude-sonnet-4.5", "claude"),
        ("gpt-5.2", "gpt-tiles"),
        ("openai/gpt-4o", "gpt-tiles"),
        ("o3", "gpt-tiles"),
        ("o4-mini", "gpt-patches"),
        ("gpt-5-mini", "gpt-patches"),
        ("openai/gpt-5.4", "gpt"),
        ("gpt-5.6", "gpt"),
        ("gpt-6-astra", "gpt"),
        ("zai-org/GLM-4.5V", "glm-v"),
        ("glm-4.1v-thinking", "glm-v"),
        ("moonshotai/Kimi-VL-A3B-Instruct", "kimi-vl"),
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


@pytest.mark.parametrize(
    "model",
    [
        "my-planner-v3",
        "test-model",
        "llava",
        "phi-4",
        "BAAI/RoboBrain2.0-7B",
        "nvidia/Cosmos-Reason2-8B",
        "IffYuan/Embodied-R1-3B-v1",
        "XiaomiMiMo/MiMo-VL-7B-RL",
        "moonshotai/kimi-k2.5",
        "glm-4.6",
    ],
)
def test_an_unknown_name_gets_pixels_with_labelled_axes_and_no_native_boxes(model: str) -> None:
    family = guess_family(model)
    assert (family.name, family.convention.name, family.sure) == ("unknown", "pixels", "unknown")
    assert family.weak_pointing


def test_gpt_points_weakly() -> None:
    assert guess_family("gpt-5").weak_pointing
    assert not guess_family("gemini-2.5-pro").weak_pointing


@pytest.mark.parametrize(
    ("model", "sent", "seen"),
    [
        ("claude-sonnet-4-5", (1568, 1176), (1252, 939)),
        ("claude-opus-5", (1568, 1176), (1568, 1176)),
        ("claude-opus-5", (4000, 1000), (2576, 644)),
        ("gpt-4o", (1568, 1176), (1024, 768)),
        ("gpt-5.6", (1568, 1176), (1568, 1176)),
    ],
)
def test_pictures_are_sent_in_the_size_in_which_a_family_looks_at_them(
    model: str, sent: tuple[int, int], seen: tuple[int, int]
) -> None:
    found = guess_family(model).convention.seen_size(sent)
    assert found == pytest.approx(seen, abs=1)
    assert guess_family(model).convention.seen_size(found) == found, "a second resize changes nothing"
