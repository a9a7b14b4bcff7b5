"""OWLv2 (and OWL-ViT, which came before it): every description at once, a box with a score for each thing.

Source: Minderer, Gritsenko & Houlsby 2023, arXiv:2306.09683 (OWLv2); Minderer et al. 2022, arXiv:2205.06230 (OWL-ViT, which
Wang, Shen & Stadie 2024 put in the place of the grounding team). Loading, pixels and boxes as `transformers` has them: the picture
is padded to a square below and on the right, and each box goes to the description that it fits best. No overlapping boxes are
removed: neither does `transformers` for descriptions in words.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Detection
from wonderful_team.detectors.boxes import checked_share, detections
from wonderful_team.detectors.loading import Weights, load
from wonderful_team.errors import NotUnderstoodError

MODEL = "google/owlv2-base-patch16-ensemble"
THRESHOLD = 0.1
"""As `transformers` has it for OWLv2."""
TYPES = ("owlv2", "owlvit")


class Owlv2Detector:
    """OWLv2 through `transformers`.

    Args:
        weights: Which, and where they run.
        threshold: Least score, 0 to 1.

    Raises:
        MissingExtraError: The optional part is not installed.
        ConfigError: The weights are not here or are others, or a value is out of range.
    """

    def __init__(self, weights: Weights, threshold: float = THRESHOLD) -> None:
        self.name = f"owlv2:{weights.model}"
        self._threshold = checked_share("threshold", threshold)
        self._loaded = load(weights, "detector 'owlv2'", TYPES, "AutoModelForZeroShotObjectDetection")
        self._lock = threading.Lock()
        self.setting: Mapping[str, str] = self._loaded.setting(weights, threshold=self._threshold)

    def detect(self, rgb: Array, words: Sequence[str]) -> list[Detection]:
        """All boxes with at least the threshold's score.

        Raises:
            NotUnderstoodError: A description is longer than the model reads.
        """
        import torch

        processor, model = self._loaded.processor, self._loaded.model
        most = self._check_length(words)
        height, width = rgb.shape[:2]
        inputs = processor(
            images=np.asarray(rgb), text=[list(words)], padding="max_length", max_length=most, return_tensors="pt"
        ).to(self._loaded.device)
        inputs["pixel_values"] = inputs["pixel_values"].to(model.dtype)
        with self._lock, torch.inference_mode():
            outputs = model(**inputs)
        outputs.logits, outputs.pred_boxes = outputs.logits.float().cpu(), outputs.pred_boxes.float().cpu()
        found = processor.post_process_grounded_object_detection(
            outputs, threshold=self._threshold, target_sizes=[(height, width)], text_labels=[list(words)]
        )[0]
        return detections(found["text_labels"], found["boxes"].tolist(), found["scores"].tolist(), (width, height))

    def _check_length(self, words: Sequence[str]) -> int:
        """How many tokens of a description the model reads."""
        most = int(self._loaded.model.config.text_config.max_position_embeddings)
        for text in words:
            length = len(self._loaded.processor.tokenizer(text)["input_ids"])
            if length > most:
                raise NotUnderstoodError(
                    f"{self.name} reads at most {most} tokens of a description, its two ends included; {text!r} has {length}: "
                    "say it in fewer words",
                    stage="grounding",
                )
        return most
