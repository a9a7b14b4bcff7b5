"""Errors sorted by whose fault they are, because fault decides what happens next and how a trial is counted.

Every class carries the exit code of the command line and, for failures of a method, the stage at which it failed.
Messages name the value, the limit and what would be valid; they are built here where the shape repeats.
"""

from __future__ import annotations

import contextlib
import difflib
import shlex
import sys
import traceback
from collections.abc import Iterable, Iterator
from importlib import metadata
from pathlib import Path
from typing import ClassVar

from wonderful_team.redaction import redact

_PACKAGE = Path(__file__).parent
MESSAGE_LIMIT = 2_000
"""Longest text of somebody else's exception that becomes part of ours [characters]."""


def extra_command(extra: str) -> str:
    """The command that installs an optional part: its packages by name, so that it works however this package was installed."""
    mark = f'extra == "{extra}"'
    try:
        lines = metadata.requires("wonderful-team") or []
    except metadata.PackageNotFoundError:
        lines = []
    needed = [line.partition(";")[0].strip() for line in lines if mark in line.replace("'", '"')]
    return shlex.join([sys.executable, "-m", "pip", "install", *(needed or [f".[{extra}]"])]) + (
        "" if needed else " (in a checkout)"
    )


class WonderfulTeamError(Exception):
    """Base of every error that this package raises on purpose.

    Attributes:
        stage: Where a method failed; None where the error is not a method's.
        trace: The traceback of the user's own code that raised; empty where there is none.
        folder: The run folder that holds what had happened by then; None where nothing was recorded.
        sent: False where a request to a model was refused before it was sent: it is no call and costs nothing.
    """

    exit_code: ClassVar[int] = 1
    stage: str | None = None
    trace: str = ""
    folder: Path | None = None
    sent: bool = True

    def __init__(self, message: str, *, stage: str | None = None, cause: BaseException | None = None) -> None:
        super().__init__(redact(message if cause is None else f"{message} {raised(cause)}"))
        if stage is not None:
            self.stage = stage
        if cause is not None:
            self.trace = own_trace(cause)


def raised(error: BaseException) -> str:
    """What somebody else's code raised and where, in one line: `raised KeyError: 'x' (mine.py:12, in decide)`."""
    try:
        text = redact(str(error))
    except Exception:  # noqa: BLE001  an exception of somebody else's whose own text cannot be made
        text = "(its text cannot be shown)"
    text = text if len(text) <= MESSAGE_LIMIT else f"{text[:MESSAGE_LIMIT]}…"
    frames = traceback.extract_tb(error.__traceback__)
    where = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno}, in {frames[-1].name})" if frames else ""
    return f"raised {type(error).__name__}{': ' if text else ''}{text}{where}"


def own_trace(error: BaseException) -> str:
    """The traceback of an exception without our own frames above the user's code."""
    frames = list(traceback.walk_tb(error.__traceback__))
    skipped = 0
    while skipped < len(frames) - 1 and Path(frames[skipped][0].f_code.co_filename).is_relative_to(_PACKAGE):
        skipped += 1
    trace = error.__traceback__
    for _ in range(skipped):
        trace = None if trace is None else trace.tb_next
    text = redact("".join(traceback.format_exception(type(error), error, trace, limit=40)))
    return text[-20 * MESSAGE_LIMIT :]


@contextlib.contextmanager
def code_of(whose: str, error_class: type[WonderfulTeamError]) -> Iterator[None]:
    """Run somebody else's code: whatever it raises becomes `error_class`, with its own traceback.

    Errors that say already whose fault they are pass unchanged.

    Args:
        whose: Begins the message, as in "observe() of world AgentSession".
        error_class: Whose fault it is.
    """
    try:
        yield
    except WonderfulTeamError:
        raise
    except (Exception, SystemExit) as error:
        raise error_class(whose, cause=error) from error


@contextlib.contextmanager
def reading(what: str, valid: str = "") -> Iterator[None]:
    """Read what somebody else wrote (a file, an option): whatever is wrong with it becomes one error that names it.

    This is for readers alone: what fails in here fails because of what was read.

    Args:
        what: Which file or option, as it begins the message.
        valid: What would be valid.
    """
    try:
        yield
    except WonderfulTeamError:
        raise
    except RecursionError as error:
        raise ConfigError(f"{what} is nested too deeply{_valid(valid)}") from error
    except MemoryError as error:
        raise ConfigError(f"{what} is too large for this machine's memory{_valid(valid)}") from error
    except OSError as error:
        raise ConfigError(f"{what} cannot be read: {error.strerror or error}{_valid(valid)}") from error
    except Exception as error:
        said = redact(str(error) if type(error) is ValueError else f"{type(error).__name__}: {error}")
        raise ConfigError(f"{what} cannot be read: {said[:MESSAGE_LIMIT]}{_valid(valid)}") from error


def _valid(text: str) -> str:
    return f"; valid: {text}" if text else ""


class ConfigError(WonderfulTeamError):
    """Wrong use or configuration; raised before anything is touched."""

    exit_code = 2


class FileNotWrittenError(ConfigError):
    """The machine could not write a file: a full disk, a read-only one, a folder without the right to; names the file.

    Attributes:
        path: The file or folder.
    """

    def __init__(self, path: Path | str, why: OSError | str, hint: str = "") -> None:
        self.path = Path(path)
        said = (why.strerror or str(why)) if isinstance(why, OSError) else why
        super().__init__(f"{str(path)!r} cannot be written: {said}{f'; {hint}' if hint else ''}")


class ClusterLostError(WonderfulTeamError):
    """The cluster that a study runs on is gone, or has no worker left that can run it; what ended is kept."""


