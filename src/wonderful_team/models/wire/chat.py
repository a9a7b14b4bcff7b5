"""A request as chat messages, for people who wrap a model of their own: `request.messages()`."""

from __future__ import annotations

import base64
import json
from typing import Any

from wonderful_team.core.values import Request, Words
from wonderful_team.errors import ConfigError
from wonderful_team.images.drawn import drawn_png

PICTURES = ("data_url", "png")


def chat_messages(request: Request, pictures: str = "data_url") -> list[dict[str, Any]]:
    """The request's words and drawn pictures, in order, with the JSON schema of a right answer; see `Request.messages`."""
    if pictures not in PICTURES:
        raise ConfigError(f"messages: pictures {pictures!r}; valid: {', '.join(PICTURES)}")
    content: list[dict[str, Any]] = []
    for part in request.parts:
        if isinstance(part, Words):
            content.append({"type": "text", "text": part.text})
            continue
        png = drawn_png(part)
        if pictures == "png":
            content.append({"type": "image", "media_type": "image/png", "data": png})
        else:
            url = f"data:image/png;base64,{base64.b64encode(png).decode('ascii')}"
            content.append({"type": "image_url", "image_url": {"url": url}})
    schema = json.dumps(request.output.model_json_schema(), separators=(",", ":"), ensure_ascii=False)
    form = f"Answer with one JSON object and nothing else. Positions are pixels. Its JSON schema:\n{schema}"
    content.append({"type": "text", "text": form})
    messages: list[dict[str, Any]] = [{"role": "system", "content": request.system}] if request.system else []
    messages.append({"role": "user", "content": content})
    if request.feedback:
        said = request.previous if isinstance(request.previous, str) else json.dumps(request.previous, default=str)
        complaint = f"Your answer does not fit: {request.feedback}\nAnswer again, whole, in the same form."
        messages += [{"role": "assistant", "content": said}, {"role": "user", "content": complaint}]
    return messages


Request.chat = staticmethod(chat_messages)
