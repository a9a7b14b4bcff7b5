"""The command group, and the one place where an error becomes a message and an exit code."""

from __future__ import annotations

import contextlib
import importlib
import sys
import traceback
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from wonderful_team._version import __version__
from wonderful_team.cli.output import print_document, say
from wonderful_team.core.interrupts import Interrupted, ends_on_signal, exits_at_once, leave
from wonderful_team.redaction import redact_streams, redacted_streams

if TYPE_CHECKING:
    from wonderful_team.errors import WonderfulTeamError

INTERRUPTED = 130
CRASHED = 70
"""Exit code of a defect of ours (EX_SOFTWARE): never one of the codes that say something about a run."""

COMMANDS: dict[str, tuple[str, str]] = {
    "demo": ("demo", "Watch the team plan, catch two planted mistakes, and act, on a rendered scene."),
    "doctor": ("doctor", "Check this machine: versions, rendering, disk, keys, and what is missing."),
    "list": ("listing", "List models, worlds, tasks, suites, methods, detectors, prompts, words or runs."),
    "plan": ("plan", "Plan from pictures and an instruction; nothing moves."),
    "ground": ("ground", "Find things in a picture: boxes and points."),
    "run": ("run", "Plan, pass the gate, act in a world, look, replan."),
    "show": ("show", "Show a recorded run, run it again, or compare two."),
    "cache": ("cache", "Show or clear the kept answers of models."),
    "probe": ("probe", "Measure a model: its coordinates, its limits, its errors; save a profile."),
    "bench": ("bench", "Compare methods and models on suites, with controls, in a durable store."),
    "report": ("report", "Turn stores into one page, tables and plots."),
    "paper": ("paper", "The paper's tables for your model, beside the paper's figures."),
    "new": ("new", "Write a world, method, task, model or detector of your own that runs, with a test."),
    "check": ("check", "Check a world, method, task, model or detector of your own."),
}


RENAMED_FLAGS = {"--looks": "--reobserve", "--deadline": "--timeout"}
"""Flags of the last release."""


class LazyGroup(click.Group):
    """Knows its commands by name and imports one only when it is asked for, so that `--help` answers at once."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        module = importlib.import_module(f"wonderful_team.cli.{COMMANDS[cmd_name][0]}")
        command = module.command
        if not isinstance(command, click.Command):
            raise TypeError(f"{module.__name__}.command is not a click command")
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, words) for name, (_, words) in COMMANDS.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        args = [_flag_of_now(word) for word in args]
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            from wonderful_team.errors import UnknownNameError

            raise UnknownNameError("command", args[0], COMMANDS)
        return super().resolve_command(ctx, args)


def _flag_of_now(word: str) -> str:
    name, equals, value = word.partition("=")
    if name not in RENAMED_FLAGS:
        return word
    new = RENAMED_FLAGS[name]
    click.echo(f"warning: {name} is called {new} now; the old name goes with the next release", err=True)
    return f"{new}{equals}{value}"


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
    epilog="Exit codes: 0 done, 1 the method failed, 2 wrong use, 3 model unavailable, 4 gate refused, "
    "5 budget reached, 6 robot fault, 7 not understood, 130 interrupted.",
)
@click.version_option(__version__, prog_name="wonderful-team")
@click.option("--debug", is_flag=True, help="Show the traceback of an error.")
def group(debug: bool) -> None:
    """A picture and an instruction in; a checked, grounded, executable robot plan out."""


def main(argv: Sequence[str] | None = None) -> None:
    """Run one command and exit with its code."""
    # To the very end: a thread of somebody's code may fail after the command did.
    redact_streams()
    if argv is not None:
        sys.exit(run(list(argv)))
    exits_at_once()
    leave(run(sys.argv[1:]))


def run(argv: list[str]) -> int:
    """Run one command.

    Returns:
        The exit code. An error has then been told on stderr, and as a JSON document on stdout with --json.
    """
    _write_anything()
    foreign = [word for word in argv if any(0xD800 <= ord(letter) <= 0xDFFF for letter in word)]
    if foreign:
        return _fail(
            [word for word in argv if word not in foreign], "UsageError", f"{foreign[0]!r} is not text in UTF-8", 2
        )
    try:
        with redacted_streams(), ends_on_signal(force=True):
            code: Any = group.main(args=argv, prog_name="wonderful-team", standalone_mode=False, obj=tuple(argv))
        return code if isinstance(code, int) else 0
    except click.exceptions.Exit as ending:
        return ending.exit_code
    except (click.exceptions.Abort, KeyboardInterrupt) as error:
        return _interrupted(argv, error)
    except click.ClickException as error:
        hint = error.ctx.command_path if isinstance(error, click.UsageError) and error.ctx else "wonderful-team"
        told = (
            error.format_message().replace("valid integer range", "whole number").replace("valid float range", "number")
        )
        return _fail(argv, "UsageError", f"{told} (see {hint} --help)", 2)
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except Exception as error:  # noqa: BLE001  the top: every error becomes a message and an exit code here
        if "--debug" in argv:
            say("".join(traceback.format_exception(error)), err=True)
        return _tell(argv, error)


def _interrupted(argv: list[str], error: BaseException) -> int:
    """Click turns an interrupt into an Abort of its own and keeps the interrupt as its cause."""
    cause = error if isinstance(error, KeyboardInterrupt) else error.__cause__
    name, code = ("SIGINT", INTERRUPTED) if not isinstance(cause, Interrupted) else (cause.name, cause.exit_code)
    return _fail(argv, "Interrupted", f"interrupted by {name}; what was recorded so far is kept", code)


def _write_anything() -> None:
    """What cannot be encoded (half of a character out of a file or a model's words) is shown escaped, never a crash."""
    if (reconfigure := getattr(sys.stdout, "reconfigure", None)) is not None:
        reconfigure(errors="backslashreplace")


def _tell(argv: list[str], error: Exception) -> int:
    from wonderful_team.errors import WonderfulTeamError

    name = type(error).__name__
    if isinstance(error, WonderfulTeamError):
        return _fail(argv, name, str(error), error.exit_code, error)
    if isinstance(error, OSError):
        # The machine's word, not a defect: a full disk, a folder without the right to write.
        file = f"{error.filename}: " if error.filename else ""
        return _fail(argv, name, f"{file}{error.strerror or str(error) or name}", 2)
    message = f"unexpected {name}: {error}. This is a defect of wonderful-team; `wonderful-team --debug …` shows where"
    return _fail(argv, name, message, CRASHED)


def _fail(argv: list[str], name: str, message: str, code: int, error: WonderfulTeamError | None = None) -> int:
    page = error.folder / "page.html" if error is not None and error.folder is not None else None
    if "--json" in argv:
        command = next((word for word in argv if word in COMMANDS), "")
        told = {"type": name, "message": message, "stage": error.stage if error is not None else None}
        more = {} if error is None or not error.trace else {"trace": error.trace}
        result = {} if page is None else {"folder": str(page.parent), "page": str(page)}
        print_document(command, code, result, {**told, **more})
    # The trace of a run with a folder was told while it ran.
    if error is not None and error.trace and page is None:
        from wonderful_team.cli.progress import trace_lines

        for line in trace_lines(error.trace):
            say(f"    {line}", err=True)
    with contextlib.suppress(OSError):  # the terminal may be gone
        say(f"error: {message}" if name != "Interrupted" else message, err=True)
    if page is not None:
        say(f"page: {page}", err=True)
    return code
