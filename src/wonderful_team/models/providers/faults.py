"""What went wrong at a provider, sorted by whose fault it is and whether trying again can help. No key passes through."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from wonderful_team.core.values import Request
from wonderful_team.errors import (
    ContentFilterError,
    ContextTooLongError,
    ModelAuthError,
    ModelConnectionError,
    ModelQuotaError,
    ModelRateLimitError,
    ModelRefusalError,
    ModelServerError,
    ModelTimeoutError,
    NoPicturesError,
    RequestRejectedError,
    TooManyPicturesError,
    UnknownModelError,
    WonderfulTeamError,
)
from wonderful_team.models.providers.bounded import ReplyTooLargeError
from wonderful_team.models.providers.settings import LONGEST_WAIT_S
from wonderful_team.redaction import redact

_LONGEST_BODY = 300
_CONTEXT = re.compile(
    r"context (length|window|size|limit)|maximum (context|model length)|too many tokens|prompt is too long|max_model_len"
    r"|input token count",
    re.I,
)
_LENGTH = re.compile(
    r"(?:context length is|model length of|max_model_len\D{0,12}|available context size \(|\bn_ctx\D{1,5}"
    r"|tokens >|\d \+ \d+ >)\s*(\d[\d,]*)",
    re.I,
)
"""The context's length in a refusal: vLLM and OpenAI; llama.cpp; Anthropic ("prompt is too long: 9 tokens > 8 maximum",
"input length and `max_tokens` exceed context limit: 7 + 4 > 8")."""
_TAKEN = re.compile(
    r"(\d[\d,]*) in the messages|your request has (\d[\d,]*) input tokens|prompt contains (\d[\d,]*) input tokens"
    r"|messages resulted in (\d[\d,]*) tokens|request \((\d[\d,]*) tokens\)|prompt \(length (\d[\d,]*)\)"
    r"|\bn_prompt_tokens\D{1,5}(\d+)|too long: (\d[\d,]*) tokens|limit: (\d[\d,]*) \+",
    re.I,
)
"""The request's own length in it."""
_MOST_OUT = re.compile(
    r"max_(?:completion_|output_)?tokens.{0,60}?(?:supports at most (\d[\d,]*)|\d > (\d[\d,]*), which is the maximum)",
    re.I,
)
"""The longest answer: OpenAI ("supports at most 16384 completion tokens"), Anthropic ("9 > 8, which is the maximum allowed")."""
_NO_PICTURES = re.compile(
    r"(image|vision|picture|multi-?modal)s?( input| inputs)?( is| are)? not supported|not a (multi-?modal|vision)"
    r"|does ?n[o']t support (image|vision|multi-?modal|picture)|no endpoints found that support image"
    r"|at most 0 (image|picture|multi-?modal)|image_url is only supported by|missing data required for image",
    re.I,
)
"""A model that takes no pictures: llama.cpp (status 500), vLLM, OpenRouter (404), OpenAI, Ollama."""
_PICTURES = re.compile(
    r"(at most|too many|maximum (number )?of|limit of|up to|more than)\D{0,20}?(\d+)?\D{0,20}?(image|picture|multi-?modal)"
    r"|(image|picture)s?\b.{0,40}(limit|at most|too many|exceed)",
    re.I,
)
_HEAVY = re.compile(
    r"image exceeds [\d.]+ ?[KM]i?B|payload (too large|reached size limit)|(request )?entity too large|body (is )?too large"
    r"|(body|payload).{0,30}length limit exceeded",
    re.I,
)
"""Too many bytes: Anthropic (a picture), SGLang, nginx, FastAPI, text-generation-inference."""
_CROWDED = re.compile(r"context size has been exceeded", re.I)
"""llama.cpp, whose requests share one context unless it is told otherwise: together they overfilled it, and each of them failed."""
_SCHEMA = re.compile(
    r"response_format|json_schema|guided|structured output|output_config|output_format|response_schema|grammar", re.I
)
_THINKING = re.compile(
    r"chat_template_kwargs|reasoning[_.]effort|enable_thinking|(support|enabl)\w* (adaptive )?(thinking|reasoning)"
    r"|thinking(\.type|_?budget|_?level| mode)|(thinking|reasoning) is not",
    re.I,
)
_BAD_KEY = re.compile(
    r"\bapi.?key\b.{0,40}(not valid|invalid|incorrect|expired|missing)|(invalid|incorrect) api.?key", re.I
)


