"""A detector's looks in the record: who, for what, boxes, scores, masks, and a drawn picture; and a replay that finds them again."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team.api.replay import branch, replay
from wonderful_team.cli.app import run
from wonderful_team.core.values import mask_from_runs
from wonderful_team.errors import ConfigError, DetectorCodeError, ReplayError
from wonderful_team.offline.detector import ClassicalDetector
from wonderful_team.record.detections import RecordedDetector

DESK = Path(__file__).parents[2] / "examples" / "desk.png"
OWN = """
import wonderful_team as wt

class Corner:
    name = "corner"
    def detect(self, rgb, words):
        return [wt.Detection(text, wt.Box(10, 10, 50, 40), 0.75) for text in words if "star" not in text]
"""


def record_of(folder: Path) -> dict:
    return json.loads((folder / "record.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> wt.PlanResult:
    team = wt.Team(method="detector-grounding", out=tmp_path_factory.mktemp("runs"))
    return team.plan(DESK, "put the red block into the blue bowl")


def test_the_record_says_who_looked_for_what_and_what_was_found(planned: wt.PlanResult) -> None:
    assert planned.status == "planned", planned.plan.message
    record = record_of(planned.folder)
    assert record["configuration"]["grounding"] == "detector"
    assert record["configuration"]["detector"] == "classical"
    (look,) = record["planner"]["detections"]
    assert look["detector"]["name"] == "classical"
    assert look["words"] == ["red block", "blue bowl"]
    red = look["found"][0]
    x0, y0, x1, y1 = red["box"]
    mask = mask_from_runs(red["mask"], tuple(look["size_px"]))
    rows, columns = np.nonzero(mask)
    assert x0 <= columns.min() <= columns.max() < x1
    assert y0 <= rows.min() <= rows.max() < y1
    assert not {request["contract"] for request in record["planner"]["requests"]} & {"ReadScene", "JudgeBox", "MoveBox"}
    assert len(record["clock"]["detections"]) == 1


def test_the_drawn_picture_differs_from_the_view_along_the_boxes(planned: wt.PlanResult) -> None:
    record = record_of(planned.folder)
    look = record["planner"]["detections"][0]
    drawn = cv2.imread(str(planned.folder / record["files"][look["drawn"]]))
    view = cv2.imread(str(planned.folder / record["files"][look["view"]]))
    scale = drawn.shape[1] / view.shape[1]
    changed = (drawn != cv2.resize(view, drawn.shape[1::-1], interpolation=cv2.INTER_NEAREST)).any(axis=2)
    for found in look["found"]:
        x0, y0, x1, y1 = (round(scale * edge) for edge in found["box"])
        assert changed[y0 : y1 + 1, max(0, x0 - 4) : x0 + 4].any(axis=1).all(), found["words"]


def test_the_page_names_the_detector_and_shows_its_picture(planned: wt.PlanResult) -> None:
    page = planned.page.read_text(encoding="utf-8")
    assert "<b>classical, weights none</b> was asked for red block (1 found)" in page
    assert "no grounding team took part" in page


def test_a_replay_finds_what_was_found_without_the_detector(
    planned: wt.PlanResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ClassicalDetector, "detect", lambda *_: pytest.fail("the detector itself was asked"))
    assert replay(planned.folder).same


def test_another_model_goes_on_with_the_detector_itself(planned: wt.PlanResult, tmp_path: Path) -> None:
    made = branch(planned.folder, "act", "offline", out=tmp_path)
    record = record_of(made.folder)
    assert (record["configuration"]["detector"], len(record["planner"]["detections"])) == ("classical", 1)
    assert isinstance(made, wt.PlanResult)
    assert made.status == "planned"


def test_a_recorded_detector_answers_only_what_was_asked(planned: wt.PlanResult) -> None:
    detector = RecordedDetector(record_of(planned.folder))
    rgb = planned.observation.main.rgb
    with pytest.raises(ReplayError, match="was not asked for mug in this picture"):
        detector.detect(rgb, ["mug"])
    with pytest.raises(ReplayError, match="in this picture"):
        detector.detect(np.zeros_like(rgb), ["red block", "blue bowl"])
    assert [one.words for one in detector.detect(rgb, ["red block", "blue bowl"])] == ["red block", "blue bowl"]


def test_one_call_stands_in_the_record(tmp_path: Path) -> None:
    made = wt.Team(method="single-call-grounding", out=tmp_path).plan(DESK, "put the red block into the blue bowl")
    record = record_of(made.folder)
    assert record["configuration"]["grounding"] == "one_call"
    grounding = [request["contract"] for request in record["planner"]["requests"] if request["stage"] == "ground"]
    assert grounding == ["ReadScene"]
    assert replay(made.folder).same


def test_ground_with_a_detector_of_ones_own_on_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "own.py").write_text(OWN, encoding="utf-8")
    words = [
        "ground",
        str(DESK),
        "cup",
        "star",
        "--detector",
        f"{tmp_path}/own.py:Corner",
        "--out",
        str(tmp_path),
        "--json",
    ]
    assert run([*words, "--coco", str(tmp_path / "boxes.json")]) == 1
    result = json.loads(capsys.readouterr().out)["result"]
    assert [(one["words"], one["status"]) for one in result["targets"]] == [("cup", "found"), ("star", "absent")]
    assert result["targets"][0]["box_px"] == [10, 10, 50, 40]
    (box,) = json.loads((tmp_path / "boxes.json").read_text())["annotations"]
    assert box["bbox"] == [10, 10, 40, 30]
    folder = Path(result["page"]).parent
    assert replay(folder).same
    with pytest.raises(ConfigError, match="names code"):
        branch(folder, "ground", "offline", out=tmp_path)


def test_a_run_whose_detector_broke_says_so_on_its_page_and_replays(
    planned: wt.PlanResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def out_of_memory(*_: object) -> None:
        raise MemoryError("no memory left on the card")

    with monkeypatch.context() as broken:
        broken.setattr(ClassicalDetector, "detect", out_of_memory)
        team = wt.Team(method="detector-grounding", out=tmp_path)
        with pytest.raises(DetectorCodeError, match="no memory left on the card"):
            team.plan(DESK, "put the red block into the blue bowl")
    (folder,) = (path.parent for path in tmp_path.rglob("record.json"))
    (look,) = record_of(folder)["planner"]["detections"]
    assert (look["found"], look["refused"]) == ([], "")
    assert "no memory left on the card" in look["failed"]
    assert "and broke: " in next(folder.glob("*.html")).read_text(encoding="utf-8")
    # The detector works again by now: a replay breaks as the run did.
    assert replay(folder).same


def test_a_detector_that_would_change_nothing_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", str(DESK), "put the red block into the blue bowl", "--detector", "classical"]) == 2
    assert "method 'team' looks with no detector" in capsys.readouterr().err


def test_an_unknown_word_ends_as_not_understood(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ground", str(DESK), "mug", "--detector", "classical"]) == 7
    assert "do not know: mug" in capsys.readouterr().out


def test_a_refused_word_is_told_recorded_and_replayed(tmp_path: Path) -> None:
    made = wt.Team(method="detector-grounding", out=tmp_path).ground(DESK, ["mug", "red block"])
    assert [target.status for target in made.targets] == ["gave_up", "found"]
    looks = record_of(made.folder)["planner"]["detections"]
    assert ["do not know: mug" in look["refused"] for look in looks] == [True, True, False]
    assert "and refused: detector" in made.page.read_text(encoding="utf-8")
    assert replay(made.folder).same
