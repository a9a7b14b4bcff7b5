"""Masks from boxes: SAM behind any detector. With GroundingDINO in front it is what LangSAM does.

LangSAM (luca-medeiros/lang-segment-anything, `lang_sam/lang_sam.py`, `predict`): GroundingDINO gives boxes for the prompt (box
threshold 0.3, text threshold 0.25), each box becomes a prompt of SAM with one mask asked for (`multimask_output=False`), boxes
and their scores stand as GroundingDINO gave them, and SAM's own scores decide nothing. LangSAM began with SAM's ViT-H, as the
Trajectory Generators had it, and takes SAM 2.1 today; here it is SAM (`facebook/sam-vit-huge` unless named otherwise).

Source of SAM: Kirillov et al. 2023, arXiv:2304.02643.
"""

from __future__ import annotations

import inspect
import threading
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.interrupts import in_thread
from wonderful_team.core.protocols import Detector
from wonderful_team.core.values import Detection
from wonderful_team.detectors.asking import checked_detections, identity_of, name_of
from wonderful_team.detectors.loading import Weights, load

MODEL = "facebook/sam-vit-huge"
AT_ONCE = 64
"""Boxes that SAM is asked about at once, which bounds its memory."""


class SamSegmenter:
    """SAM through `transformers`: a mask for each box.

    Args:
        weights: Which, and where they run.

    Raises:
        MissingExtraError: The optional part is not installed.
        ConfigError: The weights are not here, or are others.
    """

    def __init__(self, weights: Weights) -> None:
        self.name = f"sam:{weights.model}"
        self._loaded = load(weights, "segmenter 'sam'", ("sam",), "SamModel")
        self._lock = threading.Lock()
        self.setting: Mapping[str, str] = {"sam": weights.model, "sam_commit": self._loaded.commit}

    def masks(self, rgb: Array, boxes: Sequence[Box]) -> list[Array]:
        """For each box what shows of the thing in it, shape (H, W), bool; all False where SAM sees nothing.

        Args:
            rgb: Shape (H, W, 3), uint8.
            boxes: In its pixels.
        """
        return [mask for at in range(0, len(boxes), AT_ONCE) for mask in self._masks(rgb, boxes[at : at + AT_ONCE])]

    def _masks(self, rgb: Array, boxes: Sequence[Box]) -> list[Array]:
        import torch

        processor, model, device = self._loaded.processor, self._loaded.model, self._loaded.device
        prompts = [[list(box.as_tuple) for box in boxes]]
        inputs: Any = processor(images=np.asarray(rgb), input_boxes=prompts, return_tensors="pt")
        sizes, reshaped = inputs.pop("original_sizes"), inputs.pop("reshaped_input_sizes")
        pixels, asked = (inputs[key].to(device, model.dtype) for key in ("pixel_values", "input_boxes"))
        with self._lock, torch.inference_mode():
            outputs = model(pixel_values=pixels, input_boxes=asked, multimask_output=False)
        masks = processor.post_process_masks(outputs.pred_masks.float().cpu(), sizes, reshaped)[0]
        return [np.asarray(mask[0].numpy(), dtype=bool) for mask in masks]


class Segmented:
    """A detector whose boxes get masks from SAM; one that gives masks already keeps its own.

    Args:
        detector: Who finds the boxes.
        segmenter: Who finds the masks in them: anything with `masks(rgb, boxes)`.
    """

    def __init__(self, detector: Detector, segmenter: SamSegmenter) -> None:
        self._detector, self._segmenter = detector, segmenter
        self.name = f"{name_of(detector)}+{segmenter.name}"
        self.setting: Mapping[str, str] = {**identity_of(detector), **segmenter.setting, "name": self.name}

    async def detect(self, rgb: Array, words: Sequence[str]) -> list[Detection]:
        """The detector's detections, each with a mask; none where SAM sees nothing in the box."""
        found = await in_thread(self._detector.detect, rgb, words, name="detector")
        found = await found if inspect.isawaitable(found) else found
        checked = checked_detections(found, rgb, words, f"detector {name_of(self._detector)!r}")
        bare = [one for one in checked if one.mask is None]
        masks = await in_thread(self._segmenter.masks, rgb, [one.box for one in bare], name="segmenter") if bare else []
        with_masks = [replace(one, mask=mask) if mask.any() else one for one, mask in zip(bare, masks, strict=True)]
        return [*(one for one in checked if one.mask is not None), *with_masks]
