"""What a provider sends and learns, seen by local servers that check every request against the vendors' own types."""

from __future__ import annotations

import asyncio
import json
import logging
import threading
import time
import traceback
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, HTTPServer
from typing import Any

import numpy as np
import pytest

from tests.models.wire.scenes import answer_px, picture, reading
from tests.servers.brains import AgentSession, Tapped, scripted_brain, typed_brain
from tests.servers.faults import Fault
from tests.servers.server import KEY, Rules, WireServer
from tests.servers.wiring import WIRES, Wire
from wonderful_team.core.caps import Caps
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Answer, Request
from wonderful_team.errors import (
    BudgetReached,
    ConfigError,
    ModelAuthError,
    ModelRateLimitError,
    ModelTimeoutError,
    ModelUnavailableError,
    UnknownModelError,
    WonderfulTeamError,
)
from wonderful_team.models.budget import Budget
from wonderful_team.models.client import ModelClient
from wonderful_team.models.prices import GivenPrice
from wonderful_team.models.profiles import Profile
from wonderful_team.models.providers import SERVER_KEY, make_provider
from wonderful_team.models.wire import compose

VIEW = picture()
REQUEST = reading(VIEW, (picture((300, 200), "front"),))


def serve(wire: Wire, desk: AgentSession, **rules: Any) -> WireServer:
    return WireServer(typed_brain(desk, lambda _: answer_px(VIEW), wire.speech), Rules(local=not wire.vendor, **rules))


def grainy_request() -> Request:
    """The same question about pictures with the noise of a camera."""
    rng = np.random.default_rng(5)

    def grainy(even: Picture) -> Picture:
        return replace(even, rgb=np.clip(even.rgb + rng.normal(0, 3, even.rgb.shape), 0, 255).astype(np.uint8))

    return reading(grainy(VIEW), (grainy(picture((300, 200), "front")),))


def ask(model: Any, desk: AgentSession, **client: Any) -> Answer:
    return asyncio.run(ModelClient(Tapped(model, desk), **client).ask(REQUEST))


@pytest.fixture
def desk() -> AgentSession:
    return AgentSession()


@pytest.mark.parametrize("name", WIRES)
def test_a_request_is_answered_and_booked(name: str, desk: AgentSession) -> None:
    with serve(WIRES[name], desk) as server:
        answer = ask(WIRES[name].provider(server, price=GivenPrice(2, 10)), desk)
    (heard,) = server.heard
    assert answer.value.targets[0].box.as_box.as_tuple == pytest.approx((64, 96, 192, 288), abs=1)
    assert heard.system == REQUEST.system
    assert [piece.shape[:2] for piece in heard.pictures] == [(480, 640), (200, 300)]
    assert heard.schema_native
    provider = WIRES[name].provider(server)
    composed = compose(REQUEST, provider.convention, schema_in_words=provider.spec.vendor is None)
    assert heard.words == "\n".join(piece for piece in composed.pieces if isinstance(piece, str)), "words were added"
    usage = answer.usage
    assert (usage.calls, usage.pictures, usage.tokens_out) == (1, 2, 100)
    assert usage.usd == pytest.approx((usage.tokens_in * 2 + 100 * 10) / 1e6)
    assert usage.tokens_in > 500


@pytest.mark.parametrize("name", WIRES)
def test_the_estimate_is_on_the_careful_side(name: str, desk: AgentSession) -> None:
    with serve(WIRES[name], desk) as server:
        provider = WIRES[name].provider(server)
        estimate = provider.estimate(REQUEST)
        answer = ask(provider, desk)
    assert answer.usage.tokens_in <= estimate.tokens_in <= 4 * answer.usage.tokens_in
    assert estimate.tokens_out == provider.settings.max_tokens


@pytest.mark.parametrize("name", WIRES)
def test_a_repair_goes_on_from_the_same_prefix_and_shows_the_last_answer(name: str, desk: AgentSession) -> None:
    with serve(WIRES[name], desk) as server:
        server.strike(Fault("wrong_schema"))
        answer = ask(WIRES[name].provider(server), desk)
    first, second = server.heard
    assert answer.tries == 2
    assert second.system == first.system
    assert [turn.role for turn in second.turns] == ["user", "assistant", "user"]
    assert "colour" in str(second.turns[1].pieces[0])
    assert "Your answer does not fit" in str(second.turns[2].pieces[0])
    assert second.words.startswith(first.words)


