"""Templates are compiled once in a process, not with every page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jinja2
import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team.pages import write, write_page


def test_a_second_page_compiles_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled: list[Any] = []
    compile_one = jinja2.Environment.compile

    def counted(environment: jinja2.Environment, *source: Any, **how: Any) -> Any:
        compiled.append(source[1:3])
        return compile_one(environment, *source, **how)

    monkeypatch.setattr(jinja2.Environment, "compile", counted)
    write._environment.cache_clear()
    made = wt.Team(model="offline", out=tmp_path).plan(np.full((96, 128, 3), 190, np.uint8), "find the red block")
    first = len(compiled)
    assert first > 0
    write_page(made.folder)
    assert len(compiled) == first
