"""OpenAI chat completions: `POST /v1/chat/completions`; also what vLLM, Ollama and llama.cpp serve."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from openai.types.chat.completion_create_params import (
    CompletionCreateParamsNonStreaming,
    CompletionCreateParamsStreaming,
)

from tests.servers.check import check_body
from tests.servers.heard import Heard, Piece, Rejected, Reply, Turn, picture_of_data_url, schema_in_words
from tests.servers.schemas import check_name, check_openai_strict

DIALECT = "openai"
LOCAL_FIELDS = (
    "chat_template_kwargs", "guided_json", "top_k", "min_p", "repetition_penalty", "mm_processor_kwargs", "think",
    "options", "keep_alive", "reasoning", "cache_prompt", "provider", "include_reasoning", "structured_outputs",
    "usage",
)  # fmt: skip
"""Further body fields that local servers and routers take and OpenAI refuses."""
FINISH = {"stop": "stop", "length": "length", "filter": "content_filter", "refusal": "stop"}


def parse(body: Mapping[str, Any], headers: Mapping[str, str], *, local: bool, size: int) -> Heard:
    """Read a request as OpenAI would (or, with `local`, as a local server would).

    Raises:
        Rejected: OpenAI would refuse it.
    """
    streaming = bool(body.get("stream"))
    checked = {key: value for key, value in body.items() if not (local and key in LOCAL_FIELDS)}
    check_body(checked, CompletionCreateParamsStreaming if streaming else CompletionCreateParamsNonStreaming)
    if not body["messages"]:
        raise Rejected(400, "[] is too short - 'messages'", code="empty_array")
    system, turns = _conversation(body["messages"])
    if local and any(message["role"] == "system" for message in body["messages"][1:]):
        raise Rejected(400, "System message must be at the beginning.", code="BadRequestError")
    schema, native, tool = _schema(body, local)
    words = "\n".join([system, *(p for turn in turns for p in turn.pieces if isinstance(p, str))])
    kind = body.get("response_format", {}).get("type")
    if kind == "json_object" and "json" not in words.lower():
        raise Rejected(400, "'messages' must contain the word 'json' to use 'response_format' of type 'json_object'.")
    return Heard(
        DIALECT,
        body["model"],
        system,
        turns,
        schema if schema is not None else schema_in_words(words),
        native,
        tool,
        streaming,
        size,
        headers.get("authorization", "").removeprefix("Bearer "),
        body,
    )


def _conversation(messages: list[Mapping[str, Any]]) -> tuple[str, tuple[Turn, ...]]:
    system, turns = [], []
    for position, message in enumerate(messages):
        role, content = message["role"], message.get("content")
        pieces = _pieces(content, f"messages[{position}]")
        if role in ("system", "developer"):
            system += [piece for piece in pieces if isinstance(piece, str)]
        elif role == "assistant":
            calls = [call["function"]["arguments"] for call in message.get("tool_calls", ()) if "function" in call]
            turns.append(Turn("assistant", (*pieces, *calls)))
        else:
            turns.append(Turn("user", pieces))
    return "\n".join(system), tuple(turns)


def _pieces(content: Any, where: str) -> tuple[Piece, ...]:
    if content is None:
        return ()
    if isinstance(content, str):
        return (content,)
    pieces: list[Piece] = []
    for index, part in enumerate(content):
        if part["type"] == "text":
            pieces.append(part["text"])
        elif part["type"] == "image_url":
            pieces.append(picture_of_data_url(part["image_url"]["url"], f"{where}.content[{index}].image_url"))
        else:
            raise Rejected(400, f"{where}.content[{index}]: this model takes text and image_url, not {part['type']}")
    return tuple(pieces)


def _schema(body: Mapping[str, Any], local: bool) -> tuple[Mapping[str, Any] | None, bool, str]:
    """Schema, whether it stands where it can be enforced, and the tool to be called."""
    format_ = body.get("response_format", {"type": "text"})
    if format_["type"] == "json_schema":
        named = format_["json_schema"]
        check_name(named["name"], "response_format.json_schema.name")
        if "schema" not in named:
            raise Rejected(400, "Missing required parameter: 'response_format.json_schema.schema'.")
        if named.get("strict") and not local:
            check_openai_strict(named["schema"], named["name"])
        return named["schema"], True, ""
    if local and "guided_json" in body:
        return body["guided_json"], True, ""
    for tool in body.get("tools", ()):
        function = tool["function"]
        check_name(function["name"], "tools[0].function.name")
        if function.get("strict") and not local:
            check_openai_strict(function["parameters"], function["name"])
        return function.get("parameters"), True, function["name"]
    return None, False, ""


def render(reply: Reply, heard: Heard) -> dict[str, Any]:
    """The reply as `chat.completion`."""
    message: dict[str, Any] = {"role": "assistant", "content": reply.text, "refusal": None}
    finish = FINISH[reply.finish]
    if reply.finish == "refusal":
        message |= {"content": None, "refusal": reply.text or "I can't help with that."}
    elif heard.tool and reply.text is not None and reply.finish == "stop":
        call = {"name": heard.tool, "arguments": reply.text}
        message |= {"content": None, "tool_calls": [{"id": "call_1", "type": "function", "function": call}]}
        finish = "tool_calls"
    if reply.thinking:
        message["reasoning_content"] = reply.thinking
    done: dict[str, Any] = {
        "id": "chatcmpl-1",
        "object": "chat.completion",
        "created": 1_700_000_000,
        "model": heard.model,
        "choices": [{"index": 0, "message": message, "finish_reason": finish, "logprobs": None}],
    }
    if reply.usage is not None:
        done["usage"] = _usage(reply.usage)
    return done


def _usage(usage: tuple[int, int, int, int]) -> dict[str, Any]:
    into, cached, thinking, out = usage
    return {
        "prompt_tokens": into,
        "completion_tokens": out + thinking,
        "total_tokens": into + out + thinking,
        "prompt_tokens_details": {"cached_tokens": cached},
        "completion_tokens_details": {"reasoning_tokens": thinking},
    }


def stream(reply: Reply, heard: Heard) -> list[bytes]:
    """The reply as server-sent events."""
    whole = render(reply, heard)
    choice = whole["choices"][0]
    message = choice["message"]
    base = {"id": whole["id"], "object": "chat.completion.chunk", "created": whole["created"], "model": heard.model}
    deltas: list[dict[str, Any]] = [{"role": "assistant", "content": ""}]
    if message.get("tool_calls"):
        deltas.append({"tool_calls": [{"index": 0, **call} for call in message["tool_calls"]]})
    elif message["refusal"]:
        deltas.append({"refusal": message["refusal"]})
    else:
        text = message["content"] or ""
        half = len(text) // 2
        deltas += [{"content": text[:half]}, {"content": text[half:]}]
    chunks = [{**base, "choices": [{"index": 0, "delta": delta, "finish_reason": None}]} for delta in deltas]
    chunks.append({**base, "choices": [{"index": 0, "delta": {}, "finish_reason": choice["finish_reason"]}]})
    if "usage" in whole and (heard.body.get("stream_options") or {}).get("include_usage"):
        chunks.append({**base, "choices": [], "usage": whole["usage"]})
    return [b"data: " + json.dumps(chunk).encode() + b"\n\n" for chunk in chunks] + [b"data: [DONE]\n\n"]


def error(status: int, message: str, code: str = "") -> dict[str, Any]:
    """OpenAI's error body."""
    kind = {401: "invalid_request_error", 429: "requests", 404: "invalid_request_error", 400: "invalid_request_error"}
    return {
        "error": {"message": message, "type": kind.get(status, "server_error"), "param": None, "code": code or None}
    }


def models(names: list[str], context: int | None) -> dict[str, Any]:
    """`GET /v1/models`; vLLM also tells the context length."""
    more = {} if context is None else {"max_model_len": context}
    data = [{"id": name, "object": "model", "created": 1_700_000_000, "owned_by": "here", **more} for name in names]
    return {"object": "list", "data": data}