@pytest.mark.parametrize("name", WIRES)
def test_thinking_is_switched_in_each_services_own_way(name: str, desk: AgentSession) -> None:
    wire = WIRES[name]
    with serve(wire, desk) as server:
        for thinking in ("off", "low", "high"):
            ask(wire.provider(server, thinking=thinking), desk)
        ask(wire.provider(server), desk)
    off, low, high, default = (heard.body for heard in server.heard)
    match name:
        case "openai-chat":
            said = [body.get("reasoning_effort") for body in (off, low, high, default)]
            assert said[1:] == ["low", "high", None]
            assert said[0] in ("none", "minimal")
        case "openai-responses":
            assert [body.get("reasoning", {}).get("effort") for body in (low, high)] == ["low", "high"]
            assert off["reasoning"]["effort"] in ("none", "minimal")
            assert default.get("store") is False
        case "anthropic":
            assert off.get("thinking", {"type": "disabled"})["type"] == "disabled"
            assert [body["output_config"].get("effort") for body in (low, high)] == ["low", "high"]
            assert low["thinking"]["type"] == high["thinking"]["type"] == "adaptive"
        case "google":
            budget = [body["generationConfig"]["thinkingConfig"]["thinkingBudget"] for body in (off, low, high)]
            assert budget[0] < budget[1] < budget[2]
        case "server":
            kwargs = [body.get("chat_template_kwargs") for body in (off, low, high, default)]
            assert kwargs == [{"enable_thinking": False}, {"enable_thinking": True}, {"enable_thinking": True}, None]
            assert high["reasoning_effort"] == "high"


def test_a_server_that_takes_fewer_pictures_gets_one_sheet_from_then_on(desk: AgentSession) -> None:
    wire = WIRES["server"]
    with serve(wire, desk, max_pictures=1) as server:
        provider = wire.provider(server)
        first, second = ask(provider, desk), ask(provider, desk)
    assert [len(heard.pictures) for heard in server.heard] == [2, 1, 1]
    assert (first.usage.calls, second.usage.calls) == (2, 1)
    assert first.value.targets[0].box.as_box.as_tuple == pytest.approx((64, 96, 192, 288), abs=1)


def test_a_server_that_refuses_schemas_is_told_them_in_words(desk: AgentSession) -> None:
    wire = WIRES["openai-chat"]
    with serve(wire, desk, schemas="refused") as server:
        provider = wire.provider(server)
        ask(provider, desk)
        ask(provider, desk)
    assert [heard.schema_native for heard in server.heard] == [True, False, False]
    assert "JSON schema" in server.heard[1].words


def test_a_profile_takes_the_place_of_what_the_name_suggests(desk: AgentSession) -> None:
    wire = replace(WIRES["server"], model="my-planner-v3", speech=WIRES["google"].speech)
    convention = make_provider("google:gemini-3", api_key="x").convention
    with serve(wire, desk, max_pictures=1) as server:
        profile = Profile("mine", wire.spec(server), convention=convention, max_pictures=1, usd_in=1.0, usd_out=2.0)
        provider = wire.provider(server, profile=profile)
        answer = ask(provider, desk)
    assert provider.name == "mine"
    assert answer.usage.calls == 1
    assert answer.usage.usd is not None
    assert answer.value.targets[0].box.as_box.as_tuple == pytest.approx((64, 96, 192, 288), abs=2)
    weak = wire.provider(server, profile=replace(profile, native_boxes=False))
    assert (weak.convention.name, weak.weak_pointing) == ("pixels", True)


def test_waits_that_are_too_long_are_not_waited(desk: AgentSession) -> None:
    wire = WIRES["openai-chat"]
    with serve(wire, desk) as server:
        server.always(Fault("rate_limit", 120))
        started = time.monotonic()
        with pytest.raises(ModelRateLimitError, match="asks to wait 120 s"):
            ask(wire.provider(server), desk)
    assert time.monotonic() - started < 3
    assert len(server.log) == 1


def test_retry_after_is_waited_for_and_every_try_is_counted(desk: AgentSession) -> None:
    wire = WIRES["anthropic"]
    with serve(wire, desk) as server:
        server.strike(Fault("rate_limit", 0.4), Fault("error_500"))
        client = ModelClient(Tapped(wire.provider(server), desk))
        answer = asyncio.run(client.ask(REQUEST))
    assert server.log[1].at_s - server.log[0].at_s >= 0.4
    assert answer.usage.calls == client.budget.spent.calls == len(server.log) == 3


@pytest.mark.parametrize("fault", ["hang", "drip"])
@pytest.mark.parametrize("name", WIRES)
def test_the_deadline_holds_for_the_whole_request(name: str, fault: str, desk: AgentSession) -> None:
    with serve(WIRES[name], desk) as server:
        server.always(Fault(fault, 0.02))
        provider = WIRES[name].provider(server, deadline_s=0.8)
        started = time.monotonic()
        with pytest.raises(ModelTimeoutError):
            ask(provider, desk)
    assert time.monotonic() - started < 2.5


