"""What a record says of a detector's looks, and a detector that answers out of a record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import BoxMark, picture_hash
from wonderful_team.core.values import Detection, DetectorRun, mask_from_runs, mask_to_runs
from wonderful_team.errors import DetectorCodeError, NotUnderstoodError, ReplayError, reading
from wonderful_team.images import whole
from wonderful_team.record.picture_store import PictureStore


def detector_entry(run: DetectorRun, store: PictureStore) -> dict[str, Any]:
    """One look: plain JSON values; the view and a picture with all boxes and scores stand as files."""
    width, height = run.view.size_px
    picture = whole(run.view, f"found by {run.detector['name'].partition(':')[0]}", min_side_px=480)
    marks = (
        BoxMark(picture.frame.box_to_picture(one.box), "target", f"{one.words} {one.score:.2f}") for one in run.found
    )
    return {
        "detector": dict(run.detector),
        "view": store.keep_view(run.view, "detected"),
        "view_id": run.view.id,
        "size_px": [width, height],
        "words": list(run.words),
        "found": [_detection_entry(one) for one in run.found],
        "drawn": store.keep_drawn(picture.marked(*marks)),
        "refused": run.refused,
        "failed": run.failed,
    }


def _detection_entry(one: Detection) -> dict[str, Any]:
    return {
        "words": one.words,
        "box": list(one.box.as_tuple),
        "score": one.score,
        "mask": None if one.mask is None else mask_to_runs(one.mask),
    }


class RecordedDetector:
    """Finds what the record says was found: for the same words in the same picture, in the same order.

    Args:
        record: The content of a record.json.

    Attributes:
        broke: The errors of the record that were raised again.
    """

    def __init__(self, record: Mapping[str, Any]) -> None:
        with reading("the detections of the record"):
            self._left = list(record["planner"].get("detections", []))
            self.setting = dict(self._left[0]["detector"]) if self._left else {}
        self.broke: list[DetectorCodeError] = []
        self.name = str(self.setting.pop("name", "recorded"))

    def detect(self, rgb: Array, words: Sequence[str]) -> list[Detection]:
        """What was found then.

        Raises:
            NotUnderstoodError: It refused these words then.
            DetectorCodeError: It broke then.
            ReplayError: The detector was not asked for these words in this picture.
        """
        view = picture_hash(rgb)
        for number, entry in enumerate(self._left):
            if entry["view"] == view and entry["words"] == list(words):
                del self._left[number]
                if entry.get("refused"):
                    raise NotUnderstoodError(entry["refused"], stage="grounding")
                if entry.get("failed"):
                    self.broke.append(DetectorCodeError(entry["failed"]))
                    raise self.broke[-1]
                with reading("the detections of the record"):
                    return [_detection(one, entry["size_px"]) for one in entry["found"]]
        raise ReplayError(
            f"detector {self.name!r} was not asked for {', '.join(words)} in this picture: this time the run took another way"
        )


def _detection(entry: Mapping[str, Any], size_px: Sequence[int]) -> Detection:
    mask = None if entry["mask"] is None else mask_from_runs(entry["mask"], (size_px[0], size_px[1]))
    return Detection(entry["words"], Box(*entry["box"]), entry["score"], mask)
