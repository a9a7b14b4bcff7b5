"""The schema of every kind of answer as it goes over the wire to a server named by its address."""

from __future__ import annotations

import asyncio
import importlib
import inspect
import pkgutil

import pytest

from tests.models.providers.asking import question
from tests.models.providers.test_real_servers import Server, server  # noqa: F401  a fixture
from wonderful_team import contracts
from wonderful_team.contracts import AnswerModel
from wonderful_team.models.conventions import CONVENTIONS
from wonderful_team.models.providers import library
from wonderful_team.models.wire.form import Form


def answers() -> dict[str, type[AnswerModel]]:
    """Every kind of answer that a contract defines."""
    found = {}
    for module in pkgutil.iter_modules(contracts.__path__):
        for name, held in inspect.getmembers(importlib.import_module(f"{contracts.__name__}.{module.name}")):
            if inspect.isclass(held) and issubclass(held, AnswerModel) and held is not AnswerModel:
                found[name] = held
    return found


ANSWERS = answers()


def test_the_kinds_of_answers_are_found() -> None:
    assert len(ANSWERS) > 15
    limited = [name for name, kind in ANSWERS.items() if "minLength" in str(kind.model_json_schema())]
    assert limited, "no contract has a limit on text any more: the test below has lost its meaning"


@pytest.mark.parametrize("name", sorted(ANSWERS))
def test_a_server_gets_the_plain_schema(name: str, server: Server) -> None:  # noqa: F811  the fixture
    provider = server.provider()
    form = Form.of(ANSWERS[name], CONVENTIONS["qwen3-vl"])

    async def send() -> None:
        model = await provider._client()
        composed = provider._compose(question())
        messages = library.messages_of(composed, [])
        await library.send(model, messages, provider._settings(100), form.schema, name)
        await provider.aclose()

    asyncio.run(send())
    (body,) = server.bodies
    sent = body["response_format"]
    assert sent["type"] == "json_schema"
    assert sent["json_schema"]["schema"] == form.schema