@dataclass(frozen=True)
class Fault:
    """One failed try.

    Attributes:
        error: What is raised when nothing else helps.
        retry: Trying the same again may help.
        wait_s: How long the provider asked to wait.
        picture_limit: How many pictures it takes, when that is what it refused; 0 when it did not say.
        heavy: The request has too many bytes (status 413), or a picture has.
        schema: It refused the schema.
        thinking: It refused the switch for thinking.
        crowded: Requests under way at once were too much for it; it may take this one alone.
        billed: It may have worked on the request, so the request may cost something.
        context, taken: Tokens of the model's context and of the request, when it says them.
        most_out: Most tokens of an answer, when it says that.
    """

    error: WonderfulTeamError
    retry: bool = False
    wait_s: float | None = None
    picture_limit: int | None = None
    schema: bool = False
    thinking: bool = False
    crowded: bool = False
    billed: bool = False
    context: int | None = None
    taken: int | None = None
    most_out: int | None = None
    heavy: bool = False


def fault_of(error: BaseException, name: str, where: str, refused: str) -> Fault:
    """Sort an error of the library; keys are taken out of every text. `refused` says which key it is (`key_refused`)."""
    own = _caused_by(error, WonderfulTeamError)
    if isinstance(own, WonderfulTeamError):
        return Fault(own)
    too_large = _caused_by(error, ReplyTooLargeError)
    if too_large is not None:
        return Fault(ModelServerError(f"{name}: {where}: {too_large}"), billed=True)
    said = _said(error)
    if _NO_PICTURES.search(said):
        # Whatever the status: some call it their own failure, some an unknown model.
        valid = "a vision-language model (llama.cpp: started with --mmproj FILE)"
        return Fault(NoPicturesError(f"{name}: the model takes no pictures ({said}); valid: {valid}"))
    return _sorted(error, said, name, where, refused)


def _sorted(error: Any, said: str, name: str, where: str, refused: str) -> Fault:
    from pydantic_ai import exceptions as lib

    match error:
        case lib.ModelAuthenticationError():
            return Fault(ModelAuthError(f"{name}: {refused} ({said})"))
        case lib.ModelNotFoundError():
            return Fault(UnknownModelError(f"{name}: {where} has no such model, or is not the right address ({said})"))
        case lib.ModelQuotaExceededError():
            return Fault(ModelQuotaError(f"{name}: no credit or quota left ({said})"))
        case lib.ModelContextWindowExceededError():
            return _too_long(name, said)
        case lib.ModelRateLimitError():
            fault = ModelRateLimitError(f"{name}: the provider asks for fewer requests ({said})")
            return Fault(fault, True, _asked_wait(error))
        case lib.ModelTimeoutError() | lib.ModelRequestTimeout():
            return Fault(ModelTimeoutError(f"{name}: {where} did not answer in time"), True, billed=True)
        case lib.ModelConnectionError():
            sent = error.phase not in ("connect", "pool")
            what = "the connection broke" if sent else "cannot be reached"
            return Fault(ModelConnectionError(f"{name}: {where}: {what} ({said})"), True, billed=sent)
        case lib.ModelUnavailableError() | lib.ModelServerError():
            return _failed(name, said, _asked_wait(error))
        case lib.ModelHTTPError():
            return _rejected(error.status_code, name, where, said, _asked_wait(error), refused)
        case lib.ModelRequestRejectedError():
            return _rejected(400, name, where, said, None, refused)
        case lib.UserError():
            return Fault(RequestRejectedError(f"{name}: the client library refuses the request ({said})"), schema=True)
        case _:
            # A reply that is none: empty choices, HTML, an error in a reply that says 200.
            return Fault(ModelServerError(f"{name}: the reply is not one ({said})"), True, billed=True)


def _caused_by(error: BaseException | None, kind: type[BaseException]) -> BaseException | None:
    """The error of that kind among an error and its causes."""
    for _ in range(10):
        if error is None or isinstance(error, kind):
            return error
        error = error.__cause__ or error.__context__
    return None


def key_refused(where: str, key: str | None, key_holder: str) -> str:
    """That a key is wrong, or that there is none, with what holds it or should."""
    if not key:
        return f"{where} wants a key, and none was sent: set the environment variable {key_holder}"
    return f"{where} refused the key that {key_holder} holds"


