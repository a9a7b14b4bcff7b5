"""The detectors of `transformers`, with tiny random weights: loaded, asked and read as trained ones are. No network: the sockets are shut.

Marked, because torch and transformers are in no default environment:

    PYTHON -m pytest --rundetectors tests/detectors
"""

from __future__ import annotations

import asyncio
import json
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.detectors import tiny_weights
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Detection
from wonderful_team.detectors import detect
from wonderful_team.detectors.loading import Weights
from wonderful_team.detectors.sam import SamSegmenter, Segmented
from wonderful_team.errors import ConfigError, NotUnderstoodError
from wonderful_team.registry.detectors import make_detector

pytestmark = [
    pytest.mark.detectors,
    # What the libraries themselves warn of is theirs.
    pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning", "ignore::UserWarning"),
]
WORDS = ("red block", "bowl")


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    folder = tmp_path_factory.mktemp("weights")
    return SimpleNamespace(
        owlv2=tiny_weights.write_owlv2(folder / "owlv2"),
        owlvit=tiny_weights.write_owlv2(folder / "owlvit", "owlvit"),
        dino=tiny_weights.write_grounding_dino(folder / "dino"),
        sam=tiny_weights.write_sam(folder / "sam"),
    )


def picture(height: int = 48, width: int = 80) -> np.ndarray:
    return np.random.default_rng(5).integers(0, 255, (height, width, 3)).astype(np.uint8)


def look(detector: Any, rgb: np.ndarray, *words: str) -> tuple[Detection, ...]:
    return asyncio.run(detect(detector, rgb, words or WORDS))


def answering(detector: Any, monkeypatch: pytest.MonkeyPatch, **outputs: Any) -> list[dict[str, Any]]:
    """Let the network answer these tensors; returns what it is given."""
    given: list[dict[str, Any]] = []

    def forward(**inputs: Any) -> Any:
        given.append(inputs)
        return SimpleNamespace(**{key: value.clone() for key, value in outputs.items()})

    inner = detector._loaded.model
    monkeypatch.setattr(
        detector,
        "_loaded",
        SimpleNamespace(model=_Called(inner, forward), processor=detector._loaded.processor, device="cpu", commit=""),
    )
    return given


class _Called:
    """A network whose answers are given."""

    def __init__(self, inner: Any, forward: Any) -> None:
        self.inner, self.forward = inner, forward

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def __call__(self, **inputs: Any) -> Any:
        return self.forward(**inputs)


@pytest.mark.parametrize("kind", ["owlv2", "owlvit", "groundingdino"])
def test_random_weights_give_detections_within_the_picture_the_same_ones_twice(
    kind: str, weights: SimpleNamespace
) -> None:
    folder = {"owlv2": weights.owlv2, "owlvit": weights.owlvit, "groundingdino": weights.dino}[kind]
    threshold = "box_threshold" if kind == "groundingdino" else "threshold"
    name = f"{'groundingdino' if kind == 'groundingdino' else 'owlv2'}:{folder}"
    detector, rgb = make_detector(f"{name}?{threshold}=0.05"), picture(300, 200)
    found = look(detector, rgb)
    assert found
    assert {one.words for one in found} <= set(WORDS)
    assert all(one.score > 0.05 and one.mask is None for one in found)
    assert [(one.words, one.box, one.score) for one in look(detector, rgb)] == [
        (one.words, one.box, one.score) for one in found
    ]
    assert look(make_detector(f"{name}?{threshold}=1"), rgb) == ()
    if kind == "groundingdino":
        assert {one.words for one in found} == set(WORDS)


