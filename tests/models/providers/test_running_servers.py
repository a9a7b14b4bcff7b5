"""Our client against a real server with random weights behind it: what it takes, what it refuses, and how it says so.

`pytest --runservers` runs it with the servers that WONDERFUL_TEAM_LLAMA_SERVER and WONDERFUL_TEAM_VLLM name (docs/models.md). Random weights say
nothing about answers, so nothing here asks for a right one.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from tools.tiny_model import NAME, write_model

from tests.agents.question_samples import RIVALS, SAMPLES
from tests.models.providers.asking import question, small_scene
from tests.servers.real import KINDS, RealServer, Wanted, serving
from tests.servers.schemas import misfits
from wonderful_team.agents import build_request
from wonderful_team.cli.app import run
from wonderful_team.contracts import Question
from wonderful_team.core.protocols import Event
from wonderful_team.core.values import Answer, Request
from wonderful_team.errors import (
    ContextTooLongError,
    ModelAuthError,
    ModelCutOffError,
    ModelOutputError,
    NoPicturesError,
    UnknownModelError,
)
from wonderful_team.images import to_png
from wonderful_team.models.client import ModelClient
from wonderful_team.models.providers import make_provider
from wonderful_team.models.providers.facts import UNKNOWN
from wonderful_team.models.providers.listing import server_models
from wonderful_team.models.providers.server_facts import server_facts
from wonderful_team.models.providers.vendors import SERVER

pytestmark = [pytest.mark.servers, pytest.mark.enable_socket, pytest.mark.timeout(1800)]

PATIENT_S = 300.0
"""For one reply, on a busy machine."""
Start = Callable[[Wanted], RealServer]
LONG, SHORT, SHORTER = Wanted(), Wanted(context=8192, key="right-key-for-tests"), Wanted(context=1024)
BLIND = Wanted(pictures=False)


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("weights")
    write_model(folder, seed=0)
    return folder


@pytest.fixture(scope="module", params=sorted(KINDS))
def start(request: pytest.FixtureRequest, weights: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Start]:
    """Starts this kind of server; a test that wants another form of it ends the one before."""
    kind = KINDS[request.param]
    if not kind.program:
        pytest.skip(f"{kind.variable} names no {request.param}")
    running: list[tuple[Wanted, RealServer]] = []
    with ExitStack() as stack:

        def started(wanted: Wanted) -> RealServer:
            if not running or running[0][0] != wanted:
                # One at a time: each holds a model and its memory.
                stack.close()
                folder = tmp_path_factory.mktemp(request.param)
                running[:] = [(wanted, stack.enter_context(serving(kind, weights, folder, wanted)))]
            return running[0][1]

        yield started


@pytest.fixture
def server(start: Start) -> RealServer:
    return start(LONG)


def provider(server: RealServer, **options: Any) -> Any:
    return make_provider(server.spec, **({"timeout_s": PATIENT_S, "first_wait_s": 0.1} | options))


class Ear:
    """Keeps what a client tells."""

    def __init__(self) -> None:
        self.warnings: list[str] = []

    def on_event(self, event: Event) -> None:
        if event.kind == "warning":
            self.warnings.append(str(event.content))


def answered(model: Any, request: Request, tries: int = 4) -> Answer:
    """One whole answer, whatever it says: random words may take long to end."""
    for sample in range(tries):
        try:
            return asyncio.run(model.answer(request))
        except ModelCutOffError:
            if sample == tries - 1:
                raise
    raise AssertionError


# -- what it says of itself ----------------------------------------------------------------------------------------


def test_it_lists_its_model_and_says_how_long_its_context_is(server: RealServer) -> None:
    assert server_models(server.url, None, timeout_s=30.0) == [NAME]
    assert server_facts(SERVER, server.url, NAME, None, timeout_s=30.0).context == LONG.context
    assert make_provider(server.url).model == NAME, "an address alone is enough where there is one model"


# -- requests with pictures ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("asked", SAMPLES, ids=lambda asked: asked.contract)
def test_it_takes_the_words_pictures_and_schema_of_every_question_and_keeps_to_the_schema(
    asked: Question, server: RealServer
) -> None:
    model = provider(server)
    request = build_request(asked, id=f"0/{asked.contract}", stage="plan", role=RIVALS.get(asked.contract))
    answer = answered(model, request)
    assert not model.schemas_refused
    assert model.picture_limit is None, "all pictures were taken"
    assert answer.usage.tokens_in > 0
    # vLLM's grammar lets control characters into texts; our client reads them.
    assert misfits(json.loads(answer.raw, strict=False), model._compose(request).form.schema) == []


def test_an_answer_that_does_not_fit_goes_back_and_ends_as_the_models_failure_or_an_answer(server: RealServer) -> None:
    client = ModelClient(provider(server))
    try:
        answer = asyncio.run(client.ask(question()))
    except ModelOutputError:
        assert client.budget.spent.calls >= 1
    else:
        assert answer.value.targets


@pytest.mark.parametrize("thinking", ["off", "low"])
def test_the_switch_for_thinking_is_taken_or_left_out(thinking: Any, server: RealServer) -> None:
    assert answered(provider(server, thinking=thinking), question()).raw


# -- commands ------------------------------------------------------------------------------------------------------


def test_plans_boxes_and_trials_end_with_a_result_or_an_error_that_says_whose_fault_it_is(
    server: RealServer, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    photo = tmp_path / "desk.png"
    photo.write_bytes(to_png(small_scene(640, 480).rgb))
    asked = (
        ["plan", str(photo), "put the red cube into the free corner"],
        ["plan", str(photo), "put the red cube into the free corner", "--method", "team:paper"],
        ["ground", str(photo), "red cube", "blue square"],
        ["run", "tabletop/rotate", "--seed", "3"],
    )
    for command in asked:
        words = [
            *command,
            "--model",
            server.spec,
            "--max-tokens",
            "400000",
            "--max-calls",
            "30",
            "--max-seconds",
            "300",
        ]
        code = run([*words, "--cache", "off", "--json"])
        document = json.loads(capsys.readouterr().out)
        assert code in (0, 1, 5, 7), document
        assert document["exit_code"] == code


def test_a_probe_of_noise_finds_no_convention_and_keeps_no_profile(
    server: RealServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("WONDERFUL_TEAM_CONFIG", str(tmp_path))
    words = ["probe", server.spec, "--save", "noise", "--max-calls", "40", "--max-seconds", "300", "--allow-unpriced"]
    code = run([*words, "--most-pictures", "4"])
    told = capsys.readouterr()
    assert code in (1, 5), told.err
    assert not list(tmp_path.rglob("*.json"))


def test_a_name_that_the_server_does_not_have_is_an_unknown_model_or_taken_for_its_own(server: RealServer) -> None:
    """llama.cpp answers with the model it has, whatever it is called."""
    model = make_provider(f"{server.url}#another", timeout_s=PATIENT_S)
    with contextlib.suppress(UnknownModelError):
        assert answered(model, question()).raw


# -- lengths, keys, pictures -----------------------------------------------------------------------------------------


def test_the_answers_limit_fits_a_short_context(start: Start) -> None:
    model, ear = provider(start(SHORT), api_key=SHORT.key, max_tokens=8192), Ear()
    client = ModelClient(model, subscribers=(ear,))
    for _ in range(2):
        try:
            asyncio.run(client.ask(question()))
        except ModelOutputError:
            pass
    assert client.budget.spent.calls >= 2, "nothing was refused for its length"
    assert [text for text in ear.warnings if f"context is {SHORT.context} tokens" in text]


def test_many_questions_at_once_are_all_answered(start: Start) -> None:
    """Together they are longer than the context, which llama.cpp's requests share."""
    model = provider(start(SHORT), api_key=SHORT.key)

    async def ask() -> list[Any]:
        asked = (model.answer(question(f"0/ground/{name}/ReadScene/1")) for name in "abcdefgh")
        return await asyncio.gather(*asked, return_exceptions=True)

    outcomes = asyncio.run(ask())
    assert len(outcomes) == 8
    assert [outcome for outcome in outcomes if not isinstance(outcome, Answer | ModelCutOffError)] == []


def test_a_missing_and_a_wrong_key_are_named_as_such(start: Start) -> None:
    server = start(SHORT)
    with pytest.raises(ModelAuthError, match="wants a key, and none was sent"):
        asyncio.run(provider(server).answer(question()))
    with pytest.raises(ModelAuthError, match="refused the key"):
        asyncio.run(provider(server, api_key="wrong-key-for-tests").answer(question()))
    assert answered(provider(server, api_key=SHORT.key), question()).raw


@pytest.mark.parametrize("told", [True, False], ids=["told before", "learnt from the refusal"])
def test_a_request_that_is_too_long_is_named_as_such(told: bool, start: Start) -> None:
    model = provider(start(SHORTER))
    if not told:
        model._learned.know(UNKNOWN)
    with pytest.raises(ContextTooLongError, match=rf"\b{SHORTER.context}\b") as caught:
        asyncio.run(model.answer(question()))
    assert caught.value.exit_code == 2


def test_a_model_that_takes_no_pictures_is_named_as_such(start: Start) -> None:
    with pytest.raises(NoPicturesError) as caught:
        asyncio.run(provider(start(BLIND)).answer(question()))
    assert caught.value.exit_code == 2