def _rejected(status: int, name: str, where: str, said: str, wait_s: float | None, refused: str) -> Fault:
    """A reply with a status of its own; 4xx are final unless another form of the request may do."""
    if status in (408, 409, 425) or status >= 500:
        return _failed(name, said, wait_s)
    if 300 <= status < 400:
        return Fault(UnknownModelError(f"{name}: {where} sends elsewhere (status {status}); give the final address"))
    if _BAD_KEY.search(said):
        return Fault(ModelAuthError(f"{name}: {refused} ({said})"))
    if _HEAVY.search(said):
        return Fault(RequestRejectedError(f"{name}: {where} takes no request with so many bytes ({said})"), heavy=True)
    pictures = _PICTURES.search(said)
    if pictures is not None:
        limit = int(pictures.group(3)) if pictures.group(3) else 0
        return Fault(TooManyPicturesError(f"{name}: too many pictures in one request ({said})"), picture_limit=limit)
    most_out = _number(_MOST_OUT, said)
    if most_out is None and (status == 413 or _CONTEXT.search(said)):
        return replace(_too_long(name, said), heavy=status == 413 and not _CONTEXT.search(said))
    rejected = RequestRejectedError(f"{name}: {where} refused the request ({said})")
    return Fault(rejected, schema=bool(_SCHEMA.search(said)), thinking=bool(_THINKING.search(said)), most_out=most_out)


def _failed(name: str, said: str, wait_s: float | None) -> Fault:
    """A failure of the service's own; llama.cpp calls it one that requests at once overfilled its context."""
    crowded = bool(_CROWDED.search(said))
    return Fault(ModelServerError(f"{name}: the provider failed ({said})"), True, wait_s, crowded=crowded)


def _too_long(name: str, said: str) -> Fault:
    error = ContextTooLongError(f"{name}: the request is longer than the model takes ({said})")
    return Fault(error, context=_number(_LENGTH, said), taken=_number(_TAKEN, said))


def _number(pattern: re.Pattern[str], text: str) -> int | None:
    found = pattern.search(text)
    return None if found is None else int(next(part for part in found.groups() if part).replace(",", ""))


def _asked_wait(error: Any) -> float | None:
    """How long the provider asks to wait; the library reads whole seconds only, some servers send fractions."""
    if error.retry_after is not None:
        return float(error.retry_after)
    try:
        seconds = float((getattr(error, "headers", None) or {}).get("retry-after", "nan"))
    except ValueError:
        return None
    return seconds if 0 <= seconds < math.inf else None


def _said(error: BaseException) -> str:
    """What the provider said, short and without the key."""
    body: Any = getattr(error, "body", None)
    if isinstance(body, dict):
        inner = body.get("error", body)
        body = inner.get("message", inner) if isinstance(inner, dict) else inner
    status = getattr(error, "status_code", None)
    text = str(body) if body else f"{type(error).__name__}: {error}"
    text = " ".join(redact(text).split())
    text = text if len(text) <= _LONGEST_BODY else text[: _LONGEST_BODY - 1] + "…"
    return f"status {status}: {text}" if status is not None else text


@contextlib.contextmanager
def before_sending(*, first: bool = True) -> Iterator[None]:
    """What is refused here has not been sent, where no try came first."""
    try:
        yield
    except WonderfulTeamError as error:
        error.sent = not first
        raise


def told(error: WonderfulTeamError, tries: int, wait_s: float, left_s: float) -> WonderfulTeamError:
    """The error with what was tried."""
    extra = ""
    if tries > 1:
        extra = f"; {tries} tries"
    if wait_s > LONGEST_WAIT_S:
        extra += f"; it asks to wait {wait_s:.0f} s, at most {LONGEST_WAIT_S:.0f} s are waited"
    elif wait_s >= left_s:
        extra += "; no time is left for another try"
    return type(error)(f"{error}{extra}", stage=error.stage) if extra else error


def declined(name: str, request: Request, details: Mapping[str, Any], said: str) -> WonderfulTeamError:
    """Why a model, or a filter before it, gave no answer; `details` are what the service says of its end."""
    why, reason = str(details.get("refusal") or ""), str(details.get("finish_reason") or "")
    if why or "refusal" in reason:
        text = redact(why or said)[:200]
        return ModelRefusalError(f"{name} refused to answer {request.contract}: {text}", stage=request.stage)
    kind = reason or "content_filter"
    said_so = f"{name}: a content filter stopped the answer to {request.contract} ({kind})"
    return ContentFilterError(said_so, stage=request.stage)