def test_retries_stop_at_the_cap_on_calls(desk: AgentSession) -> None:
    wire = WIRES["google"]
    with serve(wire, desk) as server:
        server.always("error_500")
        with pytest.raises(BudgetReached):
            ask(wire.provider(server, tries=9), desk, budget=Budget(Caps(calls=2)))
    assert len(server.log) == 2


def test_an_answer_is_held_to_what_the_cap_leaves(desk: AgentSession) -> None:
    wire = WIRES["openai-chat"]
    with serve(wire, desk) as server:
        provider = wire.provider(server)
        cap = provider.estimate(REQUEST).tokens_in + 700
        ask(provider, desk, budget=Budget(Caps(tokens=cap)))
        server.always("cut_off")
        with pytest.raises(BudgetReached, match="cut off at 700 tokens"):
            ask(wire.provider(server), desk, budget=Budget(Caps(tokens=cap)))
    assert server.heard[0].body["max_completion_tokens"] == 700


def test_one_provider_serves_several_event_loops_and_leaves_no_connection_open(desk: AgentSession) -> None:
    wire = WIRES["server"]
    with serve(wire, desk) as server:
        provider = wire.provider(server)
        assert [ask(provider, desk).tries for _ in range(3)] == [1, 1, 1]


@pytest.mark.parametrize("fault", ["unauthorized", "error_500", None])
@pytest.mark.parametrize("name", WIRES)
def test_the_key_is_nowhere(
    name: str,
    fault: str | None,
    desk: AgentSession,
    caplog: pytest.LogCaptureFixture,
    capfd: pytest.CaptureFixture[str],
) -> None:
    caplog.set_level(logging.DEBUG)
    seen, causes = "", []
    with serve(WIRES[name], desk) as server:
        if fault is not None:
            server.always(fault)
        provider = WIRES[name].provider(server, tries=2)
        try:
            answer = ask(provider, desk)
            seen += answer.raw
        except WonderfulTeamError as error:
            seen += "".join(traceback.format_exception(error))
            causes.append(error.__cause__)
    assert server.log[0].heard is not None
    assert server.log[0].heard.secret == KEY
    seen += caplog.text + "".join(capfd.readouterr()) + repr(provider) + json.dumps(dict(provider.identity))
    assert KEY not in seen
    # The library's own error would carry the request's headers along.
    assert causes in ([], [None])


def test_openrouter_speaks_as_the_maker_of_its_model(desk: AgentSession) -> None:
    wire = Wire("openrouter", "/v1", "google/gemini-2.5-pro", WIRES["google"].speech)
    with WireServer(typed_brain(desk, lambda _: answer_px(VIEW), wire.speech), Rules(local=True)) as server:
        answer = ask(wire.provider(server), desk)
    assert answer.value.targets[0].box.as_box.as_tuple == pytest.approx((64, 96, 192, 288), abs=1)
    assert server.heard[0].schema is not None
    assert answer.usage.tokens_out == 100


def test_a_server_is_asked_which_model_it_has() -> None:
    with WireServer(scripted_brain("{}"), Rules(models=("my-planner",))) as server:
        assert make_provider(f"{server.url}/v1", api_key=KEY).name == f"{server.url}/v1#my-planner"
    with WireServer(scripted_brain("{}"), Rules(models=("one", "two"))) as server:
        with pytest.raises(ConfigError, match="has 2 models; say which") as caught:
            make_provider(f"{server.url}/v1", api_key=KEY)
        assert f"{server.url}/v1#two" in str(caught.value)
    with pytest.raises(ModelUnavailableError, match="no model server answers"):
        make_provider(f"{server.url}/v1", api_key=KEY)


@pytest.mark.parametrize(
    ("status", "body", "error", "says"),
    [
        (200, b"<html>welcome</html>", UnknownModelError, "gives no list of models"),
        (404, b"{}", UnknownModelError, "status 404"),
        (401, b"{}", ModelAuthError, "WONDERFUL_TEAM_SERVER_KEY"),
        (500, b"{}", ModelUnavailableError, "status 500"),
        (200, b'{"data": []}', ConfigError, "has no model loaded"),
        (200, b'{"models": [{"name": "a"}, {"name": "b"}]}', ConfigError, "say which"),
    ],
)
def test_what_is_no_list_of_models_is_told_apart(
    status: int, body: bytes, error: type[WonderfulTeamError], says: str
) -> None:
    class Fixed(BaseHTTPRequestHandler):
        def do_GET(self) -> None:  # noqa: N802  http.server's name
            self.send_response(status)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: object) -> None:
            pass

    with HTTPServer(("127.0.0.1", 0), Fixed) as server:
        thread = threading.Thread(target=server.handle_request)
        thread.start()
        with pytest.raises(error, match=says):
            make_provider(f"http://127.0.0.1:{server.server_port}/v1")
        thread.join()


