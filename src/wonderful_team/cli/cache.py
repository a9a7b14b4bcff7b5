"""`cache`: how many answers are kept, and the way to drop them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from wonderful_team.cli.options import PATH
from wonderful_team.cli.output import finish
from wonderful_team.core.text import counted

if TYPE_CHECKING:
    from wonderful_team.models.cache_store import CacheSize


@click.command(
    name="cache",
    short_help="Show or clear the kept answers of models.",
    epilog="\b\nwonderful-team cache\nwonderful-team cache clear",
)
@click.argument("action", type=click.Choice(["show", "clear"]), default="show")
@click.option("--cache-file", type=PATH, metavar="FILE", help="Which file. [default: user's cache]")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
def command(action: str, cache_file: Path | None, as_json: bool) -> int:
    """Show how many answers of which model are kept, or drop them all (clear)."""
    from wonderful_team.models.cache_store import CacheStore, default_cache_file

    file = default_cache_file() if cache_file is None else cache_file
    if not file.exists():
        result = {"file": str(file), "answers": 0, "bytes": 0, "by_model": {}, "dropped": 0}
        return finish("cache", text=f"{file}: nothing is kept", result=result, as_json=as_json, code=0)
    store = CacheStore(file)
    dropped = store.clear() if action == "clear" else 0
    size = store.size()
    store.close()
    lines = [f"{counted(dropped, 'answer')} dropped"] if action == "clear" else []
    lines += [size_line(size), *(f"  {count:>6}  {model}" for model, count in size.by_model.items()), *store.warnings]
    result = {
        "file": str(size.path),
        "answers": size.answers,
        "bytes": size.bytes,
        "by_model": dict(size.by_model),
        "dropped": dropped,
    }
    return finish("cache", text="\n".join(lines), result=result, as_json=as_json, code=0)


def size_line(size: CacheSize) -> str:
    """How much a cache holds, in one line."""
    return f"{size.path}: {counted(size.answers, 'answer')}, {size.bytes / 1e6:.1f} MB"
