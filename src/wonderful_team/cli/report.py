"""`report`: stores of `bench` become one page, Markdown, CSV and LaTeX."""

from __future__ import annotations

import shlex
from pathlib import Path

import click

from wonderful_team.cli.options import PATH
from wonderful_team.cli.output import finish, say


@click.command(
    short_help="Turn stores into one page, tables and plots.",
    epilog="\b\nwonderful-team report study.db --open\nwonderful-team report study.*.db --baseline direct --latex tables",
)
@click.argument("stores", nargs=-1, required=True, type=PATH, metavar="STORE...")
@click.option("--baseline", metavar="METHOD", help="Compare every method with this one only.")
@click.option("--out", type=PATH, metavar="FILE", help="The page. [default: the first store's name with .html]")
@click.option("--csv", type=PATH, metavar="FILE", help="Where the table of trials goes. [default: beside the page]")
@click.option("--latex", type=PATH, metavar="DIR", help="Write LaTeX tables there.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
@click.option("--open", "open_page", is_flag=True, help="Open the page when done.")
@click.pass_context
def command(
    context: click.Context,
    stores: tuple[Path, ...],
    baseline: str | None,
    out: Path | None,
    csv: Path | None,
    latex: Path | None,
    as_json: bool,
    open_page: bool,
) -> int:
    """Merge STOREs (shards, or several studies) and write what they show."""
    from wonderful_team.cli.run_summary import shown_path
    from wonderful_team.errors import FileNotWrittenError
    from wonderful_team.evals.report.page import read_stores, write_all
    from wonderful_team.evals.report.tables import condition_json, to_markdown
    from wonderful_team.evals.summary import summarise

    words = shlex.join(["wonderful-team", *(context.obj or ())])
    page = out or stores[0].with_suffix(".html")
    try:
        made = write_all(stores, page, baseline=baseline, csv=csv, latex=latex, command=words)
    except FileNotWrittenError:
        # The figures are the result in hand.
        rows, requests, _ = read_stores(stores)
        say(to_markdown(summarise(rows, requests), baseline).rstrip(), err=as_json)
        raise
    if open_page:
        click.launch(made.page.resolve().as_uri())
    summary = made.summary
    result = {
        "conditions": [condition_json(summary.cell(one)) for one in (*summary.compared, *summary.bounds)],
        "answer": summary.headline(baseline),
        "warnings": list(made.warnings),
        "page": str(made.page),
        "csv": str(made.csv),
        "markdown": str(made.markdown),
        "latex": [str(path) for path in made.latex],
    }
    text = to_markdown(summary, baseline).rstrip()
    return finish(
        "report", text=text, result=result, as_json=as_json, code=0, last_line=f"page: {shown_path(made.page)}"
    )
