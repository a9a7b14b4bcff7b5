"""Pictures of the user's own for the suites `pointing` and `boxcheck`: Where2Place, RefSpatial-Bench, and COCO files with boxes.

Formats, as published (no copy of a set was at hand; the readers were tested on files made in these formats):
where2place: Yuan et al. 2024, RoboPoint, arXiv:2406.10721, huggingface.co/datasets/wentao-yuan/where2place: `point_questions.jsonl` with a
line for each question (`image`, `text`), `images/`, `masks/NN.jpg` by the line's number from 00 on, white where a point is right.
refspatial: Zhou et al. 2025, RoboRefer, arXiv:2506.04308, huggingface.co/datasets/BAAI/RefSpatial-Bench: folders `Location`, `Placement`
and `Unseen`, each with `question.json` (a list of entries with `object`, the target's description; `prompt`, the sentence around it; `rgb_path`,
`mask_path`), `image/` and `mask/`. We ask for what `object` describes; for the whole sentence where an entry has none.
coco: `photos` has it. Every box is a question of its own.
Followed: a point counts that lies in the mask. Left out: these sets let several points be given and take the mean; here one is asked for.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, Literal

import cv2
import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.core.text import user_path
from wonderful_team.errors import ConfigError, UnknownNameError, reading
from wonderful_team.evals.photos import SET, read_photos
from wonderful_team.evals.suites import Protocol, Suite
from wonderful_team.evals.toy import BOX_KINDS
from wonderful_team.evals.trials import TrialRow
from wonderful_team.images import load_picture

SUITES = ("pointing", "boxcheck")
ONCE = Protocol("pictures of your own: each question once", 1, 0)
WHITE = 127
"""Grey level above which a pixel of a mask counts."""
SPLITS = ("Location", "Placement", "Unseen")
_FORMAT_WORDS = re.compile(r"\s*Your answer should be formatted.*", re.DOTALL)
"""How a set wants answers written; here the answer's form is the model client's business."""


@dataclass(frozen=True)
class PointingScene:
    """One question about one picture.

    Attributes:
        words: What is to be pointed at.
        mask: Picture that is white where a point is right; None where a box says it.
        box: Where the thing is; None where a mask says it.
        kind: A thing, or a place to put something.
        others: Boxes of other things in the same picture.
    """

    picture: Path
    words: str
    mask: Path | None = None
    box: Box | None = None
    kind: Literal["object", "area"] = "object"
    others: tuple[Box, ...] = ()

    def right(self, size_px: tuple[int, int]) -> Array:
        """Where a point is right, shape (H, W), bool.

        Raises:
            ConfigError: The mask is empty or of another size.
        """
        width, height = size_px
        if self.mask is None:
            assert self.box is not None
            found = np.zeros((height, width), bool)
            x0, y0, x1, y1 = (max(0, round(edge)) for edge in self.box.as_tuple)
            found[y0:y1, x0:x1] = True
            return found
        mask = load_picture(self.mask)[..., 0] > WHITE
        if mask.shape != (height, width):
            raise ConfigError(
                f"mask {str(self.mask)!r}: {mask.shape[1]} x {mask.shape[0]} px; valid: {width} x {height} px, as its picture has"
            )
        if not mask.any():
            raise ConfigError(f"mask {str(self.mask)!r} is black all over; valid: white where a point is right")
        return mask


class _Where2Place(BaseModel):
    model_config = ConfigDict(extra="ignore")
    image: str = Field(min_length=1)
    text: str = Field(min_length=1)


class _RefSpatial(BaseModel):
    model_config = ConfigDict(extra="ignore")
    id: int
    object: str = ""
    prompt: str = Field(min_length=1)
    rgb_path: str | None = None
    mask_path: str | None = None


def _where2place(path: Path) -> tuple[PointingScene, ...]:
    file = path / "point_questions.jsonl"
    scenes = []
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines()):
        if not line.strip():
            continue
        one = _checked(_Where2Place, _json(line, f"{file}, line {number + 1}"), f"{file}, line {number + 1}")
        words = _FORMAT_WORDS.sub("", one.text).strip()
        scenes.append(
            PointingScene(
                _there(path, "images", one.image), words, _there(path, "masks", f"{number:02d}.jpg"), kind="area"
            )
        )
    return _some(scenes, file)


def _refspatial(path: Path) -> tuple[PointingScene, ...]:
    file = path / "question.json"
    entries = _json(file.read_text(encoding="utf-8"), str(file))
    if not isinstance(entries, list):
        raise ConfigError(
            f"{file} holds a {type(entries).__name__}; valid: a list of entries with prompt, rgb_path, mask_path"
        )
    scenes = []
    for number, entry in enumerate(entries):
        one = _checked(_RefSpatial, entry, f"{file}, entry {number}")
        picture = _there(path, one.rgb_path or f"image/{one.id}.png")
        mask = _there(path, one.mask_path or f"mask/{one.id}.png")
        words = one.object.strip() or one.prompt.strip()
        scenes.append(PointingScene(picture, words, mask, kind="object" if path.name == "Location" else "area"))
    return _some(scenes, file)


def _coco(path: Path) -> tuple[PointingScene, ...]:
    scenes = []
    for photo in read_photos(str(path)):
        for asked in photo.asked:
            others = tuple(one.box for one in photo.asked if one is not asked and one.words != asked.words)
            scenes.append(PointingScene(photo.picture, asked.words, None, asked.box, others=others))
    return tuple(scenes)


FORMATS: Mapping[str, Callable[[Path], tuple[PointingScene, ...]]] = {
    "where2place": _where2place, "refspatial": _refspatial, "coco": _coco,
}  # fmt: skip
"""Readers, by the names of --format."""
_FORMS = {
    "where2place": "a folder with point_questions.jsonl, images/ and masks/",
    "refspatial": f"a folder with question.json, image/ and mask/, or with {', '.join(SPLITS)}",
    "coco": "a COCO JSON file whose boxes have an instruction or a category",
}


def _json(text: str, what: str) -> Any:
    try:
        return json.loads(text)
    except ValueError as error:
        raise ConfigError(f"{what}: no JSON ({error})") from error


def _checked(kind: type[Any], entry: Any, what: str) -> Any:
    try:
        return kind.model_validate(entry)
    except ValidationError as error:
        first = error.errors()[0]
        raise ConfigError(f"{what}: {'.'.join(map(str, first['loc'])) or 'it'}: {first['msg']}") from error


def _there(folder: Path, *names: str) -> Path:
    """A file of a set; what its lists name must lie inside of it."""
    file = folder.joinpath(*names)
    if not file.resolve().is_relative_to(folder.resolve()):
        raise ConfigError(f"{folder} names {'/'.join(names)!r}, which lies outside of it; valid: files of the set")
    if not file.is_file():
        raise ConfigError(f"{folder}: there is no file {str(file)!r}")
    return file


def _some(scenes: Sequence[PointingScene], file: Path) -> tuple[PointingScene, ...]:
    if not scenes:
        raise ConfigError(f"{file} holds no question")
    return tuple(scenes)


def format_of(path: Path, named: str | None) -> str:
    """The format of a set: the one that is named, else the one that its files show.

    Raises:
        UnknownNameError: There is no such format.
        ConfigError: It is none of them.
    """
    if named is not None:
        if named not in FORMATS:
            raise UnknownNameError("format of a set", named, FORMATS)
        return named
    if (path / "point_questions.jsonl").is_file():
        return "where2place"
    if _splits(path):
        return "refspatial"
    if path.is_file() and path.suffix == ".json":
        return "coco"
    raise ConfigError(
        f"set {str(path)!r}: its format is not plain; valid: {'; '.join(f'{k}: {v}' for k, v in _FORMS.items())}"
    )


def _splits(path: Path) -> list[Path]:
    """The folders of a RefSpatial set that hold questions."""
    return [folder for folder in (path, *(path / split for split in SPLITS)) if (folder / "question.json").is_file()]


def set_suites(names: Sequence[str], path: Path, named: str | None) -> tuple[Suite, ...]:
    """The suites `pointing` or `boxcheck` over a set, one for each of its parts: read whole, so that nothing is wrong later.

    Raises:
        ConfigError: Another suite, a set that is none, or one without what the suite needs.
    """
    wrong = [name for name in names if name not in SUITES]
    if wrong or not names:
        raise ConfigError(
            f"--set goes with the suites {' and '.join(SUITES)}, not with {wrong[0] if wrong else 'none'!r}"
        )
    if not path.exists():
        raise ConfigError(f"set {str(path)!r}: there is no such file or folder")
    form = format_of(path, named)
    parts = (_splits(path) or [path]) if form == "refspatial" else [path]
    suites = []
    for name in names:
        kinds = [""] if name == "pointing" else [f"/{kind}" for kind in BOX_KINDS]
        tasks = [f"{SET}{name}{kind}/{form}:{part}" for kind in kinds for part in parts]
        suites += [
            Suite(task, (task,), ONCE, f"{name} on {form}") for task in tasks if count_of(task) or name == "pointing"
        ]
    return tuple(suites)


def scenes_of(task: str) -> tuple[PointingScene, ...]:
    """The questions of a task `set/pointing/FORMAT:PATH`.

    Raises:
        ConfigError: Not such a set; names the file, the line and what is wrong.
    """
    head, _, path = task.partition(":")
    return _read(head.rpartition("/")[2], path)


@lru_cache
def _read(form: str, path: str) -> tuple[PointingScene, ...]:
    with reading(f"set {path!r}", _FORMS[form]):
        return FORMATS[form](user_path(path))


@dataclass(frozen=True)
class BoxScene:
    """A box to be judged in one picture: the scene, and a box of one of the four kinds round its thing."""

    scene: PointingScene
    box: Box


@lru_cache
def boxes_of(task: str) -> tuple[BoxScene, ...]:
    """The boxes of a task `set/boxcheck/KIND/FORMAT:PATH`; a picture in which there is no box of that kind is left out.

    Raises:
        ConfigError: The set has masks of areas and no boxes.
    """
    kind = task.removeprefix(f"{SET}boxcheck/").partition("/")[0]
    found = []
    for number, scene in enumerate(scenes_of(task)):
        if scene.box is None:
            raise ConfigError(
                f"{task}: boxcheck needs boxes, and this set has masks; valid: --format coco, or the suite pointing"
            )
        width, height = _size_of(scene.picture)
        box = _box(
            kind, scene, scene.box, Box(0, 0, width, height), np.random.default_rng([number, BOX_KINDS.index(kind), 2])
        )
        found += [] if box is None else [BoxScene(scene, box)]
    return tuple(found)


@cache
def _size_of(picture: Path) -> tuple[int, int]:
    """Width and height, as the picture is seen; each is read once for all kinds of boxes."""
    height, width = load_picture(picture).shape[:2]
    return width, height


def _box(kind: str, scene: PointingScene, right: Box, whole: Box, rng: np.random.Generator) -> Box | None:
    """A box of a kind, as on the toy table: lengths count in half sides of the thing's box."""
    half_x, half_y = right.width / 2, right.height / 2
    match kind:
        case "perfect":
            return right
        case "slightly_off":
            angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(0.5, 0.9)
            grow = rng.uniform(-0.2, 0.3) * min(half_x, half_y)
            moved = right.shifted(far * half_x * np.cos(angle), far * half_y * np.sin(angle)).grown(
                grow, grow, grow, grow
            )
            return moved.intersection(whole)
        case "around":
            for _ in range(200):
                angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(2.4, 4.0)
                box = right.shifted(far * half_x * np.cos(angle), far * half_y * np.sin(angle))
                if box.intersection(whole) == box and all(
                    box.intersection(one) is None for one in (right, *scene.others)
                ):
                    return box
            return None
        case "wrong_object":
            apart = [one for one in scene.others if one.iou(right) < 0.1]
            return apart[int(rng.integers(len(apart)))] if apart else None
    raise ConfigError(f"kind of box {kind!r}: valid are {', '.join(BOX_KINDS)}")


def count_of(task: str) -> int:
    """How many questions a task of a set has."""
    return len(boxes_of(task) if task.startswith(f"{SET}boxcheck/") else scenes_of(task))


def score_place(point: Point | None, right: Array) -> TrialRow:
    """Success when the point lies where the mask (or the box) says; how far off it is counts in shares of the diagonal."""
    if point is None:
        return TrialRow("failure", "grounding", "not found", facts={"points inside": 0.0})
    height, width = right.shape
    column, row = int(np.clip(point[0], 0, width - 1)), int(np.clip(point[1], 0, height - 1))
    away = cv2.distanceTransform((~right).astype(np.uint8), cv2.DIST_L2, 5)
    off = float(away[row, column]) / float(np.hypot(width, height))
    inside = bool(right[row, column])
    facts = {"points inside": float(inside), "off [share of the diagonal]": off}
    if inside:
        return TrialRow("success", None, "inside", facts=facts)
    return TrialRow("failure", "grounding", f"off by {off:.3f} of the diagonal; valid: inside", facts=facts)
