"""Anthropic messages: `POST /v1/messages`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from anthropic.types import message_create_params as plain
from anthropic.types.beta import message_create_params as beta

from tests.servers.check import Misfit, fit
from tests.servers.heard import Heard, Piece, Rejected, Reply, Turn, decode_png, schema_in_words
from tests.servers.schemas import check_anthropic, check_name

DIALECT = "anthropic"
MOST_PICTURES = 100
FINISH = {"stop": "end_turn", "length": "max_tokens", "filter": "refusal", "refusal": "refusal"}
KINDS = {
    400: "invalid_request_error", 401: "authentication_error", 403: "permission_error", 404: "not_found_error",
    413: "request_too_large", 429: "rate_limit_error", 500: "api_error", 529: "overloaded_error",
}  # fmt: skip


def parse(body: Mapping[str, Any], headers: Mapping[str, str], *, local: bool, size: int) -> Heard:
    """Read a request as Anthropic would.

    Raises:
        Rejected: Anthropic would refuse it.
    """
    if "anthropic-version" not in headers:
        raise Rejected(400, "anthropic-version: header is required")
    if "x-api-key" not in headers and "authorization" not in headers:
        raise Rejected(401, "x-api-key header is required")
    _check_types(body)
    _check_settings(body)
    system = body.get("system", "")
    if not isinstance(system, str):
        system = "\n".join(block["text"] for block in system)
    turns = tuple(
        Turn(message["role"], _pieces(message["content"], f"messages.{n}"))
        for n, message in enumerate(body["messages"])
    )
    schema, tool = _schema(body)
    words = "\n".join([system, *(p for turn in turns for p in turn.pieces if isinstance(p, str))])
    heard = Heard(
        DIALECT,
        body["model"],
        system,
        turns,
        schema if schema is not None else schema_in_words(words),
        schema is not None,
        tool,
        bool(body.get("stream")),
        size,
        headers.get("x-api-key", headers.get("authorization", "").removeprefix("Bearer ")),
        body,
    )
    if len(heard.pictures) > MOST_PICTURES:
        raise Rejected(400, f"messages: too many images: {len(heard.pictures)} > {MOST_PICTURES}")
    if any(max(p.shape[:2]) > 8000 for p in heard.pictures):
        raise Rejected(400, "messages: image dimensions exceed max allowed size: 8000 pixels")
    return heard


def _check_types(body: Mapping[str, Any]) -> None:
    streaming = bool(body.get("stream"))
    problems = []
    for module in (plain, beta):
        try:
            fit(
                body,
                module.MessageCreateParamsStreaming if streaming else module.MessageCreateParamsNonStreaming,
                "body",
            )
        except Misfit as error:
            problems.append(str(error))
        else:
            return
    raise Rejected(400, problems[0])


def _check_settings(body: Mapping[str, Any]) -> None:
    if not body["messages"]:
        raise Rejected(400, "messages: at least one message is required")
    if body["messages"][0]["role"] != "user":
        raise Rejected(400, 'messages: first message must use the "user" role')
    if body["max_tokens"] < 1:
        raise Rejected(400, "max_tokens: must be greater than or equal to 1")
    thinking = body.get("thinking") or {"type": "disabled"}
    if thinking["type"] == "enabled":
        if not 1024 <= thinking["budget_tokens"] < body["max_tokens"]:
            raise Rejected(400, "`max_tokens` must be greater than `thinking.budget_tokens`, which is at least 1024")
    if thinking["type"] != "disabled":
        if body.get("temperature", 1) != 1:
            raise Rejected(400, "`temperature` may only be set to 1 when thinking is enabled")
        if body.get("tool_choice", {}).get("type") in ("any", "tool"):
            raise Rejected(400, "Thinking may not be enabled when tool_choice forces tool use.")


def _pieces(content: Any, where: str) -> tuple[Piece, ...]:
    blocks = [{"type": "text", "text": content}] if isinstance(content, str) else content
    pieces: list[Piece] = []
    for index, block in enumerate(blocks):
        match block["type"]:
            case "text":
                if not block["text"].strip():
                    raise Rejected(
                        400, f"{where}.content.{index}: text content blocks must contain non-whitespace text"
                    )
                pieces.append(block["text"])
            case "image":
                if block["source"]["type"] != "base64":
                    raise Rejected(400, f"{where}.content.{index}: this server fetches nothing: send base64")
                pieces.append(decode_png(block["source"]["data"], f"{where}.content.{index}.image.source.base64.data"))
            case "tool_use":
                pieces.append(json.dumps(block["input"]))
            case "tool_result":
                inner = block.get("content", "")
                pieces += [inner] if isinstance(inner, str) else _pieces(inner, f"{where}.content.{index}")
            case "thinking" | "redacted_thinking":
                pass
            case other:
                raise Rejected(400, f"{where}.content.{index}: {other} is not supported by this model")
    return tuple(pieces)


def _schema(body: Mapping[str, Any]) -> tuple[Mapping[str, Any] | None, str]:
    format_ = (body.get("output_config") or {}).get("format") or body.get("output_format")
    if format_:
        check_anthropic(format_["schema"])
        return format_["schema"], ""
    for tool in body.get("tools", ()):
        if "input_schema" in tool:
            check_name(tool["name"], "tools.0.custom.name")
            return tool["input_schema"], tool["name"]
    return None, ""


def render(reply: Reply, heard: Heard) -> dict[str, Any]:
    """The reply as `message`."""
    content: list[dict[str, Any]] = []
    if reply.thinking:
        content.append({"type": "thinking", "thinking": reply.thinking, "signature": "c2lnbmF0dXJl"})
    finish = FINISH[reply.finish]
    if heard.tool and reply.text is not None and reply.finish == "stop":
        content.append({"type": "tool_use", "id": "toolu_1", "name": heard.tool, "input": _tool_input(reply.text)})
        finish = "tool_use"
    elif reply.text:
        content.append({"type": "text", "text": reply.text})
    done: dict[str, Any] = {
        "id": "msg_1",
        "type": "message",
        "role": "assistant",
        "model": heard.model,
        "content": content,
        "stop_reason": finish,
        "stop_sequence": None,
    }
    # The format always has usage: a server that does not count says 0.
    into, cached, thinking, out = reply.usage or (0, 0, 0, 0)
    done["usage"] = {
        "input_tokens": into - cached,
        "cache_creation_input_tokens": 0,
        "cache_read_input_tokens": cached,
        "output_tokens": out + thinking,
    }
    return done


def _tool_input(text: str) -> Any:
    """A tool's input is an object by the format; a text that is none arrives as a wrong object."""
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        return {"value": text[:2000]}
    return value if isinstance(value, dict) else {"value": value}


