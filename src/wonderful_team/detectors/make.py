"""The detectors of `transformers` from plain values, as the command line names them: NAME:MODEL?threshold=0.2&device=cuda."""

from __future__ import annotations

from wonderful_team.core.protocols import Detector
from wonderful_team.detectors import grounding_dino, owlv2
from wonderful_team.detectors.loading import Weights
from wonderful_team.detectors.sam import MODEL as SAM_MODEL
from wonderful_team.detectors.sam import SamSegmenter, Segmented


def make_owlv2(
    model: str = owlv2.MODEL,
    threshold: float = owlv2.THRESHOLD,
    revision: str = "",
    device: str = "",
    dtype: str = "float32",
    sam: str = "",
) -> Detector:
    """OWLv2; with `sam` (a model's name) its boxes get masks."""
    found = owlv2.Owlv2Detector(Weights(model, revision, device, dtype), threshold)
    return _segmented(found, sam, device, dtype)


def make_grounding_dino(
    model: str = grounding_dino.MODEL,
    box_threshold: float = grounding_dino.BOX_THRESHOLD,
    text_threshold: float = grounding_dino.TEXT_THRESHOLD,
    revision: str = "",
    device: str = "",
    dtype: str = "float32",
    sam: str = "",
) -> Detector:
    """GroundingDINO; with `sam` (a model's name) its boxes get masks."""
    found = grounding_dino.GroundingDinoDetector(Weights(model, revision, device, dtype), box_threshold, text_threshold)
    return _segmented(found, sam, device, dtype)


def make_langsam(
    model: str = grounding_dino.MODEL,
    sam: str = SAM_MODEL,
    box_threshold: float = grounding_dino.BOX_THRESHOLD,
    text_threshold: float = grounding_dino.TEXT_THRESHOLD,
    revision: str = "",
    device: str = "",
    dtype: str = "float32",
) -> Detector:
    """LangSAM's way: boxes from GroundingDINO, a mask for each from SAM."""
    return make_grounding_dino(model, box_threshold, text_threshold, revision, device, dtype, sam)


def _segmented(detector: Detector, model: str, device: str, dtype: str) -> Detector:
    return Segmented(detector, SamSegmenter(Weights(model, "", device, dtype))) if model else detector
