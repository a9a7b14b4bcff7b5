"""Google generateContent: `POST /v1beta/models/MODEL:generateContent`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from google.genai import types
from pydantic import ValidationError

from tests.servers.heard import Heard, Piece, Rejected, Reply, Turn, decode_png, schema_in_words

DIALECT = "google"
BAD_KEY = (400, "API_KEY_INVALID")
FINISH = {"stop": "STOP", "length": "MAX_TOKENS", "filter": "SAFETY", "refusal": "PROHIBITED_CONTENT"}
STATES = {
    400: "INVALID_ARGUMENT", 401: "UNAUTHENTICATED", 403: "PERMISSION_DENIED", 404: "NOT_FOUND",
    429: "RESOURCE_EXHAUSTED", 500: "INTERNAL", 502: "UNAVAILABLE", 503: "UNAVAILABLE", 529: "UNAVAILABLE",
}  # fmt: skip
_FIELDS: dict[str, Any] = {
    "systemInstruction": types.Content,
    "generationConfig": types.GenerationConfig,
    "toolConfig": types.ToolConfig,
}
_LISTS: dict[str, Any] = {"contents": types.Content, "tools": types.Tool, "safetySettings": types.SafetySetting}
_STUB = "AAAA"


def parse(body: Mapping[str, Any], headers: Mapping[str, str], *, local: bool, size: int) -> Heard:
    """Read a request as Google would; `model` and `stream` come from the path.

    Raises:
        Rejected: Google would refuse it.
    """
    sent = {_camel(key): _camel_keys(value) for key, value in body.items() if key not in ("model", "stream")}
    for name, value in sent.items():
        _check_field(name, value)
    if not sent.get("contents"):
        raise Rejected(400, "* GenerateContentRequest.contents: contents is not specified")
    turns = tuple(_turn(content, f"contents[{n}]") for n, content in enumerate(sent["contents"]))
    if turns[-1].role != "user":
        raise Rejected(400, "Please ensure that the last turn is a user turn.")
    system = "\n".join(part.get("text", "") for part in sent.get("systemInstruction", {}).get("parts", ()))
    schema, tool = _schema(sent)
    words = "\n".join([system, *(p for turn in turns for p in turn.pieces if isinstance(p, str))])
    return Heard(
        DIALECT,
        body["model"],
        system,
        turns,
        schema if schema is not None else schema_in_words(words),
        schema is not None,
        tool,
        body["stream"],
        size,
        headers.get("x-goog-api-key", ""),
        sent,
    )


def _camel(name: str) -> str:
    """Google's servers take every name in both spellings: mime_type is mimeType."""
    first, *rest = name.split("_")
    return first + "".join(word[:1].upper() + word[1:] for word in rest)


def _camel_keys(item: Any) -> Any:
    if isinstance(item, Mapping):
        return {
            _camel(key): v if _camel(key) in (*_SCHEMAS, "args", "response") else _camel_keys(v)
            for key, v in item.items()
        }
    return [_camel_keys(part) for part in item] if isinstance(item, list) else item


def _check_field(name: str, value: Any) -> None:
    if name in ("cachedContent", "labels", "serviceTier"):
        return
    if name not in _FIELDS and name not in _LISTS:
        raise Rejected(400, f'Invalid JSON payload received. Unknown name "{name}": Cannot find field.')
    items = value if name in _LISTS else [value]
    if not isinstance(items, list):
        raise Rejected(400, f"Invalid value at '{name}': expected a list")
    for item in items:
        try:
            (_LISTS.get(name) or _FIELDS[name]).model_validate(_without_bytes(item))
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            place = ".".join(map(str, (name, *first["loc"])))
            raise Rejected(400, f"Invalid JSON payload received at '{place}': {first['msg']}") from error


def _without_bytes(item: Any) -> Any:
    """The same JSON with picture data cut short: it is decoded apart."""
    if isinstance(item, Mapping):
        return {
            key: inner if key in _SCHEMAS else _STUB if key == "data" else _without_bytes(inner)
            for key, inner in item.items()
        }
    return [_without_bytes(part) for part in item] if isinstance(item, list) else item


_SCHEMAS = ("responseJsonSchema", "responseSchema", "parametersJsonSchema", "parameters")


