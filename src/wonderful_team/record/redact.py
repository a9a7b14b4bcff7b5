"""No secret reaches a file: whatever looks like a key is replaced before text is written."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from typing import Any

HIDDEN = "[redacted]"
_PATTERNS = (
    re.compile(r"\b(?:sk|pk|rk)-[A-Za-z0-9_\-]{8,}"),
    re.compile(r"\bAIza[0-9A-Za-z_\-]{10,}"),
    re.compile(r"\b(?:gh[pousr]_|github_pat_|hf_|xox[baprs]-|gsk_|AKIA)[A-Za-z0-9_\-]{10,}"),
    re.compile(r"\beyJ[A-Za-z0-9_\-]{8,}\.[A-Za-z0-9_\-]{8,}\.[A-Za-z0-9_\-]*"),
)
_AFTER_NAME = re.compile(
    r"""(?ix)
    (\b(?:bearer|basic)\s+                                                       # an Authorization header
    |(?:\b|_)(?:x-)?(?:api[_-]?key|access[_-]?token|auth[_-]?token|client[_-]?secret|password)\\?["']?\s*[:=]\s*\\?["']?  # name: value
    |[?&](?:key|token|api_key)=                                                  # part of an address
    |://[^/\s:@"']+:(?=[^/\s@"']+@))                                             # user:password@host
    ([A-Za-z0-9_\-./+~%]{6,}=*)
    """
)
_SECRET_VARIABLE = re.compile(r"(?i)(api_?key|token|secret|password)$")


def redact(text: str, secrets: tuple[str, ...] = ()) -> str:
    """The text with everything that looks like a key, and every named secret, replaced."""
    for secret in secrets:
        text = text.replace(secret, HIDDEN)
    for pattern in _PATTERNS:
        text = pattern.sub(HIDDEN, text)
    return _AFTER_NAME.sub(lambda match: match.group(1) + HIDDEN, text)


def redact_all(value: Any, secrets: tuple[str, ...] = ()) -> Any:
    """A copy of a JSON value with every text in it redacted; picture data (key "png") is left as it is."""
    match value:
        case str():
            return redact(value, secrets)
        case Mapping():
            return {
                redact(str(key), secrets): item if key == "png" else redact_all(item, secrets)
                for key, item in value.items()
            }
        case list() | tuple():
            return [redact_all(item, secrets) for item in value]
    return value


def secrets_of_environment() -> tuple[str, ...]:
    """Values of environment variables whose names say that they are secret, of eight characters and more."""
    return tuple(
        value for name, value in os.environ.items() if _SECRET_VARIABLE.search(name) and len(value.strip()) >= 8
    )
