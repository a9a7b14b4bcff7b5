"""The servers against the vendors' own clients: what these send is understood, and what they would not send is refused."""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterator
from typing import Any

import anthropic
import httpx2
import numpy as np
import openai
import pytest
from google import genai
from google.genai import types as google_types

from tests.servers.brains import scripted_brain
from tests.servers.server import KEY, Rules, WireServer
from wonderful_team.images import to_png

PNG = to_png(np.full((48, 64, 3), 200, np.uint8))
DATA = base64.b64encode(PNG).decode()
SCHEMA = {"type": "object", "properties": {"a": {"type": "integer"}}, "required": ["a"], "additionalProperties": False}


@pytest.fixture(scope="module")
def server() -> Iterator[WireServer]:
    with WireServer(scripted_brain('{"a": 1}')) as running:
        yield running


def openai_client(server: WireServer, key: str = KEY) -> openai.OpenAI:
    return openai.OpenAI(
        base_url=f"{server.url}/v1", api_key=key, max_retries=0, http_client=httpx2.Client(trust_env=False)
    )


def chat(server: WireServer, key: str = KEY, schema: dict[str, Any] = SCHEMA) -> str | None:
    picture = {"type": "image_url", "image_url": {"url": f"data:image/png;base64,{DATA}"}}
    messages = [
        {"role": "system", "content": "be brief"},
        {"role": "user", "content": [{"type": "text", "text": "hi"}, picture]},
    ]
    form = {"type": "json_schema", "json_schema": {"name": "x", "schema": schema, "strict": True}}
    with openai_client(server, key) as client:
        reply = client.chat.completions.create(model="m", messages=messages, response_format=form)
    return reply.choices[0].message.content


def responses(server: WireServer, key: str = KEY, schema: dict[str, Any] = SCHEMA) -> str:
    picture = {"type": "input_image", "image_url": f"data:image/png;base64,{DATA}", "detail": "high"}
    content = [{"role": "user", "content": [{"type": "input_text", "text": "hi"}, picture]}]
    form = {"format": {"type": "json_schema", "name": "x", "schema": schema, "strict": True}}
    with openai_client(server, key) as client:
        return client.responses.create(model="m", instructions="be brief", input=content, text=form).output_text


def messages(server: WireServer, key: str = KEY, schema: dict[str, Any] = SCHEMA) -> str:
    picture = {"type": "image", "source": {"type": "base64", "media_type": "image/png", "data": DATA}}
    content = [{"role": "user", "content": [{"type": "text", "text": "hi"}, picture]}]
    form = {"format": {"type": "json_schema", "schema": schema}}
    plain = httpx2.Client(trust_env=False)
    with anthropic.Anthropic(base_url=server.url, api_key=key, max_retries=0, http_client=plain) as client:
        ask = {"model": "m", "max_tokens": 50, "system": "be brief", "messages": content, "output_config": form}
        whole = client.messages.create(**ask)
        with client.messages.stream(**ask) as stream:
            streamed = stream.get_final_message()
    assert whole.content[0].text == streamed.content[0].text
    assert whole.usage.input_tokens == streamed.usage.input_tokens
    return whole.content[0].text


def generate(server: WireServer, key: str = KEY, schema: dict[str, Any] = SCHEMA) -> str | None:
    options = google_types.HttpOptions(base_url=server.url, client_args={"trust_env": False})
    config = google_types.GenerateContentConfig(
        system_instruction="be brief", response_mime_type="application/json", response_json_schema=schema
    )
    picture = google_types.Part.from_bytes(data=PNG, mime_type="image/png")
    with genai.Client(api_key=key, http_options=options) as client:
        return client.models.generate_content(model="m", contents=["hi", picture], config=config).text


ASK: dict[str, Callable[..., str | None]] = {
    "chat": chat,
    "responses": responses,
    "messages": messages,
    "generate": generate,
}


@pytest.mark.parametrize("name", ASK)
def test_the_vendors_own_client_is_understood_and_understands(name: str, server: WireServer) -> None:
    assert ASK[name](server) == '{"a": 1}'
    heard = server.heard[-1]
    assert (heard.system, heard.words, heard.secret) == ("be brief", "hi", KEY)
    assert [picture.shape for picture in heard.pictures] == [(48, 64, 3)]
    assert np.all(heard.pictures[0] == 200)
    assert heard.schema == SCHEMA


@pytest.mark.parametrize("name", ASK)
def test_a_wrong_key_is_refused_in_the_vendors_own_words(name: str, server: WireServer) -> None:
    errors = (openai.AuthenticationError, anthropic.AuthenticationError, genai.errors.ClientError)
    with pytest.raises(errors, match="Incorrect API key"):
        ASK[name](server, key="another-key")


@pytest.mark.parametrize(
    ("name", "schema", "says"),
    [
        (
            "chat",
            {"type": "object", "properties": {"a": {"type": "integer"}}, "required": ["a"]},
            "additionalProperties",
        ),
        ("responses", {**SCHEMA, "required": []}, "required"),
        ("messages", {**SCHEMA, "properties": {"a": {"type": "integer", "minimum": 0}}}, "minimum"),
    ],
)
def test_schemas_that_the_vendor_would_refuse_are_refused(
    name: str, schema: dict[str, Any], says: str, server: WireServer
) -> None:
    with pytest.raises((openai.BadRequestError, anthropic.BadRequestError), match=says):
        ASK[name](server, schema=schema)


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("/v1/chat/completions", {"model": "m", "messages": [{"role": "user", "content": "hi"}], "colour": "blue"}),
        ("/v1/chat/completions", {"model": "m", "messages": [{"role": "user", "content": [{"type": "picture"}]}]}),
        ("/v1/responses", {"model": "m", "input": [{"role": "user", "content": [{"type": "input_text"}]}]}),
        ("/v1/messages", {"model": "m", "messages": [{"role": "user", "content": "hi"}]}),
        ("/v1/messages", {"model": "m", "max_tokens": 9, "messages": [{"role": "user", "content": " "}]}),
        ("/v1beta/models/m:generateContent", {"contents": [{"role": "user", "parts": [{"txt": "hi"}]}]}),
        ("/v1beta/models/m:generateContent", {"contents": [{"role": "system", "parts": [{"text": "hi"}]}]}),
    ],
)
def test_bodies_outside_the_vendors_types_get_a_400(path: str, body: dict[str, Any], server: WireServer) -> None:
    headers = {"authorization": f"Bearer {KEY}", "anthropic-version": "2023-06-01", "x-goog-api-key": KEY}
    with httpx2.Client(trust_env=False) as client:
        reply = client.post(f"{server.url}{path}", json=body, headers=headers)
    assert reply.status_code == 400
    assert "error" in reply.json()


def test_models_are_listed_with_their_context() -> None:
    with WireServer(scripted_brain("{}"), Rules(models=("one", "two"), context=4096)) as server:
        with openai_client(server) as client:
            listed = client.models.list().data
    assert [model.id for model in listed] == ["one", "two"]
    assert listed[0].model_extra == {"max_model_len": 4096}
