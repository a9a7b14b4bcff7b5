"""The record shows what went out: the very files, in the size, the ticks and the format that the model was sent."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

import wonderful_team as wt
from tests.models.providers.asking import small_scene
from tests.planning.stub_model import stub_model, stub_script
from tests.servers.brains import AgentSession, Tapped, typed_brain
from tests.servers.heard import Heard
from tests.servers.server import Rules, WireServer
from tests.servers.wiring import WIRES
from wonderful_team.api.replay import replay
from wonderful_team.core.values import Request
from wonderful_team.images import Ticks, load_picture
from wonderful_team.images.drawn import drawn
from wonderful_team.models.wire.weight import Weight
from wonderful_team.record.record_schema import read_record

pytestmark = pytest.mark.enable_socket


def planned(folder: Path, wire: str, rules: Rules, weight: Weight | None = None) -> tuple[wt.PlanResult, list[Heard]]:
    """A plan over a server of this wire, and what the server heard."""
    script, session = stub_script(), AgentSession()
    brain = typed_brain(session, lambda request: script[request.contract](request), WIRES[wire].speech)
    with WireServer(brain, rules) as server:
        provider = WIRES[wire].provider(server, deadline_s=60.0)
        if weight is not None:
            provider._learned.weight = weight
        team = wt.Team(model=Tapped(provider, session), out=folder, cache="off", allow_unpriced=True)
        return team.plan(small_scene(480, 360).rgb, "put the one into the other"), server.heard


def kept(folder: Path) -> list[list[np.ndarray]]:
    """The pictures of every request that the record keeps, in the order of sending; one on a sheet once."""
    record = read_record(folder)
    times = record["clock"]["requests"]
    entries = sorted(record["planner"]["requests"], key=lambda entry: times[entry["key"]]["sent_s"])
    return [
        [
            load_picture(folder / record["files"][part["drawn"]])
            for part in entry["parts"]
            if "picture" in part and part.get("on_sheet", 1) == 1
        ]
        for entry in entries
    ]


@pytest.mark.parametrize(
    ("wire", "max_pictures", "weight", "ending"),
    [
        ("server", None, None, "png"),  # thousandths on the axes
        ("openai-chat", None, None, "png"),
        ("openai-chat", None, Weight(picture=12_000), "jpg"),
        ("server", 1, None, "png"),  # all on one sheet
    ],
)
def test_the_record_keeps_what_the_server_got(tmp_path, wire, max_pictures, weight, ending):
    rules = Rules(local=not WIRES[wire].vendor, max_pictures=max_pictures)
    made, heard = planned(tmp_path, wire, rules, weight)
    assert made.status == "planned"
    got = sorted((len(one.pictures), one.pictures[0].tobytes()) for one in heard if one.pictures)
    ours = sorted((len(shown), cv_pixels(shown[0])) for shown in kept(made.folder) if shown)
    if max_pictures == 1:
        # What the server refused before the client knew of its limit was sent as several.
        got = [one for one in got if one[0] == 1]
    assert ours == got
    assert list((made.folder / "pictures").glob(f"[0-9]*.{ending}"))
    parts = [part for entry in read_record(made.folder)["planner"]["requests"] for part in entry["parts"]]
    assert all(part["sent_px"] for part in parts if "picture" in part)
    assert ("on_sheet" in {key for part in parts for key in part}) is (max_pictures == 1)
    page = made.page.read_text(encoding="utf-8")
    assert "picture missing" not in page
    # A model that points badly is shown axes on every view, and a replay has not learnt that of it.
    assert replay(made.folder, tolerant=wire != "server").same


def cv_pixels(rgb: np.ndarray) -> bytes:
    """As the server holds them, who reads with OpenCV; JPEG decoders may differ by a shade, so PNG alone is compared bit for bit."""
    return np.ascontiguousarray(rgb).tobytes()


def test_a_model_that_is_handed_the_request_is_recorded_with_drawn_pictures(tmp_path):
    requests: list[Request] = []

    class Listening:
        def on_event(self, event):
            if event.kind == "request":
                requests.append(event.content)

    team = wt.Team(model=stub_model(), out=tmp_path, subscribers=(Listening(),))
    made = team.plan(small_scene(480, 360).rgb, "put the one into the other")
    drawings = sorted(drawn(part, Ticks.PIXELS).tobytes() for one in requests for part in one.pictures)
    assert drawings == sorted(rgb.tobytes() for shown in kept(made.folder) for rgb in shown)


def test_messages_hold_the_pictures_that_the_record_keeps(tmp_path):
    """A model of one's own that asks for messages: its files are the record's, byte for byte."""
    files: list[bytes] = []

    class Own:
        name = "own"

        async def answer(self, request):
            user = next(message for message in request.messages("png") if message["role"] == "user")
            files.extend(part["data"] for part in user["content"] if part["type"] == "image")
            return await stub_model().answer(request)

    made = wt.Team(model=Own(), out=tmp_path).plan(small_scene(480, 360).rgb, "put the one into the other")
    on_disk = {path.read_bytes() for path in (made.folder / "pictures").glob("[0-9]*.png")}
    assert set(files) == on_disk
    assert all(cv2.imdecode(np.frombuffer(file, np.uint8), cv2.IMREAD_COLOR) is not None for file in files)
