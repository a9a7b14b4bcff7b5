"""Whatever somebody else's world, method or scorer raises or returns is named as theirs, with their traceback."""

from __future__ import annotations

import re

import pytest

import wonderful_team as wt
from tests.runtime.runtime_fakes import MovesPolicy, SquaresWorld
from wonderful_team.errors import ConfigError, RobotFaultError, code_of, own_trace, raised
from wonderful_team.record import Recorder
from wonderful_team.runtime import rollout
from wonderful_team.runtime.user_code import close_world

MOVE = [((60.0, 60.0), (200.0, 30.0))]


class Heard:
    def __init__(self):
        self.crashes, self.warnings = [], []

    def on_event(self, event):
        if event.kind == "crash":
            self.crashes.append(event.content)
        if event.kind == "warning":
            self.warnings.append(event.content)


def run_in(world, policy=None, **more):
    heard = Heard()
    trial = rollout(policy or MovesPolicy([MOVE]), world, subscribers=[heard], **more)
    return trial, heard


def test_motion_that_raises_is_the_robots_fault():
    trial, heard = run_in(SquaresWorld(trouble={1: RuntimeError("joint 3 is hot")}))
    assert (trial.outcome, trial.stage) == ("failure", "execution")
    assert "execute(pick_place) of world SquaresWorld raised RuntimeError: joint 3 is hot" in trial.reason
    assert "RuntimeError: joint 3 is hot" in heard.crashes[0].trace
    assert "user_code.py" not in heard.crashes[0].trace.splitlines()[1]
    assert any("a person should look" in text for text in heard.warnings)


@pytest.mark.parametrize("after", [0, 1, 3])
def test_a_camera_that_raises_is_the_worlds_error_whenever_it_happens(after):
    class Blind(SquaresWorld):
        reobserve = 0

        def observe(self):
            self.reobserve += 1
            if self.reobserve > after:
                raise OSError("the camera is unplugged")
            return super().observe()

    world = Blind()
    trial, heard = run_in(world)
    assert (trial.outcome, trial.stage) == ("error", "world")
    assert "the camera is unplugged" in trial.reason
    assert world.stopped == 1
    assert len(heard.crashes) == 1


@pytest.mark.parametrize(
    ("name", "outcome", "says"),
    [("observe", "error", "is a NoneType; valid: Observation"), ("execute", "failure", "valid: StepReport")],
)
def test_a_world_that_returns_something_else_is_told_what_is_valid(name, outcome, says):
    world = SquaresWorld()
    setattr(world, name, lambda *_: None)
    trial, _ = run_in(world)
    assert trial.outcome == outcome
    assert says in trial.reason


def test_a_stop_that_fails_does_not_hide_why_it_was_stopped():
    def stop():
        raise RuntimeError("no answer from the controller")

    world = SquaresWorld(trouble={1: RuntimeError("collision")})
    world.stop = stop
    trial, heard = run_in(world)
    assert "collision" in trial.reason
    assert any("may still be moving" in text for text in heard.warnings)


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (ZeroDivisionError("1/0"), "raised ZeroDivisionError: 1/0"),
        (SystemExit(3), "raised SystemExit: 3"),
        ("done", "is a str; valid: Act, Done, GaveUp"),
        (wt.Act((3,)), "action 1 .* is a int; valid: PlannedAction"),
        (wt.Act((), plan="mine"), "the plan of .* is a str; valid: Plan"),
    ],
)
@pytest.mark.parametrize("is_async", [False, True])
def test_a_method_that_breaks_is_the_methods_failure(answer, says, is_async):
    def decide(self, situation):
        if isinstance(answer, BaseException):
            raise answer
        return answer

    async def later(self, situation):
        return decide(self, situation)

    policy = type("Mine", (), {"name": "mine", "decide": later if is_async else decide})()
    world = SquaresWorld()
    trial, heard = run_in(world, policy)
    assert (trial.outcome, trial.stage, world.ran) == ("failure", "method", 0)
    assert re.search(says, trial.reason)
    assert bool(heard.crashes) == isinstance(answer, BaseException)


def test_a_scorer_that_breaks_loses_nothing_of_the_trial():
    class Broken:
        def score(self):
            raise KeyError("mug")

        def truth(self):
            return {}

        def oracle(self):
            return ()

    trial, _ = run_in(SquaresWorld(), scorer=Broken())
    assert (trial.outcome, trial.stage, len(trial.reports)) == ("error", "world", 1)
    assert "score() of Broken raised KeyError: 'mug'" in trial.reason


def test_the_traceback_stands_in_record_and_log(tmp_path):
    with Recorder(tmp_path) as recorder:
        world = SquaresWorld(trouble={1: RuntimeError("joint 3 is hot")})
        rollout(MovesPolicy([MOVE]), world, subscribers=[recorder])
    assert '"trace": "Traceback' in (tmp_path / "record.json").read_text(encoding="utf-8")
    assert "RuntimeError: joint 3 is hot" in (tmp_path / "log.txt").read_text(encoding="utf-8")


def test_errors_that_say_whose_fault_they_are_pass_unchanged():
    with pytest.raises(ConfigError, match="^the address is missing$"), code_of("x", RobotFaultError):
        raise ConfigError("the address is missing")


def caught(error):
    """The exception as it is after it was raised here."""
    with pytest.raises(type(error)) as found:
        raise error
    return found.value


def test_an_exception_whose_text_cannot_be_made_is_told_all_the_same():
    class WorstError(Exception):
        def __str__(self):
            raise RuntimeError

    told = raised(caught(WorstError()))
    assert told.startswith("raised WorstError: (its text cannot be shown) (test_user_code.py:")


def test_a_long_text_is_cut():
    error = caught(ValueError("x" * 10_000_000))
    assert len(raised(error)) < 3_000
    assert len(own_trace(error)) < 50_000


def test_a_close_that_fails_is_a_warning():
    class Stuck(SquaresWorld):
        def close(self):
            raise ConnectionError("gone")

    told = []
    close_world(Stuck(), told.append)
    assert "close() of world Stuck raised ConnectionError: gone" in told[0]
