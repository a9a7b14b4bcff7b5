"""Which family a model's name suggests. Only a first guess: a served name says little, and a saved profile wins.

Looked up and found nowhere, so left unknown: RoboBrain 2 and 2.5, Cosmos-Reason 1 and 2, Embodied-R1 and 1.5 (their bases are
Qwen2.5-VL and Qwen3-VL, whose numbers differ, and they were trained on points of their own), MiMo-VL (XiaomiMiMo/MiMo-VL #17
asks and has no answer), Kimi-K2.5 (shares or pixels, web-infra-dev/midscene #2743). `probe` measures them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from wonderful_team.models.conventions import CONVENTIONS, Convention
from wonderful_team.models.wire.weight import UNLIMITED, Weight

Sure: TypeAlias = Literal["documented", "reported", "unknown"]


@dataclass(frozen=True)
class Family:
    """What is believed of a family of models before it is measured.

    Attributes:
        convention: The numbers it uses for places in a picture.
        sure: documented (by its maker), reported (in public threads), unknown (nothing is known: pixels are asked for).
        weak_pointing: It needs labelled axes on whole views to point well.
        detail: What OpenAI's interfaces are asked for with each picture, so that they do not resize it again.
        weight: Most bytes of a picture and of a request; heavier pictures are sent as JPEG. Sources: for Claude the refusal
            "image exceeds 5 MB maximum: ... bytes > 5242880 bytes", which counts base64 (anthropics/claude-code #10612), and
            platform.claude.com/docs/en/build-with-claude/vision (32 MB a request); for Gemini 20 MB a request
            (firebase.google.com/docs/vertex-ai/input-file-requirements); for OpenAI 50 MB of pictures a request (its guide on images
            and vision). A little less is used, for the words. A service that names no limit teaches it with status 413.
        tile_px: Side of the tiles that pictures are counted in (OpenAI's guide on images and vision).
    """

    name: str
    convention: Convention
    sure: Sure = "reported"
    weak_pointing: bool = False
    detail: Literal["high", "original"] | None = None
    weight: Weight = UNLIMITED
    tile_px: int | None = None


def _family(name: str, sure: Sure = "reported", *, weak: bool = False) -> Family:
    return Family(name, CONVENTIONS[name], sure, weak)


def _gpt(name: str, detail: Literal["high", "original"]) -> Family:
    return replace(_family(name, weak=True), detail=detail, weight=Weight(request=45_000_000))


def _claude(name: str) -> Family:
    return replace(_family(name, "documented"), weight=Weight(5_242_880, 28_000_000))


UNKNOWN = Family("unknown", CONVENTIONS["pixels"], "unknown", weak_pointing=True)

_PATTERNS: tuple[tuple[str, Family], ...] = (
    (r"gemini|robotics-er", replace(_family("gemini", "documented"), weight=Weight(request=18_000_000))),
    (r"claude-[a-z]+-(4[-.]([7-9]|[1-9]\d)|[5-9]|[1-9]\d)(?!\d)", _claude("claude-4.7")),
    (r"claude", _claude("claude")),
    (r"gemma", _family("gemma")),
    (r"\bgpt-[\d.]+-?(mini|nano)|\bo4-mini", _gpt("gpt-patches", "high")),
    # `original` came with GPT-5.4; earlier ones see tiles of a picture whose shorter side is 768 px.
    (r"\bgpt-(5\.([4-9]|[1-9]\d)|[6-9]|[1-9]\d)", _gpt("gpt", "original")),
    (r"\bgpt|chatgpt|\bo[134](-|$)", replace(_gpt("gpt-tiles", "high"), tile_px=512)),
    (r"qwen-?2[._]?5-?(omni|vl)|qwen2_5", _family("qwen2.5-vl")),
    (r"qwen-?2-?vl", _family("qwen2-vl")),
    (r"qwen-?(3|[4-9])|qwen.*vl", _family("qwen3-vl")),
    (r"glm-?\d+(\.\d+)?v", _family("glm-v", "documented")),
    (r"kimi-?vl", _family("kimi-vl")),
    (r"molmo-?2", _family("molmo2")),
    (r"molmo", _family("molmo1")),
    (r"internvl", _family("internvl")),
    (r"moondream", _family("moondream", "documented")),
)


def guess_family(model_name: str) -> Family:
    """The family that a name suggests, or `UNKNOWN`, which asks for plain pixels with labelled axes."""
    name = model_name.lower()
    return next((family for pattern, family in _PATTERNS if re.search(pattern, name)), UNKNOWN)
