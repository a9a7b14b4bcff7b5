"""A key, and how it may be written: what tests search files and terminals for."""

from __future__ import annotations

import base64
import html
import json
import urllib.parse
from collections.abc import Callable
from pathlib import Path

AWKWARD = "wt/Sec+ret\"01<23>&4'56\\x"
"""A key that every coding has to write in another way, of letters that a header may hold."""

CODINGS: dict[str, Callable[[str], str]] = {
    "plain": lambda key: key,
    "upper case": str.upper,
    "json": lambda key: json.dumps(key)[1:-1],
    "json twice": lambda key: json.dumps(json.dumps(key))[1:-1],
    "json in utf-8": lambda key: json.dumps(key, ensure_ascii=False)[1:-1],
    "json with slashes": lambda key: json.dumps(key)[1:-1].replace("/", "\\/"),
    "every letter escaped": lambda key: "".join(f"\\u{ord(letter):04X}" for letter in key),
    "python": lambda key: repr(key)[1:-1],
    "python bytes": lambda key: repr(key.encode())[2:-1],
    "address": lambda key: urllib.parse.quote(key, safe=""),
    "address twice": lambda key: urllib.parse.quote(urllib.parse.quote(key, safe=""), safe=""),
    "html": html.escape,
    "html numbers": lambda key: "".join(f"&#{ord(letter)};" for letter in key),
    "hex": lambda key: key.encode().hex().upper(),
    "base64": lambda key: base64.b64encode(key.encode()).decode(),
    "base64 after one": lambda key: base64.b64encode(b"x" + key.encode() + b"yz").decode(),
    "base64 after two": lambda key: base64.b64encode(b"xx" + key.encode()).decode(),
    "base64 of addresses": lambda key: base64.urlsafe_b64encode(b"user:" + key.encode()).decode(),
    "base64 in json": lambda key: base64.b64encode(key.encode()).decode().replace("/", "\\/"),
}


def told(content: str | bytes, key: str) -> list[str]:
    """The codings in which a key stands in a text or file, in whatever case."""
    held = (content if isinstance(content, bytes) else content.encode("utf-8", "backslashreplace")).lower()
    # What stands round a key in base64 shares letters with it.
    return [name for name, coded in CODINGS.items() if coded(key).lower().encode()[4:-6] in held]


def told_below(folder: Path, key: str) -> dict[str, list[str]]:
    """Files below a folder that hold a key, by name or content, with its codings."""
    found = {path: told(path.read_bytes(), key) for path in folder.rglob("*") if path.is_file()}
    named = {path: told(str(path), key) for path in folder.rglob("*")}
    return {str(path): codings for held in (found, named) for path, codings in held.items() if codings}