def test_an_unknown_thinking_level_is_refused() -> None:
    with pytest.raises(ConfigError, match="valid are off, low, medium, high"):
        make_provider("openai:gpt-5", api_key="x", thinking="max")  # type: ignore[arg-type]


@pytest.mark.parametrize("name", WIRES)
def test_a_wrong_key_is_told_from_a_missing_one(name: str, desk: AgentSession, monkeypatch: pytest.MonkeyPatch) -> None:
    wire = WIRES[name]
    with serve(wire, desk) as server:
        monkeypatch.setenv(SERVER_KEY, "another-key-altogether")
        with pytest.raises(ModelAuthError, match=f"refused the key that {SERVER_KEY} holds") as wrong:
            ask(wire.provider(server, api_key=None), desk)
        monkeypatch.delenv(SERVER_KEY)
        with pytest.raises(ModelAuthError, match=f"none was sent: set the environment variable {SERVER_KEY}"):
            ask(wire.provider(server, api_key=None), desk)
    assert wrong.value.exit_code == 2
    assert "another-key" not in str(wrong.value)


@pytest.mark.parametrize("status", [401, 403])
def test_a_list_of_models_that_refuses_the_key_names_what_holds_it(
    status: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Refusing(BaseHTTPRequestHandler):
        def do_GET(self) -> None:  # noqa: N802  http.server's name
            self.send_response(status)
            self.send_header("Content-Length", "0")
            self.end_headers()

        def log_message(self, *_: object) -> None:
            pass

    monkeypatch.setenv(SERVER_KEY, "a-wrong-key")
    with HTTPServer(("127.0.0.1", 0), Refusing) as server:
        thread = threading.Thread(target=server.handle_request)
        thread.start()
        with pytest.raises(ModelAuthError, match=f"refused the key that {SERVER_KEY} holds"):
            make_provider(f"http://127.0.0.1:{server.server_port}/v1")
        thread.join()


@pytest.mark.parametrize("name", ["openai-chat", "openai-responses"])
@pytest.mark.parametrize(("model", "detail"), [("gpt-4o", "high"), ("gpt-5.6", "original"), ("my-planner", None)])
def test_openai_is_told_in_which_detail_to_look(name: str, model: str, detail: str | None, desk: AgentSession) -> None:
    wire = replace(WIRES[name], model=model)
    with serve(wire, desk) as server:
        ask(wire.provider(server), desk)
    said = json.dumps(server.heard[0].body)
    told = [word for word in ("high", "original") if f'"detail": "{word}"' in said]
    assert told == ([] if detail is None else [detail])


@pytest.mark.parametrize("encoding", ["png", "auto"])
@pytest.mark.parametrize("fault", ["too_heavy", "picture_too_heavy"])
def test_pictures_that_were_refused_as_too_heavy_are_sent_again_as_lighter_jpeg(
    fault: str, encoding: str, desk: AgentSession
) -> None:
    found = {"id": "T1", "found": True, "box": [64, 96, 192, 288], "points": [{"role": "pick", "point": [128, 192]}]}
    absent = {"id": "T2", "found": False, "box": None, "points": []}
    said = json.dumps({"reasoning": "", "targets": [{**found, "unsure": ""}, {**absent, "unsure": ""}]})
    wire = WIRES["anthropic"]
    with WireServer(scripted_brain(said), Rules(local=not wire.vendor)) as server:
        server.strike(Fault(fault))
        # With the grain of a photo: JPEG makes an even picture no lighter.
        model = Tapped(wire.provider(server, encoding=encoding), desk)
        answer = asyncio.run(ModelClient(model).ask(grainy_request()))
    first, second = server.heard
    assert [piece.shape for piece in second.pictures] == [piece.shape for piece in first.pictures]
    assert ("image/jpeg" in json.dumps(first.body)) == (encoding == "auto")
    assert second.bytes_in < first.bytes_in
    assert "image/jpeg" in json.dumps(second.body)
    # Positions are what they were: the size is the same.
    assert answer.value.targets[0].box.as_box.as_tuple == pytest.approx((64, 96, 192, 288), abs=1)
    (notice,) = answer.notices
    assert "sent as JPEG" in notice
