"""`instruct2act`: one program, written without a picture, over a segmenter and a classifier.

Sources: Huang et al. 2023, Instruct2Act: Mapping Multi-modality Instructions to Robotic Actions with Large Language Model, arXiv:2305.11176, and their
program; quoted in Wang, Shen & Stadie 2024, arXiv:2407.19094, Section 6.1 and Appendix D.2.
Followed: the model sees no picture; one question, with one worked example, asks for one program; it segments everything, retrieves a segment by words
or by a picture of the instruction, and picks and places at the middles of boxes; a segment of an instruction's scene can be the query too.
The program runs in our sandbox, each call answered by the host; what it picks and places passes the gate.
Left open or changed, and what is done here:
- SAM segments everything there; here the detector that was chosen is asked for "object". CLIP classifies there; no weights of it could be had,
  so the classical classifier stands in for it (offline's vision: words by its grammar, pictures by colours, pattern, outline and size), whichever detector
  was chosen. Their step that makes all but a coloured foreground grey belongs to SAM and is left out.
- Retrieval returns every segment that it gives any likeness, best first (theirs: those above a probability of 0.1); a program takes the first.
- Their helpers for whole rearrangements (matching two sets of segments, clearing what is in the way) are left to the program.
- They ask anew, up to five times, where a program has fewer than four lines. Here a program that fails is a crash (stage "crash").
- A robot that only pushes is sent straight from pick to place, as in VIMA-Bench.
"""

from __future__ import annotations

import asyncio
import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from wonderful_team.agents.common import ANSWER, DATA, INSTRUCTION, system_words
from wonderful_team.agents.role import Ask, role
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import Program, ProgramFunction, ShownSlot, WriteProgram
from wonderful_team.core.pictures import Picture
from wonderful_team.core.protocols import Classifier, Detector
from wonderful_team.core.values import Detection, Plan, View
from wonderful_team.detectors import extent_of, identity_of
from wonderful_team.errors import CodeCrashError
from wonderful_team.images import crop
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.baselines.open_loop import OpenLoop
from wonderful_team.planning.baselines.programs import (
    HostFunction,
    Looks,
    ToolMotion,
    ToolPath,
    Waypoint,
    finite,
    kinds_of,
    point_in,
    render_program,
    run_with,
)
from wonderful_team.sandbox import HostCall, SandboxError

EVERYTHING = "object"
"""What a detector is asked for, to have everything."""
MAIN = "main view"

EXAMPLE = """
Instruction: Put the {mug_picture} onto the yellow tray, turned by 30 degrees.
segments = segment()
mug = retrieve(segments, "{mug_picture}")[0]
tray = retrieve(segments, "yellow tray")[0]
pick_place((mug["x"], mug["y"]), (tray["x"], tray["y"]), 30)
""".strip()

CODER = role(
    "coder",
    system_words(
        """
You control a robot by writing one Python program. You see nothing: the program finds things itself, by a segmenter and a classifier.
""",
        DATA + "\n" + INSTRUCTION,
        ANSWER,
    ),
    Ask(
        WriteProgram,
        """
Write the program that carries out the instruction, in the manner of the example. It runs once, from its first line to its last, and nobody corrects it.
""",
        render_program,
    ),
)


@dataclass
class Segments:
    """Everything that was segmented, by the ids under which a program knows it."""

    detector: Detector
    classifier: Classifier
    client: ModelClient
    scene: SceneShown
    attempt: int
    kept: dict[str, tuple[View, Detection]] = field(default_factory=dict)
    looks: dict[str, Looks] = field(default_factory=dict)

    async def segment(self, picture: Any) -> list[dict[str, Any]]:
        """Everything in the main view, or in a picture of the instruction."""
        name = str(picture).strip().strip("{}") or MAIN
        view = self._view(name)
        looks = self.looks.setdefault(name, Looks(self.detector, self.client, view, self.attempt))
        found = await looks.at(EVERYTHING)
        for number, one in enumerate(found, start=1):
            self.kept[f"{name} {number}"] = (view, one)
        return [self._told(f"{name} {number}", one) for number, one in enumerate(found, start=1)]

    def _view(self, name: str) -> View:
        if name == MAIN:
            return self.scene.view
        slot = self.scene.instruction.slots.get(name)
        if slot is None:
            known = ", ".join(self.scene.instruction.slots) or "none"
            raise ValueError(f"segment() knows no picture {name[:60]!r} of the instruction; valid: {known}")
        return slot.views.get(self.scene.view.camera_name) or next(iter(slot.views.values()))

    def _told(self, key: str, one: Detection) -> dict[str, Any]:
        frame, extent = self.scene.views[0].frame, extent_of(one)
        x, y = frame.point_to_picture(one.box.centre)
        length, width = round(extent.length * frame.scale), round(extent.width * frame.scale)
        place = {"x": round(x), "y": round(y), "length": length, "width": width}
        return {"id": key, **place, "angle_deg": round(extent.angle_deg) % 180}

    async def retrieve(self, segments: Any, query: Any) -> list[dict[str, Any]]:
        """Of these segments those that are like the query, best first."""
        if not isinstance(segments, list) or not all(self._is_segment(one) for one in segments):
            raise ValueError("retrieve() needs a list of segments, as segment() returns them")
        if not segments:
            return []
        chosen = [self.kept[one["id"]] for one in segments]
        view = chosen[0][0]
        if any(other is not view for other, _ in chosen):
            raise ValueError("retrieve() needs segments of one picture")
        masks = [one.mask_in(view.size_px) for _, one in chosen]
        asked, said = self._query(query)
        scores = await asyncio.to_thread(self.classifier.similar, view.rgb, masks, asked)
        order = sorted(range(len(segments)), key=lambda k: -scores[k])
        liked = [segments[k] for k in order if scores[k] > 0]
        best = f"{liked[0]['id']} ({max(scores):.2f})" if liked else "none"
        text = f"{self.classifier.name}: {said}: {best}, {len(liked)} of {len(segments)} segments"
        self.client.tell("stage", "retrieved", {"text": text, "attempt": self.attempt})
        return liked

    def _is_segment(self, value: Any) -> bool:
        return isinstance(value, dict) and isinstance(value.get("id"), str) and value["id"] in self.kept

    def _query(self, query: Any) -> tuple[str | Picture, str]:
        """What is looked for, as the classifier takes it, and in words."""
        if self._is_segment(query):
            view, one = self.kept[query["id"]]
            return _alone(view, one), f"like segment {query['id']}"
        if not isinstance(query, str) or not query.strip():
            raise ValueError("retrieve() needs words, the name of a picture in braces, or a segment")
        named = re.fullmatch(r"\{([^{}]*)\}", query.strip())
        if named is None:
            return query.strip(), repr(query.strip())
        slot: ShownSlot | None = next((one for one in self.scene.slots if one.name == named.group(1).strip()), None)
        if slot is None or slot.whole_scene or not slot.pictures:
            alone = ", ".join(one.name for one in self.scene.slots if not one.whole_scene) or "none"
            raise ValueError(f"{query.strip()[:60]} is no picture of one thing alone; valid: {alone}")
        return slot.pictures[0], f"like {query.strip()}"