def test_a_box_of_owlv2_is_read_in_the_square_that_the_picture_is_padded_to(
    weights: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    import torch

    detector: Any = make_detector(f"owlv2:{weights.owlv2}?threshold=0.5")
    # Three patches: one on "red block", one on "bowl", one below the threshold; a fourth lies in the padding alone.
    logits = torch.full((1, 4, 2), -5.0)
    logits[0, 0, 0], logits[0, 1, 1], logits[0, 2, 0], logits[0, 3, 0] = 3.0, 2.0, -1.0, 4.0
    boxes = torch.tensor([[[0.25, 0.25, 0.1, 0.2], [0.9, 0.5, 0.3, 0.2], [0.5, 0.5, 0.2, 0.2], [0.5, 0.9, 0.2, 0.1]]])
    given = answering(detector, monkeypatch, logits=logits, pred_boxes=boxes)
    red, bowl = look(detector, picture(60, 100))
    # The side of the square is 100 px: 0.25 is 25 px down and across.
    assert red.box.as_tuple == pytest.approx((20, 15, 30, 35), abs=1e-3)
    # Beyond the right edge it is cut.
    assert bowl.box.as_tuple == pytest.approx((75, 40, 100, 60), abs=1e-3)
    assert (red.words, bowl.words) == WORDS
    assert (red.score, bowl.score) == pytest.approx((1 / (1 + np.exp(-3)), 1 / (1 + np.exp(-2))), abs=1e-6)
    assert given[0]["pixel_values"].shape == (1, 3, 64, 64)
    assert given[0]["input_ids"].shape == (2, tiny_weights.TEXT_TOKENS)


def test_grounding_dino_is_asked_one_description_at_a_time_and_both_thresholds_count(
    weights: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    import torch

    detector: Any = make_detector(f"groundingdino:{weights.dino}?box_threshold=0.5&text_threshold=0.7")
    # Tokens of the prompt: [CLS] red block . [SEP]. Query 0 is sure of "red"; 1 is not sure of any word; 2 is of nothing.
    logits = torch.full((1, 3, 32), -8.0)
    logits[0, 0, 1], logits[0, 1, 2] = 2.0, 0.4
    boxes = torch.tensor([[[0.5, 0.5, 0.2, 0.4], [0.2, 0.2, 0.1, 0.1], [0.8, 0.8, 0.1, 0.1]]])
    given = answering(detector, monkeypatch, logits=logits, pred_boxes=boxes)
    found = look(detector, picture(60, 100), "Red Block.", "bowl")
    assert [one.words for one in found] == ["Red Block.", "bowl"]
    assert all(one.box.as_tuple == pytest.approx((40, 18, 60, 42), abs=1e-3) for one in found)
    tokenizer = detector._loaded.processor.tokenizer
    assert [tokenizer.decode(one["input_ids"][0]) for one in given] == [
        "[CLS] red block. [SEP]",
        "[CLS] bowl. [SEP]",
    ]


def test_langsam_takes_boxes_and_scores_from_grounding_dino_and_masks_from_sam(weights: SimpleNamespace) -> None:
    rgb = picture()
    boxes = look(make_detector(f"groundingdino:{weights.dino}"), rgb)
    masked = look(make_detector(f"langsam:{weights.dino}?sam={weights.sam}"), rgb)
    assert boxes
    assert [(one.words, one.box, one.score) for one in masked] == [(one.words, one.box, one.score) for one in boxes]
    assert any(one.mask is not None for one in masked)
    setting = make_detector(f"langsam:{weights.dino}?sam={weights.sam}").setting  # type: ignore[attr-defined]
    assert (setting["box_threshold"], setting["text_threshold"]) == ("0.3", "0.25")
    assert setting["sam"] == str(weights.sam)


def test_sam_is_asked_for_one_mask_a_box_in_the_pixels_of_its_own_size(
    weights: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    import torch

    segmenter: Any = SamSegmenter(Weights(str(weights.sam)))
    # The left half of the (padded) square for the first box, nothing for the second.
    masks = torch.full((1, 2, 1, 16, 16), -10.0)
    masks[0, 0, 0, :, :8] = 10.0
    given = answering(segmenter, monkeypatch, pred_masks=masks)
    first, second = segmenter.masks(picture(40, 80), [Box(0, 0, 20, 40), Box(40, 0, 80, 20)])
    assert first.shape == second.shape == (40, 80)
    assert first[:, :38].all()
    assert not first[:, 42:].any()
    assert not second.any()
    assert given[0]["multimask_output"] is False
    # 80 px become 64: the boxes are scaled by 0.8.
    assert given[0]["input_boxes"].tolist() == [[[0, 0, 16, 32], [32, 0, 64, 16]]]


def test_a_box_in_which_sam_sees_nothing_stays_a_box() -> None:
    class Found:
        name = "found"

        def detect(self, rgb: np.ndarray, words: Any) -> list[Detection]:
            own = np.ones(rgb.shape[:2], bool)
            return [
                Detection("bowl", Box(0, 0, 9, 9), 0.5),
                Detection("bowl", Box(9, 9, 20, 20), 0.4),
                Detection("bowl", Box(20, 20, 30, 30), 0.3, own),
            ]

    class Half:
        name, setting = "half", {"sam": "half"}

        def masks(self, rgb: np.ndarray, boxes: list[Box]) -> list[np.ndarray]:
            assert len(boxes) == 2
            return [np.zeros(rgb.shape[:2], bool), np.eye(*rgb.shape[:2], dtype=bool)]

    first, second, third = look(Segmented(Found(), Half()), picture(), "bowl")  # type: ignore[arg-type]
    assert first.mask is None
    assert second.mask is not None
    assert second.mask.sum() == 48
    assert third.mask is not None
    assert third.mask.all()


def test_words_that_the_model_cannot_read_whole_are_refused(weights: SimpleNamespace) -> None:
    with pytest.raises(NotUnderstoodError, match="at most 16 tokens.*'the second largest bowl' has 22"):
        look(make_detector(f"owlv2:{weights.owlv2}"), picture(), "the second largest bowl")
    with pytest.raises(NotUnderstoodError, match="at most 32 tokens"):
        look(make_detector(f"groundingdino:{weights.dino}"), picture(), "the red bowl " * 12)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "owlv2:google/owlv2-base-patch16-ensemble",
            r"nothing is downloaded .* `hf download google/owlv2-base-patch16-e",
        ),
        ("groundingdino:no/such?revision=abc", r"'no/such' at 'abc' are not .*`hf download no/such --revision abc`"),
        ("owlv2:/no/such/folder", "there is no folder '/no/such/folder'"),
        ("owlv2:DINO", "of the type 'grounding-dino'; valid: owlv2, owlvit"),
        ("langsam:DINO?sam=OWL", "segmenter 'sam': .* of the type 'owlv2'; valid: sam"),
        ("owlv2:EMPTY", "cannot be read as a checkpoint"),
        ("owlv2:OWL?device=cuda:77", "device 'cuda:77' cannot be used"),
        ("owlv2:OWL?dtype=int8", "unknown dtype 'int8'"),
        ("owlv2:OWL?threshold=2", "threshold 2.0: valid is 0 to 1"),
    ],
)
def test_weights_that_are_not_here_or_are_others_say_what_to_do(
    name: str, message: str, weights: SimpleNamespace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HF_HOME", str(tmp_path / "hub"))
    places = {"DINO": weights.dino, "OWL": weights.owlv2, "EMPTY": tmp_path}
    for word, place in places.items():
        name = name.replace(word, str(place))
    with pytest.raises(ConfigError, match=message):
        make_detector(name)


def test_a_checkpoint_that_lacks_weights_is_refused(weights: SimpleNamespace, tmp_path: Path) -> None:
    """The library would fill them at random, and the detector would find anything."""
    from safetensors.torch import load_file, save_file

    shutil.copytree(weights.owlv2, tmp_path / "cut")
    file = tmp_path / "cut" / "model.safetensors"
    kept = {key: value for key, value in load_file(file).items() if not key.startswith("class_head")}
    save_file(kept, file, metadata={"format": "pt"})
    with pytest.raises(ConfigError, match="lacks 6 of its weights, as class_head"):
        make_detector(f"owlv2:{tmp_path / 'cut'}")


def test_weights_that_could_run_code_are_not_read(weights: SimpleNamespace, tmp_path: Path) -> None:
    """A pickle is code: only safetensors are loaded."""
    import torch
    from safetensors.torch import load_file

    shutil.copytree(weights.owlv2, tmp_path / "pickled")
    file = tmp_path / "pickled" / "model.safetensors"
    torch.save(load_file(file), tmp_path / "pickled" / "pytorch_model.bin")
    file.unlink()
    with pytest.raises(ConfigError, match="safetensors"):
        make_detector(f"owlv2:{tmp_path / 'pickled'}")


@pytest.mark.parametrize("dtype", ["float16", "bfloat16"])
def test_other_types_of_number_find_about_the_same(dtype: str, weights: SimpleNamespace) -> None:
    exact = look(make_detector(f"owlv2:{weights.owlv2}?threshold=0.05"), picture(200, 200))
    found = look(make_detector(f"owlv2:{weights.owlv2}?dtype={dtype}&threshold=0.05"), picture(200, 200))
    assert exact
    assert [one.score for one in found] == pytest.approx([one.score for one in exact], abs=0.05)


def test_the_configuration_that_was_loaded_is_said(weights: SimpleNamespace) -> None:
    setting = make_detector(f"owlv2:{weights.owlv2}").setting  # type: ignore[attr-defined]
    assert setting["model"] == str(weights.owlv2)
    assert (setting["device"], setting["dtype"], setting["threshold"]) == ("cpu", "float32", "0.1")
    assert json.loads((weights.owlv2 / "config.json").read_text())["model_type"] == "owlv2"


def test_the_team_grounds_with_one_and_the_record_says_with_which_weights(
    weights: SimpleNamespace, tmp_path: Path, runs_folder: Path
) -> None:
    """Random weights find anything; what counts is that they are asked, drawn, recorded and replayed."""
    import wonderful_team as wt
    from wonderful_team.api.replay import replay

    name = f"langsam:{weights.dino}?sam={weights.sam}&box_threshold=0.1"
    team = wt.Team(method="detector-grounding", detector=name)
    made = team.ground(picture(120, 160), ["red block", "bowl"])
    record = json.loads((made.folder / "record.json").read_text(encoding="utf-8"))
    (look,) = record["planner"]["detections"]
    assert record["configuration"]["detector"] == name
    assert look["detector"]["model"] == str(weights.dino)
    assert look["detector"]["box_threshold"] == "0.1"
    assert {one["words"] for one in look["found"]} == {"red block", "bowl"}
    assert any(one["mask"] for one in look["found"])
    assert [target.status for target in made.targets] == ["found", "found"]
    assert record["planner"]["requests"] == []
    assert replay(made.folder).same
