"""GroundingDINO: one description at a time, boxes where its words show.

Source: Liu et al. 2023, arXiv:2303.05499. Asked as LangSAM asks it (luca-medeiros/lang-segment-anything, `lang_sam/models/gdino.py`):
the description, in small letters and with a full stop, is the whole prompt, so every box belongs to it; a box counts when its
best token scores above the box threshold, and when a token of it scores above the text threshold. No overlapping boxes are removed.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Detection
from wonderful_team.detectors.boxes import checked_share, detections
from wonderful_team.detectors.loading import Weights, load
from wonderful_team.errors import NotUnderstoodError

MODEL = "IDEA-Research/grounding-dino-base"
"""What LangSAM loads."""
BOX_THRESHOLD, TEXT_THRESHOLD = 0.3, 0.25
"""LangSAM's (`lang_sam/lang_sam.py`, `predict`)."""


class GroundingDinoDetector:
    """GroundingDINO through `transformers`.

    Args:
        weights: Which, and where they run.
        box_threshold: Least score of a box, 0 to 1.
        text_threshold: Least score of a word that counts as shown in a box, 0 to 1.

    Raises:
        MissingExtraError: The optional part is not installed.
        ConfigError: The weights are not here or are others, or a value is out of range.
    """

    def __init__(
        self, weights: Weights, box_threshold: float = BOX_THRESHOLD, text_threshold: float = TEXT_THRESHOLD
    ) -> None:
        self.name = f"groundingdino:{weights.model}"
        self._box_threshold = checked_share("box_threshold", box_threshold)
        self._text_threshold = checked_share("text_threshold", text_threshold)
        self._loaded = load(weights, "detector 'groundingdino'", ("grounding-dino",), "GroundingDinoForObjectDetection")
        self._lock = threading.Lock()
        self.setting: Mapping[str, str] = self._loaded.setting(
            weights, box_threshold=self._box_threshold, text_threshold=self._text_threshold
        )

    def detect(self, rgb: Array, words: Sequence[str]) -> list[Detection]:
        """All boxes above the thresholds; the model is asked once for each description.

        Raises:
            NotUnderstoodError: A description is longer than the model reads.
        """
        prompts = [f"{text.strip().lower().rstrip('.')}." for text in words]
        for text, prompt in zip(words, prompts, strict=True):
            self._check_length(text, prompt)
        return [
            one
            for text, prompt in zip(words, prompts, strict=True)
            for one in self._look(np.asarray(rgb), text, prompt)
        ]

    def _look(self, rgb: Array, words: str, prompt: str) -> list[Detection]:
        import torch

        processor, model = self._loaded.processor, self._loaded.model
        height, width = rgb.shape[:2]
        inputs: Any = processor(images=rgb, text=prompt, return_tensors="pt").to(self._loaded.device)
        inputs["pixel_values"] = inputs["pixel_values"].to(model.dtype)
        with self._lock, torch.inference_mode():
            outputs = model(**inputs)
        outputs.logits, outputs.pred_boxes = outputs.logits.float().cpu(), outputs.pred_boxes.float().cpu()
        found = processor.post_process_grounded_object_detection(
            outputs,
            inputs["input_ids"].cpu(),
            threshold=self._box_threshold,
            text_threshold=self._text_threshold,
            target_sizes=[(height, width)],
        )[0]
        shown = [bool(label.strip()) for label in found["text_labels"]]
        boxes = [box for box, some in zip(found["boxes"].tolist(), shown, strict=True) if some]
        scores = [score for score, some in zip(found["scores"].tolist(), shown, strict=True) if some]
        return detections([words] * len(boxes), boxes, scores, (width, height))

    def _check_length(self, words: str, prompt: str) -> None:
        most = int(self._loaded.model.config.max_text_len)
        length = len(self._loaded.processor.tokenizer(prompt)["input_ids"])
        if length > most:
            raise NotUnderstoodError(
                f"{self.name} reads at most {most} tokens of a description; {words!r} has {length}: say it in fewer words",
                stage="grounding",
            )
