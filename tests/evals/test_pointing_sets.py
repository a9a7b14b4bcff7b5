"""Pictures of the user's own in `pointing` and `boxcheck`: the published formats, made here; and what is said of bad files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.evals.again import command_again
from wonderful_team.evals.pointing_sets import boxes_of, format_of, scenes_of, score_place, set_suites
from wonderful_team.evals.toy import BOX_KINDS
from wonderful_team.evals.trials import Condition, TrialSpec
from wonderful_team.images import to_png
from wonderful_team.lab.toy import ToyTable

FORM = " Your answer should be formatted as a list of tuples, i.e. [(x1, y1)], between 0 and 1."
METHOD = '''
import numpy as np

class Redmost:
    """Points at the middle of what is red; judges every box as good."""

    name = "redmost"

    def decide(self, situation):
        raise NotImplementedError

    def locate(self, observation, words):
        rgb = observation.main.rgb.astype(int)
        rows, columns = np.nonzero((rgb[..., 0] > 180) & (rgb[..., 1] < 80) & (rgb[..., 2] < 80))
        return [(float(columns.mean()), float(rows.mean())) for _ in words]

    def judge(self, observation, words, box):
        return "accept"
'''


def picture(red: tuple[int, int], size: tuple[int, int] = (120, 80)) -> np.ndarray:
    rgb = np.full((size[1], size[0], 3), 150, np.uint8)
    cv2.circle(rgb, red, 8, (230, 20, 20), -1)
    return rgb


def mask(at: tuple[int, int], size: tuple[int, int] = (120, 80)) -> np.ndarray:
    found = np.zeros((size[1], size[0], 3), np.uint8)
    cv2.circle(found, at, 8, (255, 255, 255), -1)
    return found


def write(path: Path, rgb: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), rgb[..., ::-1])


def where2place(folder: Path) -> Path:
    """Two questions; the second mask lies elsewhere than the red disc."""
    lines = []
    for number, (red, right) in enumerate([((30, 40), (30, 40)), ((30, 40), (90, 40))]):
        write(folder / "images" / f"{number:02d}.jpg", picture(red))
        write(folder / "masks" / f"{number:02d}.jpg", mask(right))
        lines.append({"question_id": number, "image": f"{number:02d}.jpg", "text": "Point to the free spot." + FORM})
    (folder / "point_questions.jsonl").write_text("\n".join(map(json.dumps, lines)) + "\n", encoding="utf-8")
    return folder


def refspatial(folder: Path) -> Path:
    for split in ("Location", "Placement"):
        write(folder / split / "image" / "0.png", picture((30, 40)))
        write(folder / split / "mask" / "0.png", mask((30, 40)))
        entry = {
            "id": 0, "object": "the red disc", "prompt": "Please point out the red disc.", "suffix": FORM, "category": split.lower(),
            "rgb_path": "image/0.png", "mask_path": "mask/0.png", "step": 1,
        }  # fmt: skip
        (folder / split / "question.json").write_text(json.dumps([entry]), encoding="utf-8")
    return folder


def coco(folder: Path) -> Path:
    """Two toy tables, two things asked for in each."""
    images, annotations = [], []
    for number in (1, 2):
        table = ToyTable(3000 + number)
        (folder / f"{number}.png").write_bytes(to_png(table.view.rgb))
        images.append({"id": number, "file_name": f"{number}.png"})
        for thing in table.things[:2]:
            x0, y0, x1, y1 = thing.box.as_tuple
            box = [x0, y0, x1 - x0, y1 - y0]
            annotations.append({"image_id": number, "bbox": box, "instruction": thing.words})
    path = folder / "mine.json"
    path.write_text(json.dumps({"images": images, "annotations": annotations}), encoding="utf-8")
    return path


def bench(capsys: pytest.CaptureFixture[str], tmp_path: Path, *words: str) -> dict[str, Any]:
    (tmp_path / "mine.py").write_text(METHOD, encoding="utf-8")
    command = ["bench", *words, "--store", str(tmp_path / "s.db"), "--jobs", "1", "--out", str(tmp_path / "runs")]
    assert run([*command, "--no-control", "all", "--json"]) == 0
    told: dict[str, Any] = json.loads(capsys.readouterr().out)["result"]
    return told


def test_where2place_is_read_and_scored_by_its_masks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = where2place(tmp_path / "w2p")
    scenes = scenes_of(f"set/pointing/where2place:{folder}")
    assert [one.words for one in scenes] == ["Point to the free spot."] * 2, (
        "how answers are to be written is not asked"
    )
    assert {one.kind for one in scenes} == {"area"}
    told = bench(
        capsys, tmp_path, "pointing", "--set", str(folder), "--format", "where2place", "--method", f"{tmp_path}/mine.py:Redmost"
    )  # fmt: skip
    (one,) = told["conditions"]
    assert (one["successes"], one["scored"]) == (1, 2)
    assert not any("development" in text or "controls" in text for text in told["warnings"])
    assert len(list((tmp_path / "runs" / "trials").glob("*/final.png"))) == 1, "the miss alone keeps its picture"


def test_refspatial_is_read_part_by_part(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = refspatial(tmp_path / "ref")
    suites = set_suites(["pointing"], folder, None)
    assert [suite.name.rpartition("/")[2] for suite in suites] == ["Location", "Placement"]
    assert [scenes_of(suite.name)[0].kind for suite in suites] == ["object", "area"]
    assert {scenes_of(suite.name)[0].words for suite in suites} == {"the red disc"}
    told = bench(capsys, tmp_path, "pointing", "--set", str(folder), "--method", f"{tmp_path}/mine.py:Redmost")
    assert told["conditions"][0]["successes"] == 2
    assert len(set_suites(["pointing"], folder / "Location", None)) == 1


def test_own_photos_with_boxes_serve_both_suites(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = coco(tmp_path)
    told = bench(
        capsys, tmp_path, "pointing", "boxcheck", "--set", str(path), "--method", "point,team", "--model", "offline"
    )
    rates = {one["method"]: (one["successes"], one["scored"]) for one in told["conditions"]}
    assert rates["team"][1] == rates["point"][1] >= 4 + 3 * 4
    assert rates["team"][0] >= 0.8 * rates["team"][1], rates
    assert run(["report", str(tmp_path / "s.db")]) == 0
    assert "set/boxcheck/around/coco:" in capsys.readouterr().out


def test_boxes_are_what_their_kind_says(tmp_path: Path) -> None:
    path = coco(tmp_path)
    for kind in BOX_KINDS:
        found = boxes_of(f"set/boxcheck/{kind}/coco:{path}")
        assert found
        for one in found:
            right = one.scene.box
            assert right is not None
            touches = one.box.intersection(right)
            expected = {
                "perfect": one.box == right,
                "slightly_off": touches is not None and 0 < one.box.iou(right) < 0.8,
            }
            assert expected.get(kind, touches is None), kind
    assert all(one.box in one.scene.others for one in boxes_of(f"set/boxcheck/wrong_object/coco:{path}"))


def test_a_point_beside_says_how_far_off() -> None:
    right = np.zeros((30, 40), bool)
    right[10:20, 10:20] = True
    assert score_place((15.0, 15.0), right).outcome == "success"
    beside = score_place((29.0, 15.0), right)
    assert beside.outcome == "failure"
    assert beside.facts["off [share of the diagonal]"] == pytest.approx(10 / 50, abs=0.005)
    assert score_place((400.0, -5.0), right).outcome == "failure"
    assert score_place(None, right).reason == "not found"


def test_bad_files_are_named_with_line_and_cause(tmp_path: Path) -> None:
    folder = where2place(tmp_path / "w2p")
    lines = (folder / "point_questions.jsonl").read_text(encoding="utf-8").splitlines()
    task, number = f"set/pointing/where2place:{folder}", 0

    def refused(text: str, match: str) -> None:
        nonlocal number
        number += 1
        other = tmp_path / f"bad{number}"
        where2place(other)
        (other / "point_questions.jsonl").write_text(text, encoding="utf-8")
        with pytest.raises(ConfigError, match=match):
            scenes_of(f"set/pointing/where2place:{other}")

    refused(f"{lines[0]}\nnot json", "line 2: no JSON")
    refused('{"image": "00.jpg"}', "line 1: text: Field required")
    refused("", "holds no question")
    refused('{"image": "../../secret.jpg", "text": "x"}', "lies outside of it")
    refused('{"image": "07.jpg", "text": "x"}', "there is no file .*07.jpg")
    scene = scenes_of(task)[0]
    assert scene.mask is not None
    write(scene.mask, mask((5, 5), (60, 40)))
    with pytest.raises(ConfigError, match="60 x 40 px; valid: 120 x 80 px"):
        scene.right((120, 80))
    write(scene.mask, np.zeros((80, 120, 3), np.uint8))
    with pytest.raises(ConfigError, match="black all over"):
        scene.right((120, 80))
    (tmp_path / "dict").mkdir()
    (tmp_path / "dict" / "question.json").write_text("{}", encoding="utf-8")
    with pytest.raises(ConfigError, match="valid: a list of entries"):
        set_suites(["pointing"], tmp_path / "dict", None)


def test_what_does_not_go_together_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = where2place(tmp_path / "w2p")
    with pytest.raises(ConfigError, match="this set has masks; valid: --format coco"):
        set_suites(["boxcheck"], folder, None)
    with pytest.raises(ConfigError, match="--set goes with the suites pointing and boxcheck, not with 'vima17'"):
        set_suites(["vima17"], folder, None)
    with pytest.raises(UnknownNameError, match="where2place"):
        format_of(folder, "where-2-place")
    with pytest.raises(ConfigError, match="its format is not plain"):
        format_of(tmp_path, None)
    assert run(["bench", "pointing", "--set", str(tmp_path / "none"), "--store", str(tmp_path / "s.db")]) == 2
    assert run(["bench", "pointing", "--format", "coco", "--store", str(tmp_path / "s.db")]) == 2
    assert "name it with --set" in capsys.readouterr().err


def test_a_trial_of_a_set_says_how_to_run_it_again() -> None:
    task = "set/boxcheck/around/coco:/data/mine.json"
    words = command_again(TrialSpec(task, 3, Condition("point", "m")))
    assert words.startswith(
        "wonderful-team bench boxcheck --set /data/mine.json --format coco --method point --model m"
    )