class UnknownNameError(ConfigError):
    """A name that is not registered; lists the known ones and the nearest."""

    def __init__(self, kind: str, name: str, known: Iterable[str], where: str = "") -> None:
        names = sorted(known)
        near = difflib.get_close_matches(name, names, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        super().__init__(f"unknown {kind} {name!r}{where}.{hint} Known: {', '.join(names) or 'none'}")


class MissingExtraError(ConfigError):
    """An optional dependency is not installed; names the exact command that brings it."""

    def __init__(self, feature: str, extra: str) -> None:
        super().__init__(f"{feature} needs the optional part {extra!r}: {extra_command(extra)}")


class BadPictureError(ConfigError):
    """A picture file or array that cannot be used; says why."""


class MissingDepthError(ConfigError):
    """Metres were asked for where no depth is known; names the pixels."""


class ModelUnavailableError(WonderfulTeamError):
    """The provider did not answer; the trial is an error, never the method's failure."""

    exit_code = 3


class WorldUnavailableError(WonderfulTeamError):
    """A simulator broke, hangs, or cannot set up its scene; the trial is an error, never the method's failure."""

    exit_code = 6
    stage = "world"


class ModelCodeError(ModelUnavailableError):
    """The code of a model raised something of its own; its traceback is kept."""


class DetectorCodeError(ModelUnavailableError):
    """A detector raised something of its own, hangs, or returned what are no detections; the trial is an error."""


class CacheMissError(ModelUnavailableError):
    """`--cache only` forbids asking a model, and the cache holds no answer."""

    sent = False


class ReplayError(ConfigError):
    """A record cannot be replayed: what is asked now is not what was asked then; names the request and what differs."""


class ModelRateLimitError(ModelUnavailableError):
    """The provider asked for a pause, and went on asking."""


class ModelQuotaError(ModelUnavailableError):
    """The account has no credit or quota left; waiting does not help."""


class ModelServerError(ModelUnavailableError):
    """The provider failed, or its reply was not a reply."""


class ModelTimeoutError(ModelUnavailableError):
    """No whole reply came within the deadline."""


class ModelConnectionError(ModelUnavailableError):
    """The provider could not be reached, or the connection broke."""


class ModelAuthError(ConfigError):
    """The provider refused the key; names the variable that holds it, never the key."""


class UnknownModelError(ConfigError):
    """The provider has no such model, or nothing answers at that address."""


class RequestRejectedError(ConfigError):
    """The provider refuses such requests whatever is tried; names what it said."""


class TooManyPicturesError(RequestRejectedError):
    """A request holds more pictures than the model takes."""


class NoPicturesError(RequestRejectedError):
    """The model takes no pictures at all."""


class ContextTooLongError(RequestRejectedError):
    """A request is longer than the model's context."""


class LocalOnlyError(ConfigError):
    """A model outside this machine and its private network was named although only local ones are allowed."""


class ModelOutputError(WonderfulTeamError):
    """A model kept answering outside the contract after every allowed attempt."""


class ModelRefusalError(ModelOutputError):
    """The model declined to answer."""


class ContentFilterError(ModelOutputError):
    """The provider's content filter stopped the answer."""


class ModelCutOffError(ModelOutputError):
    """The answer ended at the limit of tokens before it was whole."""


class UnsupportedQuestion(ModelOutputError):  # noqa: N818  the name says what it is
    """A model was asked a kind of question that it cannot answer."""

    def __init__(self, model: str, contract: str, why: str = "") -> None:
        super().__init__(f"model {model!r} cannot answer {contract}" + (f": {why}" if why else ""))
        self.contract = contract


class PlanError(WonderfulTeamError):
    """No acceptable plan came out of the team."""

    stage = "plan"


class GeometryError(PlanError):
    """The numbers of a step cannot be computed: no room, no point, a place outside of the view; says what was measured."""


class CodeCrashError(PlanError):
    """A method's code came to an end before there was a plan: an answer that it cannot read, or a model's program that fails."""

    stage = "crash"


class NotFoundError(WonderfulTeamError):
    """A target is not in the picture, or could not be grounded within the bounds."""

    stage = "grounding"


class MethodCodeError(WonderfulTeamError):
    """The code of a method raised something of its own, or decided what is no decision; its traceback is kept."""

    stage = "method"


class ActionRefusedError(WonderfulTeamError):
    """The safety gate refused; `reasons` holds all of them at once."""

    exit_code = 4
    stage = "gate"

    def __init__(self, reasons: Iterable[str]) -> None:
        self.reasons = tuple(reasons)
        super().__init__("refused by the safety gate: " + "; ".join(self.reasons))


class BudgetReached(WonderfulTeamError):  # noqa: N818
    """A cap on calls, tokens, seconds or money was met before a request was sent; the best so far is kept."""

    exit_code = 5
    stage = "budget"


class RobotFaultError(WonderfulTeamError):
    """The robot reported a fault while something moved; the run halts and a person looks."""

    exit_code = 6
    stage = "execution"


class SafetyStopError(WonderfulTeamError):
    """Motion was stopped for safety; the run halts and a person looks."""

    exit_code = 6
    stage = "execution"


class NotUnderstoodError(WonderfulTeamError):
    """A model says which words it used and which it does not know, instead of guessing."""

    exit_code = 7
    stage = "plan"


class NeedsClarification(WonderfulTeamError):  # noqa: N818
    """Neither picture nor instruction settles what is meant; holds the question and the choices."""

    exit_code = 7
    stage = "plan"

    def __init__(self, question: str, choices: Iterable[str]) -> None:
        self.question = question
        self.choices = tuple(choices)
        listed = f" Choices: {' | '.join(self.choices)}" if self.choices else ""
        super().__init__(f"needs clarification: {question}{listed}")
