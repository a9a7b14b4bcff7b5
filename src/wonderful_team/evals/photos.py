"""Grounding compared on photos with boxes, without any simulator. The file is COCO JSON whose annotations say what is asked for.

Each image is one scene. An annotation's `instruction` (else its category's name) is what has to be found, its `bbox`
([x, y, width, height], pixels) is where it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from pydantic import BaseModel, Field, ValidationError

from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.core.text import user_path
from wonderful_team.errors import ConfigError, reading
from wonderful_team.evals.trials import TrialRow

SET = "set/"
"""How tasks begin that ask about pictures of the user's own: set/pointing/FORMAT:PATH, set/boxcheck/KIND/FORMAT:PATH."""
ENOUGH_OVERLAP = 0.5
"""Intersection over union from which a box counts as found (the usual COCO threshold AP50)."""


def is_photo(task: str) -> bool:
    """Whether a task is photos with boxes, or a set of pictures: its scenes have numbers instead of seeds, and nothing acts."""
    return task.endswith(".json") or task.startswith(SET)


class _Image(BaseModel):
    id: int
    file_name: str


class _Annotation(BaseModel):
    image_id: int
    bbox: tuple[float, float, float, float]
    category_id: int | None = None
    instruction: str | None = None


class _Category(BaseModel):
    id: int
    name: str


class _Coco(BaseModel):
    images: list[_Image] = Field(min_length=1)
    annotations: list[_Annotation] = Field(min_length=1)
    categories: list[_Category] = []


@dataclass(frozen=True)
class Asked:
    """One thing to find, and where it is."""

    words: str
    box: Box


@dataclass(frozen=True)
class PhotoScene:
    """A photo and everything that is asked for in it."""

    picture: Path
    asked: tuple[Asked, ...]


@dataclass(frozen=True)
class Located:
    """What a method answered for one thing; both None when it says that the thing is not there."""

    box: Box | None = None
    point: Point | None = None


@lru_cache
def read_photos(path: str) -> tuple[PhotoScene, ...]:
    """The scenes of a COCO file, in its order; images without a box are left out.

    Raises:
        ConfigError: Not such a file, an empty box, a box without words, or a picture that is missing.
    """
    with reading(f"photos {path!r}", "COCO JSON"):
        return _read_photos(path)


def _read_photos(path: str) -> tuple[PhotoScene, ...]:
    file = user_path(path)
    try:
        coco = _Coco.model_validate_json(file.read_bytes())
    except OSError as error:
        raise ConfigError(f"photos {path!r}: {error.strerror}") from error
    except ValidationError as error:
        first = error.errors()[0]
        raise ConfigError(
            f"photos {path!r}: {'.'.join(map(str, first['loc']))}: {first['msg']}; valid is COCO JSON"
        ) from error
    names = {one.id: one.name for one in coco.categories}
    scenes = []
    for image in coco.images:
        mine = [one for one in coco.annotations if one.image_id == image.id]
        if not mine:
            continue
        picture = file.parent / image.file_name
        if not picture.is_file():
            raise ConfigError(f"photos {path!r}: image {image.id}: there is no file {str(picture)!r}")
        scenes.append(PhotoScene(picture, tuple(_asked(one, names, path) for one in mine)))
    if not scenes:
        raise ConfigError(f"photos {path!r}: no image has a box")
    return tuple(scenes)


def _asked(one: _Annotation, names: Mapping[int, str], path: str) -> Asked:
    words = one.instruction or names.get(one.category_id if one.category_id is not None else -1, "")
    x, y, width, height = one.bbox
    if not words:
        raise ConfigError(
            f"photos {path!r}: the box {list(one.bbox)} of image {one.image_id} has neither instruction nor category"
        )
    if width <= 0 or height <= 0:
        raise ConfigError(
            f"photos {path!r}: the box {list(one.bbox)} of image {one.image_id} is empty; [x, y, width, height]"
        )
    return Asked(words, Box(x, y, x + width, y + height))


def score_photo(scene: PhotoScene, located: Sequence[Located]) -> TrialRow:
    """Success when everything is found: by its box, or by a point within the true box for methods that give points only."""
    overlaps, inside, misses = [], [], []
    for asked, found in zip(scene.asked, located, strict=True):
        part = 0.0 if found.box is None else asked.box.iou(found.box)
        centre = found.point or (None if found.box is None else found.box.centre)
        hit = centre is not None and asked.box.contains(centre)
        overlaps.append(part)
        inside.append(float(hit))
        if not (part >= ENOUGH_OVERLAP if found.box is not None else hit):
            misses.append(f"{asked.words}: " + ("not found" if centre is None else f"overlap {part:.2f}"))
    n = len(scene.asked)
    facts = {"overlap": sum(overlaps) / n, "points inside": sum(inside) / n, "found": (n - len(misses)) / n}
    if misses:
        return TrialRow("failure", "grounding", "; ".join(misses), facts=facts)
    return TrialRow("success", None, f"all {n} found", facts=facts)