def _alone(view: View, one: Detection) -> Picture:
    """A segment cut out, on white, as pictures of single things are."""
    white = np.where(one.mask_in(view.size_px)[:, :, None], view.rgb, np.uint8(255))
    return crop(View(view.id, view.camera_name, view.time_s, white), one.box, "segment")


class Instruct2Act(OpenLoop):
    """One program.

    Args:
        client: Where the model is asked.
        detector: Segments.
        classifier: Retrieves.
    """

    def __init__(self, client: ModelClient, detector: Detector, classifier: Classifier) -> None:
        super().__init__(client, "instruct2act", CODER)
        self._detector, self._classifier = detector, classifier

    @property
    def setting(self) -> dict[str, str]:
        """How it is set up, for the record."""
        told = {f"detector {key}": value for key, value in identity_of(self._detector).items()}
        return {**super().setting, **told, "classifier name": f"{self._classifier.name}, in the place of CLIP"}

    async def make_plan(self, scene: SceneShown, start: Plan, advice: tuple[str, ...]) -> Plan:
        """One program, and what it picks and places."""
        view = scene.views[0]
        segments = Segments(self._detector, self._classifier, self.client, scene, self.attempt)
        functions = _functions(segments)
        told = tuple(ProgramFunction(f"{name}({one.parameters})", one.words) for name, one in functions.items())
        question = WriteProgram(
            scene.instruction.text, told, kinds_of(scene), view.name, view.size_px, example=EXAMPLE,
            facts=scene.task.facts, advice=advice,
        )  # fmt: skip
        answer = await self.ask(question, CODER, "plan")
        program: Program = answer.value
        try:
            run = await run_with(program.code, functions)
            motions = [motion for call in run.calls if call.function == "pick_place" for motion in _moves(call, scene)]
        except SandboxError as error:
            self.stage("program", f"the program failed in the sandbox: {str(error).splitlines()[0]}")
            raise CodeCrashError(f"the program failed: {error}") from error
        carried = sum(call.function == "pick_place" for call in run.calls)
        self.stage("program", f"the program ran in the sandbox: {len(run.calls)} calls, {carried} of pick_place")
        main = segments.looks.get(MAIN)
        around = (lambda _: None) if main is None else main.around
        path = ToolPath(view, kinds_of(scene), around, "computed by the model's program", answer.provenance)
        path.write(motions)
        return self.with_actions(scene, start, path.subgoals, path.grounded, tuple(path.steps))


def _functions(segments: Segments) -> dict[str, HostFunction]:
    return {
        "segment": HostFunction(
            "picture=''",
            "finds everything in the main view, or in the instruction's picture of that name; returns a list with a dictionary for each "
            "segment: id, x, y (its middle), length, width (pixels), angle_deg (of its longer side, clockwise from the x axis)",
            segments.segment,
        ),
        "retrieve": HostFunction(
            "segments, query",
            "returns those of the segments that are like the query, best first; the query is a description in words, the name of an "
            'instruction\'s picture of one thing in braces such as "{name}", or a segment',
            segments.retrieve,
        ),
        "pick_place": HostFunction(
            "pick, place, rotate_deg=0",
            "picks up what lies at the point pick, (x, y), puts it down at the point place, turned clockwise by rotate_deg",
        ),
    }


def _moves(call: HostCall, scene: SceneShown) -> list[ToolMotion]:
    """One call of pick_place as motions of the tool.

    Raises:
        SandboxError: Its points are none.
    """
    try:
        pick, place = (
            point_in(value, scene.views[0], name)
            for value, name in zip(call.arguments, ("pick", "place"), strict=False)
        )
        turn = finite(call.arguments[2], "rotate_deg")
    except ValueError as error:
        raise SandboxError(f"pick_place: {error}") from error
    ends: list[ToolMotion] = [Waypoint(place, "at", turn), Waypoint(place, "clear", turn)]
    if "pick_place" not in scene.vocabulary.step_kinds and "push" in scene.vocabulary.step_kinds:
        return [Waypoint(pick, "clear"), Waypoint(pick, "at"), *ends]
    over: list[ToolMotion] = [Waypoint(pick, "clear"), Waypoint(place, "clear", turn)]
    return [Waypoint(pick, "clear"), Waypoint(pick, "at"), "close", *over, ends[0], "open", ends[1]]
