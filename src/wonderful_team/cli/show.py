"""`show`: a recorded run, from its record."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

import click

from wonderful_team.cli.options import PATH, read_models
from wonderful_team.cli.output import finish
from wonderful_team.cli.run_summary import shown_path
from wonderful_team.cli.show_store import is_store, show_store
from wonderful_team.core.text import counted, ending_words, recorded_names, spoken, visible
from wonderful_team.errors import UnknownNameError, reading


@click.command(
    short_help="Show a recorded run, run it again, or compare two.",
    epilog="\b\nwonderful-team show latest --open\nwonderful-team show latest --role checker\n"
    "wonderful-team show latest --replay\nwonderful-team show latest --from ground --model offline",
)
@click.argument("run", default="latest")
@click.option("--role", metavar="R", help="Every question to one role, with its answer.")
@click.option("--replay", is_flag=True, help="Run it again from its own answers, without a model: the same plan?")
@click.option("--tolerant", is_flag=True, help="With --replay: go on where words or pictures differ, and say so.")
@click.option("--from", "stage", metavar="STAGE", help="Run it again with --model from plan, ground, act or replan on.")
@click.option("--model", multiple=True, metavar="M|ROLE=M", help="With --from: who answers from there on.")
@click.option("--diff", metavar="RUN2", help="This run and another one side by side.")
@click.option("--open", "open_page", is_flag=True, help="Open the page.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
@click.option("--out", type=PATH, metavar="DIR", help="Where run folders lie. [default: runs]")
def command(
    run: str,
    role: str | None,
    replay: bool,
    tolerant: bool,
    stage: str | None,
    model: tuple[str, ...],
    diff: str | None,
    open_page: bool,
    as_json: bool,
    out: Path | None,
) -> int:
    """Tell the story of a RUN (a folder, its name, part of it, or "latest") and write its page anew. A store of `bench`: a line for each trial.

    Or run it again (--replay, --from), or compare it with another (--diff).
    """
    from wonderful_team.record.run_folders import find_run

    chosen = [name for name, value in (("--role", role), ("--from", stage), ("--diff", diff)) if value is not None]
    chosen += ["--replay"] if replay else []
    if len(chosen) > 1:
        raise click.UsageError(f"{' and '.join(chosen)} exclude each other: choose one")
    if (stage is None) != (not model):
        raise click.UsageError("--from STAGE and --model M go together")
    if tolerant and not replay:
        raise click.UsageError("--tolerant goes with --replay")
    if is_store(run):
        if chosen or open_page:
            raise click.UsageError(f"{run} is a store of trials: it is shown without other options but --json")
        return show_store(run, as_json)
    folder = find_run(run, out)
    if replay:
        return _replay(folder, tolerant, as_json)
    if stage is not None:
        return _branch(folder, stage, model, out, as_json, open_page)
    if diff is not None:
        return _diff(folder, find_run(diff, out), as_json)
    return _show(folder, role, open_page, as_json)


def _show(folder: Path, role: str | None, open_page: bool, as_json: bool) -> int:
    """The story, or one role's questions and answers."""
    from wonderful_team.pages import write_page
    from wonderful_team.record.record_schema import read_record

    record = read_record(folder)
    page = write_page(folder)
    requests = record["planner"]["requests"]
    if role is not None:
        roles = sorted({str(request["role"]) for request in requests})
        if role not in roles:
            raise UnknownNameError("role in this run", role, roles)
        chosen = [request for request in requests if request["role"] == role]
        names = recorded_names(record["planner"]["instruction"])
        text = "\n\n".join(spoken(_exchange(request), names) for request in chosen)
        result = {"requests": chosen}
    else:
        with reading(f"{folder}: the record"):
            text, result = "\n".join(_story(record)), record
    if open_page:
        click.launch(page.resolve().as_uri())
    last = f"page: {shown_path(page)}"
    return finish("show", text=text, result=result, as_json=as_json, code=0, last_line=last)


def _replay(folder: Path, tolerant: bool, as_json: bool) -> int:
    """Exit code 0 when the same plans come out, 1 when not."""
    from wonderful_team.api.replay import replay

    found = replay(folder, tolerant=tolerant)
    how = "SAME" if found.same else "DIFFERENT"
    lines = [f"{how}  {counted(found.answers, 'answer')} replayed"]
    lines += [
        f"plan {number}: {then or '-'} {'=' if then == now else '->'} {now or '-'}"
        for number, (then, now) in enumerate(zip_longest(found.then, found.now), start=1)
    ]
    lines += [f"differs: {text}" for text in found.differences]
    result = {
        "same": found.same,
        "plan_ids": list(found.now),
        "recorded_plan_ids": list(found.then),
        "answers": found.answers,
        "differences": list(found.differences),
    }
    return finish("show", text="\n".join(lines), result=result, as_json=as_json, code=0 if found.same else 1)