def emptied(whole: dict[str, Any]) -> dict[str, Any]:
    """A message without content."""
    return {**whole, "content": []}


def stream(reply: Reply, heard: Heard) -> list[bytes]:
    """The reply as server-sent events."""
    whole = render(reply, heard)
    start = {**whole, "content": [], "stop_reason": None}
    events: list[dict[str, Any]] = [{"type": "message_start", "message": start}]
    for index, block in enumerate(whole["content"]):
        empty, delta = _block_parts(block)
        events.append({"type": "content_block_start", "index": index, "content_block": empty})
        events += [{"type": "content_block_delta", "index": index, "delta": item} for item in delta]
        events.append({"type": "content_block_stop", "index": index})
    ending = {"stop_reason": whole["stop_reason"], "stop_sequence": None}
    counted = {"output_tokens": whole["usage"]["output_tokens"]}
    events += [{"type": "message_delta", "delta": ending, "usage": counted}, {"type": "message_stop"}]
    return [f"event: {event['type']}\ndata: {json.dumps(event)}\n\n".encode() for event in events]


def _block_parts(block: Mapping[str, Any]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    match block["type"]:
        case "text":
            return {"type": "text", "text": ""}, [{"type": "text_delta", "text": block["text"]}]
        case "thinking":
            said = [{"type": "thinking_delta", "thinking": block["thinking"]}]
            signed = [{"type": "signature_delta", "signature": block["signature"]}]
            return {"type": "thinking", "thinking": "", "signature": ""}, said + signed
        case _:
            arguments = {"type": "input_json_delta", "partial_json": json.dumps(block["input"])}
            return {**block, "input": {}}, [arguments]


def error(status: int, message: str, code: str = "") -> dict[str, Any]:
    """Anthropic's error body."""
    return {
        "type": "error",
        "error": {"type": KINDS.get(status, "api_error"), "message": message},
        "request_id": "req_1",
    }