def _turn(content: Mapping[str, Any], where: str) -> Turn:
    role = content.get("role", "user")
    if role not in ("user", "model"):
        raise Rejected(400, f"Please use a valid role: user, model. {where} has {role!r}.")
    pieces: list[Piece] = []
    if not content.get("parts"):
        raise Rejected(400, f"* GenerateContentRequest.{where}.parts: contents.parts must not be empty.")
    for index, part in enumerate(content["parts"]):
        if part.get("thought"):
            continue
        if "text" in part:
            pieces.append(part["text"])
        elif "inlineData" in part:
            if not str(part["inlineData"].get("mimeType", "")).startswith("image/"):
                raise Rejected(400, f"Unsupported MIME type: {part['inlineData'].get('mimeType')}")
            pieces.append(
                decode_png(part["inlineData"]["data"].replace("-", "+").replace("_", "/"), f"{where}.parts[{index}]")
            )
        elif "functionCall" in part:
            pieces.append(json.dumps(part["functionCall"].get("args", {})))
        elif "functionResponse" in part:
            pieces.append(json.dumps(part["functionResponse"].get("response", {}), ensure_ascii=False))
        else:
            raise Rejected(
                400, f"{where}.parts[{index}].data: required oneof field 'data' must have one initialized field"
            )
    return Turn("assistant" if role == "model" else "user", tuple(pieces))


def _schema(body: Mapping[str, Any]) -> tuple[Mapping[str, Any] | None, str]:
    config = body.get("generationConfig", {})
    schema = config.get("responseJsonSchema") or config.get("responseSchema")
    if schema is not None:
        if config.get("responseMimeType") != "application/json":
            raise Rejected(400, "responseSchema requires responseMimeType application/json")
        return _json_schema(schema), ""
    for tool in body.get("tools", ()):
        for function in tool.get("functionDeclarations", ()):
            found = function.get("parametersJsonSchema") or function.get("parameters")
            return (None if found is None else _json_schema(found)), function["name"]
    return None, ""


def _json_schema(schema: Any) -> Any:
    """Google's own schema words as JSON schema: types in capitals, `nullable`."""
    if isinstance(schema, list):
        return [_json_schema(item) for item in schema]
    if not isinstance(schema, Mapping):
        return schema
    made = {key: _json_schema(item) for key, item in schema.items()}
    if isinstance(made.get("type"), str):
        made["type"] = made["type"].lower()
    if made.pop("nullable", False):
        return {"anyOf": [made, {"type": "null"}]}
    return made


def render(reply: Reply, heard: Heard) -> dict[str, Any]:
    """The reply as `GenerateContentResponse`."""
    parts: list[dict[str, Any]] = []
    if reply.thinking:
        parts.append({"text": reply.thinking, "thought": True})
    if heard.tool and reply.text is not None and reply.finish == "stop":
        try:
            arguments = json.loads(reply.text)
        except (ValueError, RecursionError):
            arguments = {"value": reply.text[:2000]}
        parts.append(
            {
                "functionCall": {
                    "name": heard.tool,
                    "args": arguments if isinstance(arguments, dict) else {"value": arguments},
                }
            }
        )
    elif reply.text is not None and reply.finish in ("stop", "length"):
        parts.append({"text": reply.text})
    candidate: dict[str, Any] = {"finishReason": FINISH[reply.finish], "index": 0}
    if parts:
        candidate["content"] = {"role": "model", "parts": parts}
    done: dict[str, Any] = {"candidates": [candidate], "modelVersion": heard.model, "responseId": "resp-1"}
    if reply.finish == "filter":
        done = {**done, "candidates": [], "promptFeedback": {"blockReason": "SAFETY"}}
    if reply.usage is not None:
        into, cached, thinking, out = reply.usage
        done["usageMetadata"] = {
            "promptTokenCount": into,
            "cachedContentTokenCount": cached,
            "thoughtsTokenCount": thinking,
            "candidatesTokenCount": out,
            "totalTokenCount": into + thinking + out,
        }
    return done


def emptied(whole: dict[str, Any]) -> dict[str, Any]:
    """A response without candidates."""
    return {**whole, "candidates": []}


def stream(reply: Reply, heard: Heard) -> list[bytes]:
    """The reply as one server-sent event."""
    return [b"data: " + json.dumps(render(reply, heard)).encode() + b"\r\n\r\n"]


def error(status: int, message: str, code: str = "") -> dict[str, Any]:
    """Google's error body."""
    made: dict[str, Any] = {"code": status, "message": message, "status": STATES.get(status, "UNKNOWN")}
    if code == BAD_KEY[1]:
        info = {"@type": "type.googleapis.com/google.rpc.ErrorInfo", "reason": code, "domain": "googleapis.com"}
        made["details"] = [info]
    return {"error": made}