def _branch(folder: Path, stage: str, words: Sequence[str], out: Path | None, as_json: bool, open_page: bool) -> int:
    """A new run that branches off this one."""
    from wonderful_team.api.replay import branch
    from wonderful_team.api.results import PlanResult
    from wonderful_team.cli.progress import ProgressLine
    from wonderful_team.cli.run_summary import trial_json
    from wonderful_team.cli.wording import plan_exit_code, plan_lines, trial_exit_code, trial_lines

    progress = ProgressLine(live=not as_json)
    # "latest" points at the new run once there is one.
    folder = folder.resolve()
    command = shlex.join(["wonderful-team", *(click.get_current_context().obj or ())])
    # Where its parent lies, unless another place is asked for.
    made = branch(
        folder,
        stage,
        read_models(words),
        out=folder.parent if out is None else out,
        subscribers=(progress,),
        command=command,
    )
    progress.end(made.usage)
    if isinstance(made, PlanResult):
        lines, result, code = plan_lines(made), made.to_json(), plan_exit_code(made)
    else:
        lines, result, code = trial_lines(made), trial_json(made), trial_exit_code(made)
    parent = {"run": folder.name, "from": stage}
    if open_page and made.page is not None:
        click.launch(made.page.resolve().as_uri())
    last = "" if made.page is None else f"page: {shown_path(made.page)}"
    lines.insert(0, f"branched off {parent['run']} at {stage}")
    return finish(
        "show", text="\n".join(lines), result={**result, "parent": parent}, as_json=as_json, code=code, last_line=last
    )


def _diff(one: Path, two: Path, as_json: bool) -> int:
    """Two runs side by side; the exit code says nothing of the difference."""
    from wonderful_team.cli.diff import compare
    from wonderful_team.record.record_schema import read_record

    with reading(f"{one}, {two}: the records"):
        found = compare((one, read_record(one)), (two, read_record(two)))
    return finish("show", text="\n".join(found.lines()), result=found.to_json(), as_json=as_json, code=0)


def _story(content: Any) -> list[str]:
    """Instruction, outcome, then a line for each stage with its time."""
    planner, clock = content["planner"], content["clock"]
    outcome = content["outcome"] or {"outcome": content["state"], "stage": None, "reason": ""}
    said = planner["instruction"] or {"text": "", "slots": {}}
    names = recorded_names(said)
    stage = f" at {outcome['stage']}" if outcome.get("stage") else ""
    ending, reason = ending_words(str(outcome["outcome"]), outcome.get("reason"))
    lines = [said["text"], f"{ending.upper()}{stage}  {reason}".rstrip()]
    told = [(at_s, one["name"], one["text"]) for one, at_s in zip(planner["stages"], clock["stages"], strict=False)]
    told += [(at_s, "gate", _gate_words(gate)) for gate, at_s in zip(planner["gates"], clock["gates"], strict=False)]
    lines += [f"{at_s:5.1f} s  {name:<12} {text}" for at_s, name, text in sorted(told, key=lambda one: one[0])]
    lines += [f"warning: {text}" for text in planner["warnings"]]
    asked = counted(len(planner["requests"]), "request")
    lines.append(f"{asked}; see --role " + "|".join(_roles(planner["requests"])))
    if content.get("command"):
        lines.append(f"again: {content['command']}")
    return [visible(spoken(line, names)) for line in lines]


def _gate_words(gate: Any) -> str:
    """One passage through the safety gate: admitted, or every reason against it."""
    from wonderful_team.core.values import refusal_words

    checks = counted(len(gate["checks"]), "check")
    failed = [one for one in gate["checks"] if not one["ok"]]
    reasons = "; ".join(refusal_words(one["name"], one["value"], one["limit"]) for one in failed)
    return f"{gate['where']}: " + (f"admitted ({checks})" if gate["admitted"] else f"refused ({checks}): {reasons}")


def _roles(requests: Any) -> list[str]:
    return list(dict.fromkeys(str(request["role"]) for request in requests)) or ["-"]


def _exchange(request: Any) -> str:
    """One question and its answer: the words as sent, the names of the pictures, the parsed answer."""
    import json

    lines = [f"== {request['key']}  {request['contract']}"]
    lines += [f"[picture] {part['picture']}" if "picture" in part else str(part["words"]) for part in request["parts"]]
    if request["invalid"]:
        lines.append(f"-> INVALID: {request['invalid']['error']}")
    if request["answer"]:
        mark = request["answer"]["provenance"]
        lines.append(f"-> ({mark}) {json.dumps(request['answer']['parsed'], ensure_ascii=False)}")
    return "\n".join(lines)
