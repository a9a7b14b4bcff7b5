"""What real servers do: short contexts, no pictures, slow replies, no thinking, and requests that are cut without a word."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Event, Thread
from typing import Any

import pytest

from tests.models.providers.asking import question, right_answer
from wonderful_team.core.caps import Caps
from wonderful_team.core.protocols import Event as Told
from wonderful_team.core.values import Answer
from wonderful_team.errors import (
    BudgetReached,
    ContextTooLongError,
    ModelTimeoutError,
    NoPicturesError,
    RequestRejectedError,
)
from wonderful_team.models.budget import Budget
from wonderful_team.models.client import ModelClient
from wonderful_team.models.providers import make_provider
from wonderful_team.models.providers.facts import Facts
from wonderful_team.models.providers.server_facts import server_facts
from wonderful_team.models.providers.vendors import SERVER

Reply = tuple[int, Any]


class Server:
    """A server whose replies a test scripts; keeps the bodies of requests for answers.

    Attributes:
        facts: What GET and POST of other paths give, by path.
        script: Replies to the next requests, in order: None is a right answer.
        prompt_tokens: What it says it counted in a request.
        slow_s: How long the next replies take [s].
        on_answer: Called before each reply.
        wait: Set when slow replies may come at once: the test has ended.
    """

    def __init__(self) -> None:
        self.facts: dict[str, Any] = {}
        self.script: list[Reply | None] = []
        self.bodies: list[dict[str, Any]] = []
        self.prompt_tokens = 3000
        self.slow_s: list[float] = []
        self.wait = Event()
        self.on_answer: Callable[[], object] = lambda: None
        own = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:  # noqa: N802  http.server's name
                found = own.facts.get(self.path)
                self.say(200 if found is not None else 404, found or {})

            def do_POST(self) -> None:  # noqa: N802  http.server's name
                body = json.loads(self.rfile.read(int(self.headers["content-length"])))
                if not self.path.endswith("/chat/completions"):
                    self.do_GET()
                    return
                number = len(own.bodies)
                own.bodies.append(body)
                if number < len(own.slow_s):
                    own.wait.wait(own.slow_s[number])
                own.on_answer()
                scripted = own.script[number] if number < len(own.script) else None
                self.say(*(scripted or own.reply(number)))

            def say(self, status: int, value: Any) -> None:
                raw = json.dumps(value).encode()
                try:
                    self.send_response(status)
                    self.send_header("Content-Type", "application/json")
                    self.send_header("Content-Length", str(len(raw)))
                    self.end_headers()
                    self.wfile.write(raw)
                except OSError:
                    pass  # the client has given up

            def log_message(self, *_: object) -> None:
                pass

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self.server.server_port}/v1"
        Thread(target=self.server.serve_forever, daemon=True).start()

    def reply(self, number: int) -> Reply:
        """What a request that is not scripted gets."""
        return 200, self.answer()

    def answer(self) -> dict[str, Any]:
        text = right_answer(question()).model_dump_json()
        message = {"role": "assistant", "content": text}
        usage = {
            "prompt_tokens": self.prompt_tokens,
            "completion_tokens": 100,
            "total_tokens": self.prompt_tokens + 100,
        }
        choice = {"index": 0, "message": message, "finish_reason": "stop"}
        return {"id": "1", "object": "chat.completion", "created": 1, "model": "m", "choices": [choice], "usage": usage}

    def lists(self, **more: Any) -> None:
        """It has one model, and says this of it."""
        self.facts["/v1/models"] = {"object": "list", "data": [{"id": "m", "object": "model", **more}]}

    def provider(self, **options: Any) -> Any:
        return make_provider(f"{self.url}#m", **({"first_wait_s": 0.01} | options))


@pytest.fixture
def server() -> Iterator[Server]:
    running = Server()
    yield running
    running.wait.set()
    running.server.shutdown()
    running.server.server_close()


class Ear:
    """Keeps the warnings that a client tells."""

    def __init__(self) -> None:
        self.warnings: list[str] = []

    def on_event(self, event: Told) -> None:
        if event.kind == "warning":
            self.warnings.append(str(event.content))


def ask(model: Any, ear: Ear | None = None, **client: Any) -> Answer:
    asking = ModelClient(model, subscribers=() if ear is None else (ear,), **client)
    return asyncio.run(asking.ask(question()))


def refused(message: str, status: int = 400) -> Reply:
    return status, {"error": {"message": message, "type": "BadRequestError", "code": status}}


# -- context -------------------------------------------------------------------------------------------------------


def test_the_answers_limit_fits_the_context_that_the_list_of_models_tells_and_it_is_said_once(server: Server) -> None:
    server.lists(max_model_len=4096)
    server.prompt_tokens = 1000
    ear, provider = Ear(), server.provider()
    ask(provider, ear)
    ask(provider, ear)
    first, second = (body["max_tokens"] for body in server.bodies)
    assert 256 <= first < 4096
    assert first <= second <= 4096 - 1000, "what the server counted leaves more room than the careful guess"
    said = [text for text in ear.warnings if "answers are held to" in text]
    assert len(said) == 1
    assert "4096 tokens (GET" in said[0]
    assert "--max-model-len" in said[0]


@pytest.mark.parametrize(
    "message",
    [
        "This model's maximum context length is 4096 tokens. However, you requested 6596 tokens (2500 in the messages, 4096 "
        "in the completion). Please reduce the length of the messages or completion.",
        "'max_tokens' or 'max_completion_tokens' is too large: 4096. This model's maximum context length is 4096 tokens and "
        "your request has 2500 input tokens (4096 > 4096 - 2500).",
    ],
)
def test_the_first_refusal_tells_the_context_and_the_same_request_is_sent_with_what_is_left(
    message: str, server: Server
) -> None:
    server.script = [refused(message)]
    server.prompt_tokens = 2500
    answer = ask(server.provider())
    assert answer.usage.calls == 2
    before, after = (body["max_tokens"] for body in server.bodies)
    assert before == 4096
    assert 256 <= after <= 4096 - 2500


def test_a_refusal_that_leaves_no_room_for_an_answer_is_final(server: Server) -> None:
    server.script = [
        refused("request (9000 tokens) exceeds the available context size (4096 tokens), try increasing it")
    ]
    with pytest.raises(ContextTooLongError) as caught:
        ask(server.provider())
    assert (caught.value.exit_code, caught.value.sent, len(server.bodies)) == (2, True, 1)


def test_words_and_pictures_that_do_not_fit_are_refused_before_they_are_sent(server: Server) -> None:
    server.lists(max_model_len=512)
    with pytest.raises(ContextTooLongError, match="words and pictures alone take about .* context is 512 tokens"):
        ask(server.provider())
    assert server.bodies == []
    # What was never sent is no call, and an answer's cap of calls is left whole.
    budget = Budget(Caps(calls=1))
    for _ in range(2):
        with pytest.raises(ContextTooLongError) as caught:
            asyncio.run(ModelClient(server.provider(), budget=budget).ask(question()))
        assert not caught.value.sent
    assert (budget.spent.calls, budget.spent.pictures, budget.spent.tokens, server.bodies) == (0, 0, 0, [])


def test_the_longest_answer_that_a_service_allows_is_learnt(server: Server) -> None:
    server.script = [refused("max_tokens is too large: 32768. This model supports at most 16384 completion tokens.")]
    ask(server.provider(max_tokens=32768))
    assert [body["max_tokens"] for body in server.bodies] == [32768, 16384]


# -- pictures ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("status", "message"),
    [
        (500, "image input is not supported - hint: if this is unexpected, you may need to provide the mmproj"),
        (400, "At most 0 image(s) may be provided in one prompt."),
        (400, "m is not a multimodal model"),
        (404, "No endpoints found that support image input"),
        (400, "Invalid content type. image_url is only supported by certain models."),
    ],
)
def test_a_model_that_takes_no_pictures_is_named_as_such_and_not_asked_again(
    status: int, message: str, server: Server
) -> None:
    server.script = [refused(message, status)] * 5
    with pytest.raises(NoPicturesError, match="takes no pictures") as caught:
        ask(server.provider())
    assert isinstance(caught.value, RequestRejectedError)
    assert (caught.value.exit_code, len(server.bodies)) == (2, 1)


# -- thinking ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "message", ['"m" does not support thinking', "Unrecognized request argument supplied: chat_template_kwargs"]
)
def test_a_switch_for_thinking_that_is_refused_is_left_out_from_then_on_and_said(message: str, server: Server) -> None:
    server.script = [refused(message)]
    ear, provider = Ear(), server.provider(thinking="high")
    ask(provider, ear)
    ask(provider, ear)
    assert ["chat_template_kwargs" in body for body in server.bodies] == [True, False, False]
    assert sum("does not take --thinking high" in text for text in ear.warnings) == 1


@pytest.mark.parametrize("ollama", [True, False])
def test_ollama_is_told_not_to_think_in_its_own_word(ollama: bool, server: Server) -> None:
    server.lists()
    if ollama:
        server.facts["/api/ps"] = {"models": [{"name": "m", "model": "m", "context_length": 32768}]}
    ask(server.provider(thinking="off"))
    assert server.bodies[0].get("reasoning_effort") == ("none" if ollama else None)


# -- Ollama's silent cut -------------------------------------------------------------------------------------------


def test_the_context_of_an_ollama_is_that_of_the_loaded_model(server: Server) -> None:
    server.lists()
    server.facts["/api/ps"] = {"models": [{"name": "m:latest", "model": "m:latest", "context_length": 8192}]}
    found = server_facts(SERVER, server.url, "m", None)
    assert found == Facts(8192, f"GET {server.url.removesuffix('/v1')}/api/ps", ollama=True)
    server.facts["/api/ps"] = {"models": []}
    assert server_facts(SERVER, server.url, "m", None) == Facts(ollama=True)
    server.facts["/api/show"] = {
        "parameters": "temperature 1\nnum_ctx      16384",
        "model_info": {"q.context_length": 262144},
    }
    assert server_facts(SERVER, server.url, "m", None).context == 16384


def test_a_request_that_ollama_cut_is_refused_with_the_command_that_raises_its_context(server: Server) -> None:
    server.lists()
    server.facts["/api/ps"] = {"models": []}
    server.prompt_tokens = 150
    with pytest.raises(ContextTooLongError, match="dropped part of it") as caught:
        ask(server.provider())
    assert "OLLAMA_CONTEXT_LENGTH=" in str(caught.value)
    assert "ollama serve" in str(caught.value)
    assert caught.value.exit_code == 2


def test_an_ollama_that_fills_its_context_has_cut_the_request(server: Server) -> None:
    """It loads the model for the first request, and says only then how long its context is."""
    server.lists()
    server.facts["/api/ps"] = {"models": []}
    server.prompt_tokens = 4096
    server.on_answer = lambda: server.facts.update({"/api/ps": {"models": [{"model": "m", "context_length": 4096}]}})
    with pytest.raises(ContextTooLongError, match=r"counted 4096 tokens .* its context is 4096 tokens"):
        ask(server.provider())
    assert len(server.bodies) == 1


def test_a_count_that_can_be_true_is_believed(server: Server) -> None:
    server.lists()
    server.prompt_tokens = 2000
    assert ask(server.provider()).usage.tokens_in == 2000


# -- time ----------------------------------------------------------------------------------------------------------


def test_a_timeout_holds_for_each_of_two_tries_and_both_are_booked_in_full(server: Server) -> None:
    server.slow_s = [30.0] * 5
    provider = server.provider(timeout_s=1.5, max_tokens=500)
    client = ModelClient(provider)
    reckoned = provider.estimate(question()).tokens_in
    with pytest.raises(ModelTimeoutError, match=r"within 1\.5 s \(--timeout S"):
        asyncio.run(client.ask(question()))
    assert len(server.bodies) == 2
    spent = client.budget.spent
    assert spent.tokens_out == 2 * 500
    assert spent.tokens_in == 2 * reckoned


def test_without_a_timeout_a_service_that_is_slow_gets_more_time(
    server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wonderful_team.models.providers.settings.TRY_S", 1.0)
    server.slow_s = [1.5, 1.5]
    provider = server.provider()
    # Without an answer in time, the second try waits twice as long.
    ask(provider)
    assert len(server.bodies) == 2
    assert provider.deadline_s > 3.0
    server.slow_s = []
    ask(provider)
    assert len(server.bodies) == 3, "what was learnt holds for the next request"


def test_a_slow_reply_makes_room_for_slower_ones() -> None:
    provider = make_provider("http://127.0.0.1:9/v1#m")
    before = provider.deadline_s
    provider._learned.took(100.0)
    assert provider.deadline_s > 3 * 400.0 > before
    thinking = make_provider("http://127.0.0.1:9/v1#m", thinking="high")
    assert thinking.deadline_s > before
    fixed = make_provider("http://127.0.0.1:9/v1#m", timeout_s=900)
    assert 1800 < fixed.deadline_s < 2000
    hanging = make_provider("http://127.0.0.1:9/v1#m")
    for tried_s in (150, 300, 600, 1200, 2400):
        hanging._learned.too_short(tried_s)
    assert hanging._learned.try_s == 4 * 150, "a service that never answers is not waited for ever longer"


def test_a_lost_try_that_leaves_too_little_names_the_cap_that_holds(server: Server) -> None:
    server.slow_s = [30.0] * 3
    provider = server.provider(timeout_s=0.3)
    tokens = provider.estimate(question()).tokens_in + 1000
    with pytest.raises(BudgetReached, match=f"the cap of {tokens} tokens is reached"):
        ask(provider, budget=Budget(Caps(tokens=tokens)))
    assert len(server.bodies) == 1
