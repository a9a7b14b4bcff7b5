"""Every write of every command fails once: a named error, the result in hand printed, nothing half written taken for whole.

By default a sample of the points; `--runslow` takes all of them. `tests/write_fault_cases.py` says what must hold.
"""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from tests.write_fault_cases import CASES, Case, Setting, fail_writes, prepare
from tests.write_faults import Faults, injected
from wonderful_team.cli.app import run

SAMPLE = 29
"""Every so many points by default."""
ALL = pytest.param(1, marks=[pytest.mark.slow, pytest.mark.timeout(1800)], id="every point")


@pytest.fixture(scope="module")
def setting(tmp_path_factory: pytest.TempPathFactory) -> Setting:
    return prepare(tmp_path_factory.mktemp("faults"))


@pytest.mark.parametrize("lasting", [pytest.param(False, id="once"), pytest.param(True, id="from then on")])
@pytest.mark.parametrize("every", [pytest.param(SAMPLE, id="sample"), ALL])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_write_that_fails_is_named_and_loses_nothing(case: Case, every: int, lasting: bool, setting: Setting) -> None:
    count, outcomes = fail_writes(case, setting, every=every, lasting=lasting)
    wrong = [f"{one.point}: exit {one.code}: {'; '.join(one.wrong)}" for one in outcomes if one.wrong]
    assert not wrong, f"{len(wrong)} of {len(outcomes)} points:\n" + "\n".join(wrong)
    assert count >= 4
    print(f"{case.name}: {len(outcomes)} of {count} points")  # noqa: T201  the figure, with -s


def test_a_profile_that_cannot_be_saved_is_still_shown(setting: Setting, tmp_path: Path, monkeypatch, capsys) -> None:
    blocked = tmp_path / "config"
    blocked.write_text("a file, where a folder should be", encoding="utf-8")
    monkeypatch.setenv("WONDERFUL_TEAM_CONFIG", str(blocked))
    assert run(["probe", f"{setting.own}:Stub", "--save", "mine"]) == 2
    out, err = capsys.readouterr()
    assert out.startswith("model ")
    assert f"{str(blocked)}" in err
    assert "the profile is not saved" in err


def test_the_injector_fails_what_it_should(tmp_path: Path) -> None:
    """A check that cannot fail would prove nothing."""
    target = tmp_path / "a.txt"
    with injected(Faults([tmp_path])) as counted:
        target.write_text("whole", encoding="utf-8")
        (tmp_path / "b").mkdir()
        os.replace(target, tmp_path / "c.txt")
    assert [point.split()[0] for point in counted.points] == ["open", "write", "close", "mkdir", "replace"]
    with injected(Faults([tmp_path], 2)), pytest.raises(OSError, match="No space left") as caught:
        target.write_text("whole", encoding="utf-8")
    assert caught.value.errno == errno.ENOSPC
    assert target.read_text(encoding="utf-8") == "wh"
    with injected(Faults([tmp_path / "elsewhere"], 1)):
        target.write_text("whole", encoding="utf-8")
