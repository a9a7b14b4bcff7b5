"""`instruct2act`: one request without a picture, one program in the sandbox, a segmenter and a classifier called from it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import wonderful_team as wt
from tests.desk import read_record
from tests.planning.baselines.runs import Listening, contracts, decided, photo, pictures, requests, run, words
from wonderful_team.core.actions import ARM, VOCABULARIES
from wonderful_team.core.protocols import Act, GaveUp
from wonderful_team.core.values import Request
from wonderful_team.planning.baselines.instruct2act import EXAMPLE


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """One trial whose things only pictures show."""
    return run("instruct2act", "visual_manipulation", tmp_path_factory.mktemp("instruct2act"))


def stages(trial: Any, name: str) -> list[str]:
    return [entry["text"] for entry in read_record(trial.folder)["planner"]["stages"] if entry["name"] == name]


def test_one_request_with_one_worked_example_and_no_picture(trial: Any) -> None:
    assert trial.outcome == "success"
    assert contracts(trial) == ["WriteProgram"]
    (request,) = requests(trial)
    assert pictures(request) == []
    assert words(request).count(EXAMPLE) == 1
    for function in ("segment(picture='')", "retrieve(segments, query)", "pick_place(pick, place, rotate_deg=0)"):
        assert function in words(request)


def test_the_program_ran_in_the_sandbox_and_looked_by_the_instructions_pictures(trial: Any) -> None:
    assert stages(trial, "program") == ["the program ran in the sandbox: 4 calls, 1 of pick_place"]
    assert [text.split(":")[0] for text in stages(trial, "retrieved")] == ["classical classifier"] * 2
    assert "like {dragged_obj_1}: main view" in stages(trial, "retrieved")[0]
    (look,) = read_record(trial.folder)["planner"]["detections"]
    assert look["words"] == ["object"]
    assert len(look["found"]) == 3


def test_what_it_picks_is_the_middle_of_the_retrieved_box(trial: Any) -> None:
    (look,) = read_record(trial.folder)["planner"]["detections"]
    number = int(stages(trial, "retrieved")[0].split("main view ")[1].split(" ")[0])
    x0, y0, x1, y1 = look["found"][number - 1]["box"]
    assert trial.plans[0].grounded["T1"].points["pick"] == pytest.approx(((x0 + x1) / 2, (y0 + y1) / 2), abs=0.6)


def test_the_record_says_who_stands_in_for_clip(trial: Any) -> None:
    assert trial.setting["classifier name"] == "classical classifier, in the place of CLIP"
    assert trial.setting["detector name"] == "classical"


@pytest.mark.parametrize(
    ("task", "model"),
    [("rotate", "offline"), ("rotate", "simulated:perfect"), ("rearrange", "simulated:perfect")],
)
def test_it_can_state_what_the_methods_own_tasks_need(task: str, model: str, tmp_path: Path) -> None:
    trial = run("instruct2act", task, tmp_path, model=model, seed=501)
    assert trial.outcome == "success"
    code = requests(trial)[0]["answer"]["parsed"]["code"]
    # Where things go in a whole scene is looked up in that scene's picture.
    assert ("retrieve(segment('scene'), t1_box)" in code) == (task == "rearrange")


class Coder:
    """Writes one program."""

    name = "coder"

    def __init__(self, code: str) -> None:
        self.code = code

    def answer(self, request: Request) -> Any:
        return {"reasoning": "", "code": self.code}


ALL = "s = segment()\n"
BY_WORDS = (
    f"{ALL}a = retrieve(s, 'red circle')[0]\nb = retrieve(s, 'blue square')[0]\n"
    "pick_place((a['x'], a['y']), (b['x'], b['y']), 15)"
)


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("1 / 0", "ZeroDivisionError"),
        (f"{ALL}retrieve(s, 'green star')[0]", "IndexError"),
        (f"{ALL}retrieve(s, 'zorkmid')", "I do not know: zorkmid"),
        (f"{ALL}retrieve(s, '{{mug}}')", "{mug} is no picture of one thing alone; valid: none"),
        (f"{ALL}retrieve([1], 'red circle')", "needs a list of segments, as segment() returns them"),
        (f"{ALL}retrieve(s, 7)", "needs words, the name of a picture in braces, or a segment"),
        ("segment('scene')", "knows no picture 'scene' of the instruction; valid: none"),
        ("pick_place((1, 2), 'there')", "pick_place: place must be (x, y), it is 'there'"),
        ("pick_place((1, 2), (3, 4), 'far')", "rotate_deg must be a number"),
        ("open('/etc/passwd')", "PermissionError"),
        (f"{ALL}retrieve([{{'id': [1]}}], 'red circle')", "needs a list of segments, as segment() returns them"),
        (f"{ALL}retrieve(s, {{'id': [1]}})", "needs words, the name of a picture in braces, or a segment"),
        ("pick_place((10 ** 400, 2), (3, 4))", "not plain finite numbers"),
        ("print('\\x1d[\"pick_place\", []]')", "gives pick_place(pick, place, rotate_deg=0) 0 values"),
        ("print('\\x1d[\"segment\", [1, 2]]')", "gives segment(picture='') 2 values"),
    ],
)
def test_a_program_that_fails_is_a_crash_and_is_not_asked_for_again(code: str, said: str, tmp_path: Path) -> None:
    model = Listening(Coder(code))
    made = decided("instruct2act", photo(tmp_path), model)
    assert isinstance(made, GaveUp)
    assert made.stage == "crash"
    assert said in made.reason
    assert len(model.heard) == 1


def test_retrieval_by_words_by_segment_and_by_nothing(tmp_path: Path) -> None:
    seen = photo(tmp_path)
    made = decided("instruct2act", seen, Coder(BY_WORDS))
    assert isinstance(made, Act)
    pick, place = made.actions[0].sources
    assert pick.point_px == pytest.approx((80, 150), abs=3)
    assert place.point_px == pytest.approx((230, 90), abs=3)
    assert made.actions[0].step.rotate_deg == 15
    by_itself = (
        f"{ALL}a = retrieve(s, s[0])[0]\nif a['id'] != s[0]['id']:\n    1 / 0\npick_place((a['x'], a['y']), (300, 30))"
    )
    assert isinstance(decided("instruct2act", seen, Coder(by_itself)), Act)


def test_arms_and_pushers_run_what_it_picks_and_places(tmp_path: Path) -> None:
    seen = photo(tmp_path)
    armed = decided("instruct2act", replace(seen, vocabulary=ARM), Coder(BY_WORDS))
    assert isinstance(armed, Act)
    kinds = [action.step.kind for action in armed.actions]
    assert kinds == ["move", "move", "close", "move", "rotate_gripper", "move", "move", "open", "move"]
    pushed = decided("instruct2act", replace(seen, vocabulary=VOCABULARIES["push"]), Coder(BY_WORDS))
    assert isinstance(pushed, Act)
    assert [action.step.kind for action in pushed.actions] == ["push"]
    assert pushed.actions[0].sources[0].point_px == pytest.approx((80, 150), abs=3)


def test_a_detector_of_boxes_alone_serves_it_too(tmp_path: Path) -> None:
    class Boxes:
        name = "boxes"

        def detect(self, rgb: Any, words: Any) -> list[wt.Detection]:
            assert list(words) == ["object"]
            return [
                wt.Detection("object", wt.Box(54, 124, 106, 176), 0.9),
                wt.Detection("object", wt.Box(200, 60, 260, 120), 0.8),
            ]

    policy: Any = wt.Method(method="instruct2act", model=Coder(BY_WORDS), detector=Boxes()).policy()
    import asyncio

    made = asyncio.run(policy.decide(photo(tmp_path)))
    assert isinstance(made, Act)
    assert made.actions[0].sources[0].point_px == pytest.approx((80, 150), abs=1)
