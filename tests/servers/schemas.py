"""What the vendors take as the schema of an answer, from their published limits."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from tests.servers.heard import Rejected

_HOLDERS = ("properties", "$defs", "definitions")
OPENAI_STRICT_REFUSED = (
    "allOf", "oneOf", "not", "dependentRequired", "dependentSchemas", "if", "then", "else", "patternProperties",
    "prefixItems", "unevaluatedProperties", "unevaluatedItems", "propertyNames", "minProperties", "maxProperties",
    "contains", "minContains", "maxContains", "uniqueItems", "default",
)  # fmt: skip
"""Lengths of strings and lists are taken (for OpenAI's own service, so the client library)."""
ANTHROPIC_REFUSED = (
    "minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum", "multipleOf", "minLength", "maxLength", "maxItems",
    "uniqueItems", "prefixItems", "oneOf", "not", "if", "then", "else", "patternProperties", "minProperties",
    "maxProperties",
)  # fmt: skip


def nodes(schema: Any, path: str = "schema") -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Every schema inside a schema, with its place; names of properties are no schemas."""
    if isinstance(schema, list):
        for index, item in enumerate(schema):
            yield from nodes(item, f"{path}[{index}]")
    if not isinstance(schema, Mapping):
        return
    yield path, schema
    for key, item in schema.items():
        if key in _HOLDERS and isinstance(item, Mapping):
            for name, inner in item.items():
                yield from nodes(inner, f"{path}.{key}.{name}")
        elif key in ("items", "additionalProperties", "anyOf", "oneOf", "allOf", "not", "prefixItems"):
            yield from nodes(item, f"{path}.{key}")


def check_openai_strict(schema: Mapping[str, Any], name: str) -> None:
    """What OpenAI demands of a schema with `strict: true`."""

    def refuse(where: str, why: str) -> Rejected:
        return Rejected(400, f"Invalid schema for {name!r}: In context={where}, {why}.", code="invalid_json_schema")

    if schema.get("type") != "object":
        raise refuse("()", f"schema must be a JSON Schema of 'type: \"object\"', got {schema.get('type')!r}")
    for where, node in nodes(schema):
        for word in OPENAI_STRICT_REFUSED:
            if word in node:
                raise refuse(where, f"{word!r} is not permitted")
        if "properties" in node or node.get("type") == "object":
            if node.get("additionalProperties") is not False:
                raise refuse(where, "'additionalProperties' is required to be supplied and to be false")
            missing = set(node.get("properties", {})) - set(node.get("required", ()))
            if missing:
                raise refuse(where, f"'required' is required to include every key in properties; missing {missing}")
        if node.get("type") == "array" and "items" not in node:
            raise refuse(where, "array schema missing items")
        if "$ref" not in node and not {"type", "anyOf", "enum", "const"} & set(node):
            raise refuse(where, "schema must have a 'type' key")


def check_anthropic(schema: Mapping[str, Any]) -> None:
    """What Anthropic demands of `output_config.format.schema`."""
    for where, node in nodes(schema):
        for word in ANTHROPIC_REFUSED:
            if word in node:
                raise Rejected(400, f"output_config.format.schema: {where}: '{word}' is not supported")
        if (node.get("type") == "object" or "properties" in node) and node.get("additionalProperties") is not False:
            raise Rejected(400, f"output_config.format.schema: {where}: 'additionalProperties' must be false")
        if node.get("minItems", 0) not in (0, 1):
            raise Rejected(400, f"output_config.format.schema: {where}: 'minItems' must be 0 or 1")
        if str(node.get("$ref", "#")).startswith("#") is False:
            raise Rejected(400, f"output_config.format.schema: {where}: external $ref is not supported")


def check_name(name: str, what: str) -> None:
    """Names of tools and schemas."""
    if not re.fullmatch(r"[a-zA-Z0-9_-]{1,64}", name):
        raise Rejected(400, f"{what}: {name!r} does not match '^[a-zA-Z0-9_-]{{1,64}}$'", code="invalid_value")


_TYPES: Mapping[str, type | tuple[type, ...]] = {
    "object": dict, "array": list, "string": str, "boolean": bool, "null": type(None), "number": (int, float), "integer": int,
}  # fmt: skip
_BOUNDS: tuple[tuple[str, Callable[[Any, Any], bool]], ...] = (
    ("minLength", lambda value, bound: isinstance(value, str) and len(value) < bound),
    ("maxLength", lambda value, bound: isinstance(value, str) and len(value) > bound),
    ("minItems", lambda value, bound: isinstance(value, list) and len(value) < bound),
    ("maxItems", lambda value, bound: isinstance(value, list) and len(value) > bound),
    ("minimum", lambda value, bound: isinstance(value, int | float) and value < bound),
    ("maximum", lambda value, bound: isinstance(value, int | float) and value > bound),
    ("exclusiveMinimum", lambda value, bound: isinstance(value, int | float) and value <= bound),
    ("exclusiveMaximum", lambda value, bound: isinstance(value, int | float) and value >= bound),
    ("enum", lambda value, bound: value not in bound),
    ("const", lambda value, bound: value != bound),
)


def misfits(
    value: Any, schema: Mapping[str, Any], where: str = "answer", root: Mapping[str, Any] | None = None
) -> list[str]:
    """Where a value breaks a JSON schema, by the words that ours use."""
    root = schema if root is None else root
    if "$ref" in schema:
        return misfits(value, root["$defs"][schema["$ref"].rpartition("/")[2]], where, root)
    for word in ("anyOf", "oneOf"):
        if word in schema:
            tried = [misfits(value, option, where, root) for option in schema[word]]
            return [] if [] in tried else min(tried, key=len)
    wanted = schema.get("type")
    kind = _TYPES.get(wanted, object) if isinstance(wanted, str) else object
    if not isinstance(value, kind) or (isinstance(value, bool) and wanted in ("integer", "number")):
        return [f"{where}: {value!r} is no {wanted}"]
    found = [
        f"{where}: {value!r} breaks {word} {schema[word]}"
        for word, broken in _BOUNDS
        if word in schema and broken(value, schema[word])
    ]
    if isinstance(value, list):
        for index, item in enumerate(value):
            found += misfits(item, schema.get("items", {}), f"{where}[{index}]", root)
    if isinstance(value, dict):
        properties = schema.get("properties", {})
        found += [f"{where}: {name} is missing" for name in schema.get("required", ()) if name not in value]
        for name, item in value.items():
            if name in properties:
                found += misfits(item, properties[name], f"{where}.{name}", root)
            elif schema.get("additionalProperties") is False:
                found.append(f"{where}: {name} is not asked for")
    return found
