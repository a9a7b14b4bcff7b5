"""What the trials of a study add up to, kept by the store as they end: claims and progress cost the same however large a study is.

`totals` has a line for each study: how many trials it wants, how many ended how, and what they cost, attempts that were thrown away
included. `dearest` has a line for each condition: the most that one of its trials took. Triggers of the file keep both, in the
transaction that changes a trial.
"""

from __future__ import annotations

import sqlite3

OUTCOMES = ("success", "failure", "error", "unscored")
_COSTS = ("calls", "tokens", "usd")
_CONDITION = ("method", "model", "isolate", "perturb", "replans", "how", "looks")
TABLES = (
    "CREATE TABLE IF NOT EXISTS totals(study TEXT PRIMARY KEY, "
    + ", ".join(f"{name} INTEGER NOT NULL DEFAULT 0" for name in ("wanted", "done", *OUTCOMES, "calls", "tokens", "unpriced"))
    + ", usd REAL NOT NULL DEFAULT 0) WITHOUT ROWID",
    "CREATE TABLE IF NOT EXISTS dearest(method TEXT NOT NULL, model TEXT NOT NULL, isolate TEXT NOT NULL, perturb TEXT NOT NULL, "
    "replans INTEGER NOT NULL, how TEXT NOT NULL, looks INTEGER NOT NULL, calls INTEGER NOT NULL, tokens INTEGER NOT NULL, "
    f"usd REAL NOT NULL, PRIMARY KEY({', '.join(_CONDITION)})) WITHOUT ROWID",
    "CREATE INDEX IF NOT EXISTS wanted_by_trial ON wanted(trial)",
    "CREATE INDEX IF NOT EXISTS discarded_by_trial ON discarded(trial)",
)  # fmt: skip


def _of_trial(row: str) -> dict[str, str]:
    """What a line of `trials` adds to each column of the totals: nothing before it has ended."""
    done = f"({row}.state = 'done')"
    costs = {name: f"{done} * COALESCE({row}.{name}, 0)" for name in _COSTS}
    ends = {name: f"({done} AND {row}.outcome IS '{name}')" for name in OUTCOMES}
    return {"done": done, **ends, **costs, "unpriced": f"({done} AND {row}.usd IS NULL)"}


def _of_discarded(row: str) -> dict[str, str]:
    return {name: f"COALESCE({row}.{name}, 0)" for name in _COSTS}


def _changed(new: dict[str, str], old: dict[str, str] | None, trial: str) -> str:
    """A statement that brings the totals of every study that wants a trial up to date."""
    sets = (f"{name} = {name} + {now}" + (f" - {old[name]}" if old else "") for name, now in new.items())
    return f"UPDATE totals SET {', '.join(sets)} WHERE study IN (SELECT study FROM wanted WHERE trial = {trial});"


def _dearer(values: str) -> str:
    """A statement that keeps what the dearest trial of a condition took; `values` selects one line."""
    sets = ", ".join(f"{name} = MAX({name}, excluded.{name})" for name in _COSTS)
    columns = ", ".join((*_CONDITION, *_COSTS))
    return f"INSERT INTO dearest({columns}) {values} ON CONFLICT DO UPDATE SET {sets}"


def _tells(row: str) -> str:
    """Whether a trial tells what one like it may take: one that broke before a call tells nothing."""
    return f"{row}.state = 'done' AND ({row}.calls > 0 OR {row}.outcome IN ('success', 'failure'))"


_OWN = ", ".join(f"{{row}}.{name}" for name in _CONDITION)
_TOOK = "{row}.calls, {row}.tokens, COALESCE({row}.usd, 0)"
_FROM_TRIAL = f"SELECT {_OWN}, {_TOOK} FROM (SELECT 1) WHERE {{tells}}"
_FROM_DISCARDED = (
    f"SELECT {_OWN.format(row='trials')}, {_TOOK.format(row='NEW')} FROM trials "
    "WHERE trials.id = NEW.trial AND NEW.calls > 0 AND NEW.owner = ''"
)
_WANTED = {
    name: (
        f"COALESCE((SELECT {value} FROM trials t WHERE t.id = NEW.trial), 0)"
        + (f" + COALESCE((SELECT SUM({name}) FROM discarded WHERE trial = NEW.trial), 0)" if name in _COSTS else "")
    )
    for name, value in _of_trial("t").items()
}
TRIGGERS = (
    "CREATE TRIGGER IF NOT EXISTS trial_changes AFTER UPDATE ON trials WHEN NEW.state = 'done' OR OLD.state = 'done' BEGIN "
    + _changed(_of_trial("NEW"), _of_trial("OLD"), "NEW.id")
    + " "
    + _dearer(_FROM_TRIAL.format(row="NEW", tells=_tells("NEW")))
    + "; END",
    "CREATE TRIGGER IF NOT EXISTS attempt_is_discarded AFTER INSERT ON discarded BEGIN "
    + _changed(_of_discarded("NEW"), None, "NEW.trial")
    + f" {_dearer(_FROM_DISCARDED)}; END",
    "CREATE TRIGGER IF NOT EXISTS attempt_is_corrected AFTER UPDATE ON discarded BEGIN "
    + _changed(_of_discarded("NEW"), _of_discarded("OLD"), "NEW.trial")
    + f" {_dearer(_FROM_DISCARDED)}; END",
    "CREATE TRIGGER IF NOT EXISTS trial_is_wanted AFTER INSERT ON wanted BEGIN "
    "INSERT INTO totals(study) VALUES(NEW.study) ON CONFLICT DO NOTHING; UPDATE totals SET wanted = wanted + 1, "
    + ", ".join(f"{name} = {name} + {value}" for name, value in _WANTED.items())
    + " WHERE study = NEW.study; END",
)


def fill(base: sqlite3.Connection) -> None:
    """Both tables of a store that had none, from its trials."""
    sums = ", ".join(f"SUM({value})" for value in _of_trial("t").values())
    base.execute(
        f"INSERT INTO totals(study, wanted, {', '.join(_of_trial('t'))}) SELECT w.study, COUNT(*), {sums} "
        "FROM wanted w JOIN trials t ON t.id = w.trial GROUP BY w.study"
    )
    lost = "SELECT COALESCE(SUM(d.{name}), 0) FROM discarded d JOIN wanted w ON w.trial = d.trial WHERE w.study = totals.study"
    base.execute(f"UPDATE totals SET {', '.join(f'{name} = {name} + ({lost.format(name=name)})' for name in _COSTS)}")
    base.execute(_dearer(f"SELECT {_OWN.format(row='t')}, {_TOOK.format(row='t')} FROM trials t WHERE {_tells('t')}"))
    base.execute(
        _dearer(
            f"SELECT {_OWN.format(row='t')}, {_TOOK.format(row='d')} FROM discarded d JOIN trials t ON t.id = d.trial "
            "WHERE d.calls > 0 AND d.owner = ''"
        )
    )
