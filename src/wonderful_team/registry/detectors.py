"""Detectors by name: one table from a name to its factory. A detector of one's own: FILE.py:NAME."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, cast

from wonderful_team.core.protocols import Classifier, Detector
from wonderful_team.errors import ConfigError, DetectorCodeError, UnknownNameError, code_of
from wonderful_team.registry.files import arguments_of, is_file_name, make_from_file, named_arguments

DEFAULT_DETECTOR = "classical"
_LOADING = threading.Lock()
"""Trials that begin at once load the same weights once."""


@dataclass(frozen=True)
class DetectorRow:
    """A detector: a line of help, and its factory.

    Attributes:
        factory: Gives the function or class that makes it, imported when it is asked for; options of the name are its parameters.
        takes_model: A model may be named behind a colon, as in owlv2:MODEL.
    """

    words: str
    factory: Callable[[], Callable[..., Detector]]
    takes_model: bool = True


def _classical() -> Callable[..., Detector]:
    from wonderful_team.offline.detector import ClassicalDetector

    return ClassicalDetector


def make_classifier() -> Classifier:
    """Who says which region is meant where a method of the literature asks CLIP: the classical one; there are no weights of CLIP."""
    from wonderful_team.offline.classifier import ClassicalClassifier

    return ClassicalClassifier()


def _owlv2() -> Callable[..., Detector]:
    from wonderful_team.detectors.make import make_owlv2

    return make_owlv2


def _grounding_dino() -> Callable[..., Detector]:
    from wonderful_team.detectors.make import make_grounding_dino

    return make_grounding_dino


def _langsam() -> Callable[..., Detector]:
    from wonderful_team.detectors.make import make_langsam

    return make_langsam


DETECTORS: dict[str, DetectorRow] = {
    "classical": DetectorRow(
        "classical vision and a grammar for noun phrases: no weights; boxes, masks",
        _classical,
        takes_model=False,
    ),
    "owlv2": DetectorRow("OWLv2 (or OWL-ViT) through transformers; boxes, with ?sam=MODEL masks", _owlv2),
    "groundingdino": DetectorRow("GroundingDINO through transformers; boxes, with ?sam=MODEL masks", _grounding_dino),
    "langsam": DetectorRow(
        "boxes by GroundingDINO, masks by SAM, combined as LangSAM does; through transformers", _langsam
    ),
}
DETECTOR_FORMS: dict[str, str] = {
    "NAME:MODEL": "with these weights: a checkpoint that was downloaded, or a folder",
    "NAME?OPTION=VALUE&...": "threshold (owlv2), box_threshold, text_threshold (others), revision, device, dtype, sam",
    "FILE.py:NAME": "your own: anything with a name and detect(rgb, words)",
}


def make_detector(detector: str | Detector = DEFAULT_DETECTOR) -> Detector:
    """The detector that a name means; an object with `detect(rgb, words)` is one already.

    Weights are loaded here, once for each name.

    Args:
        detector: One of DETECTORS, with a model and options as DETECTOR_FORMS says; FILE.py:NAME; or an object.

    Raises:
        UnknownNameError: No such detector or option.
        MissingExtraError: What it needs is not installed.
        ConfigError: Its weights are not on this machine, or the object is no detector.
        DetectorCodeError: The user's own code raised something.
    """
    if not isinstance(detector, str):
        return _checked(detector, type(detector).__name__)
    if is_file_name(detector):
        return _checked(make_from_file(detector, "detector", {}, DetectorCodeError), detector)
    with _LOADING:
        return _built_in(detector)


@lru_cache(maxsize=4)
def _built_in(name: str) -> Detector:
    asked, options = named_arguments(name, name)
    kind, colon, model = asked.partition(":")
    if kind not in DETECTORS:
        raise UnknownNameError("detector", kind, [*DETECTORS, "FILE.py:NAME"])
    row, whose = DETECTORS[kind], f"detector {name!r}"
    if colon and not (row.takes_model and model):
        valid = f"{kind}:MODEL" if row.takes_model else kind
        raise ConfigError(
            f"{whose}: {f'{model!r} is no model of it' if model else 'the model is empty'}; valid: {valid}"
        )
    given = {**options, **({"model": model} if model else {})}
    make = row.factory()
    return make(**arguments_of(make, {}, given, whose, kind))


def _checked(made: Any, named: str) -> Detector:
    with code_of(f"detector {named!r}", DetectorCodeError):
        finds = callable(getattr(made, "detect", None))
        called = isinstance(getattr(made, "name", None), str)
    if not finds:
        raise ConfigError(f"detector {named!r} needs a method detect(rgb, words); {type(made).__name__} has none")
    if not called:
        raise ConfigError(f"detector {named!r} needs an attribute `name` (a string), for records and pages")
    return cast(Detector, made)


def detector_label(detector: str | Detector) -> str:
    """How records name the detector."""
    return detector if isinstance(detector, str) else str(getattr(detector, "name", type(detector).__name__))
