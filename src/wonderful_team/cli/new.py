"""`new`: a world, method, task, model or detector of one's own that runs at once, with a test."""

from __future__ import annotations

import keyword
import shlex
from pathlib import Path
from string import Template

import click

from wonderful_team.cli.options import PATH
from wonderful_team.cli.output import finish
from wonderful_team.cli.run_summary import program
from wonderful_team.core.filesystem import write_public
from wonderful_team.errors import ConfigError

KINDS = ("world", "method", "task", "model", "detector")
_FILES = Path(__file__).with_name("own")


@click.command(
    short_help="Write a world, method, task, model or detector of your own that runs, with a test.",
    epilog="\b\nwonderful-team new task cups\nwonderful-team new method Mine --out methods",
)
@click.argument("kind", type=click.Choice(KINDS))
@click.argument("name")
@click.option("--out", type=PATH, default=Path(), metavar="DIR", help="Where the two files go. [default: here]")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
def command(kind: str, name: str, out: Path, as_json: bool) -> int:
    """Write NAME as a file that runs, and a test beside it; nothing that exists is overwritten."""
    if not name.isidentifier() or keyword.iskeyword(name):
        raise ConfigError(f"name {name!r}: valid is a Python name, as in {'cups' if kind == 'task' else 'Mine'}")
    file = f"{name.lower()}.py"
    made = {out / file: f"{kind}.py.txt", out / f"test_{file}": f"test_{kind}.py.txt"}
    taken = [str(path) for path in made if path.exists()]
    if taken:
        raise ConfigError(f"{', '.join(taken)}: exists already; choose another name or --out DIR")
    for path, template in made.items():
        # Only $name, $file and $path are filled: the files hold braces of their own.
        text = Template((_FILES / template).read_text(encoding="utf-8")).safe_substitute(
            name=name, file=file, path=shlex.quote(f"{out / file}:{name}")
        )
        write_public(path, text, "give another folder with --out DIR")
    path = out / file
    called, name_there = program(), shlex.quote(f"{path}:{name}")
    text = "\n".join(
        [
            *(f"wrote {one}" for one in made),
            f"check it: {called} check {name_there}",
            f"test it:  pytest {shlex.quote(str(out / ('test_' + file)))}",
        ]
    )
    return finish(
        "new",
        text=text,
        result={"files": [str(one) for one in made], "name": f"{path}:{name}"},
        as_json=as_json,
        code=0,
    )
