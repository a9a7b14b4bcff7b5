"""OpenAI responses: `POST /v1/responses`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from openai.types.responses.response_create_params import (
    ResponseCreateParamsNonStreaming,
    ResponseCreateParamsStreaming,
)

from tests.servers import openai_chat
from tests.servers.check import check_body
from tests.servers.heard import Heard, Piece, Rejected, Reply, Turn, picture_of_data_url, schema_in_words
from tests.servers.schemas import check_name, check_openai_strict

DIALECT = "responses"
error = openai_chat.error


def parse(body: Mapping[str, Any], headers: Mapping[str, str], *, local: bool, size: int) -> Heard:
    """Read a request as OpenAI would.

    Raises:
        Rejected: OpenAI would refuse it.
    """
    streaming = bool(body.get("stream"))
    check_body(body, ResponseCreateParamsStreaming if streaming else ResponseCreateParamsNonStreaming)
    for needed in ("model", "input"):
        if needed not in body:
            raise Rejected(400, f"Missing required parameter: '{needed}'.", code="missing_required_parameter")
    system = [body["instructions"]] if body.get("instructions") else []
    turns = []
    items = body["input"] if isinstance(body["input"], list) else [{"role": "user", "content": body["input"]}]
    for position, item in enumerate(items):
        role, pieces = _item(item, f"input[{position}]")
        if role in ("system", "developer"):
            system += [piece for piece in pieces if isinstance(piece, str)]
        elif pieces:
            turns.append(Turn("assistant" if role == "assistant" else "user", pieces))
    schema, tool = _schema(body)
    words = "\n".join([*system, *(p for turn in turns for p in turn.pieces if isinstance(p, str))])
    return Heard(
        DIALECT,
        body["model"],
        "\n".join(system),
        tuple(turns),
        schema if schema is not None else schema_in_words(words),
        schema is not None,
        tool,
        streaming,
        size,
        headers.get("authorization", "").removeprefix("Bearer "),
        body,
    )


def _item(item: Mapping[str, Any], where: str) -> tuple[str, tuple[Piece, ...]]:
    kind = item.get("type", "message")
    if kind == "function_call":
        return "assistant", (item["arguments"],)
    if kind == "function_call_output":
        return "user", (item["output"],) if isinstance(item["output"], str) else ()
    if kind != "message":
        return "assistant", ()
    content = item["content"]
    if isinstance(content, str):
        return item["role"], (content,)
    pieces: list[Piece] = []
    for index, part in enumerate(content):
        if part["type"] in ("input_text", "output_text"):
            pieces.append(part["text"])
        elif part["type"] == "input_image":
            if not part.get("image_url"):
                raise Rejected(400, f"{where}.content[{index}]: expected an image_url")
            pieces.append(picture_of_data_url(part["image_url"], f"{where}.content[{index}].image_url"))
        else:
            raise Rejected(400, f"{where}.content[{index}]: this model takes text and pictures, not {part['type']}")
    return item["role"], tuple(pieces)


def _schema(body: Mapping[str, Any]) -> tuple[Mapping[str, Any] | None, str]:
    format_ = body.get("text", {}).get("format") or {"type": "text"}
    if format_["type"] == "json_schema":
        check_name(format_["name"], "text.format.name")
        if format_.get("strict"):
            check_openai_strict(format_["schema"], format_["name"])
        return format_["schema"], ""
    for tool in body.get("tools", ()):
        if tool["type"] == "function":
            check_name(tool["name"], "tools[0].name")
            if tool.get("strict"):
                check_openai_strict(tool["parameters"], tool["name"])
            return tool["parameters"], tool["name"]
    return None, ""


def render(reply: Reply, heard: Heard) -> dict[str, Any]:
    """The reply as `response`."""
    output: list[dict[str, Any]] = []
    if reply.thinking:
        summary = [{"type": "summary_text", "text": reply.thinking}]
        output.append({"type": "reasoning", "id": "rs_1", "summary": summary, "status": "completed"})
    whole = reply.finish in ("stop", "refusal")
    if heard.tool and reply.text is not None and reply.finish == "stop":
        call = {"type": "function_call", "id": "fc_1", "call_id": "call_1", "name": heard.tool}
        output.append({**call, "arguments": reply.text, "status": "completed"})
    elif reply.text is not None:
        if reply.finish == "refusal":
            part: dict[str, Any] = {"type": "refusal", "refusal": reply.text}
        else:
            part = {"type": "output_text", "text": reply.text, "annotations": [], "logprobs": []}
        status = "completed" if whole else "incomplete"
        output.append({"type": "message", "id": "msg_1", "role": "assistant", "status": status, "content": [part]})
    done: dict[str, Any] = {
        "id": "resp_1",
        "object": "response",
        "created_at": 1_700_000_000,
        "status": "completed" if whole else "incomplete",
        "error": None,
        "incomplete_details": None,
        "instructions": None,
        "metadata": {},
        "model": heard.model,
        "output": output,
        "parallel_tool_calls": True,
        "temperature": 1.0,
        "tool_choice": "auto",
        "tools": [],
        "top_p": 1.0,
    }
    if not whole:
        done["incomplete_details"] = {"reason": "max_output_tokens" if reply.finish == "length" else "content_filter"}
    if reply.usage is not None:
        into, cached, thinking, out = reply.usage
        done["usage"] = {
            "input_tokens": into,
            "input_tokens_details": {"cached_tokens": cached, "cache_write_tokens": 0},
            "output_tokens": out + thinking,
            "output_tokens_details": {"reasoning_tokens": thinking},
            "total_tokens": into + out + thinking,
        }
    return done


def emptied(whole: dict[str, Any]) -> dict[str, Any]:
    """A response without any output."""
    return {**whole, "output": []}


def stream(reply: Reply, heard: Heard) -> list[bytes]:
    """The reply as server-sent events: each output item whole, then the response."""
    whole = render(reply, heard)
    begun = {**whole, "status": "in_progress", "output": []}
    begun.pop("usage", None)
    events: list[dict[str, Any]] = [{"type": "response.created", "response": begun}]
    for index, item in enumerate(whole["output"]):
        events.append({"type": "response.output_item.added", "output_index": index, "item": item})
        for part in item.get("content", ()):
            at = {"item_id": item["id"], "output_index": index, "content_index": 0}
            events.append({"type": "response.content_part.added", **at, "part": part})
            if part["type"] == "output_text":
                events.append({"type": "response.output_text.delta", **at, "delta": part["text"], "logprobs": []})
        events.append({"type": "response.output_item.done", "output_index": index, "item": item})
    ending = "response.completed" if whole["status"] == "completed" else "response.incomplete"
    events.append({"type": ending, "response": whole})
    return [
        f"event: {event['type']}\ndata: {json.dumps({**event, 'sequence_number': number})}\n\n".encode()
        for number, event in enumerate(events)
    ]
