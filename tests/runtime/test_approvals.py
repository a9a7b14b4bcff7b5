"""A person's consent: to one plan, as she saw it, for a while; her no ends the trial, her advice makes one new plan."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.runtime.runtime_fakes import MovesPolicy, SquaresTruth, SquaresWorld, make_plan
from wonderful_team.core.values import ReadPlan
from wonderful_team.errors import ConfigError
from wonderful_team.runtime import Proposal, rollout
from wonderful_team.runtime.rollout import MAX_ADVICE

RED, BLUE = (60.0, 60.0), (160.0, 90.0)
UP, MIDDLE = (200.0, 30.0), (120.0, 60.0)


class Person:
    """Answers each question with the next of her answers."""

    def __init__(self, *answers):
        self.answers, self.asked = list(answers), []

    def __call__(self, proposal):
        self.asked.append(proposal)
        answer = self.answers.pop(0)
        return answer(proposal) if callable(answer) else answer


def yes(proposal):
    return proposal.approve("Ada")


def no(proposal):
    return proposal.decline("Ada")


def no_because(proposal):
    return proposal.decline("Ada", "it is too near the edge")


def run(person, answers, world=None, **options):
    policy = MovesPolicy([list(moves) for moves in answers])
    world = world or SquaresWorld()
    return rollout(policy, world, approval=person, **options), policy, world


@pytest.mark.parametrize("answer", [no, None])
def test_a_no_ends_it_whatever_replans_are_left(answer):
    person = Person(answer)
    trial, policy, world = run(person, [[(RED, UP)]] * 4, replans=3)
    assert (trial.outcome, trial.stage, world.ran) == ("failure", "gate", 0)
    assert "you declined" in trial.reason
    assert (len(person.asked), len(policy.asked)) == (1, 1)


def test_a_no_with_a_reason_is_advice_for_one_new_plan_and_no_replan():
    person = Person(no_because, yes)
    world = SquaresWorld()
    trial, policy, _ = run(person, [[(RED, MIDDLE)], [(RED, UP)]], world, scorer=SquaresTruth(world, {"red": UP}))
    assert (trial.outcome, world.ran) == ("success", 1)
    assert [asked.advice for asked in policy.asked] == ["", "it is too near the edge"]
    assert [asked.replans_left for asked in policy.asked] == [0, 0]
    assert person.asked[0].id != person.asked[1].id


def test_advice_then_no_ends_it():
    person = Person(no_because, no)
    trial, policy, world = run(person, [[(RED, MIDDLE)]] * 4, replans=3)
    assert (trial.stage, world.ran, len(policy.asked)) == ("gate", 0, 2)


def test_advice_without_end_is_bounded():
    trial, policy, world = run(Person(*[no_because] * 50), [[(RED, UP)]] * 50)
    assert (trial.outcome, trial.stage, world.ran) == ("failure", "gate", 0)
    assert len(policy.asked) == MAX_ADVICE + 1


def test_a_plan_that_was_read_is_declined_whole_advice_or_not():
    world = SquaresWorld()
    seen = world.observe()
    read = ReadPlan(make_plan(seen, [(RED, UP)]), seen)
    trial, policy, _ = run(Person(no_because), [[(RED, UP)]] * 3, world, plan=read, replans=3)
    assert (trial.stage, world.ran, len(policy.asked)) == ("gate", 0, 1)
    assert "you declined (Ada): it is too near the edge; nothing moved" in trial.reason


def test_nobody_is_asked_about_what_is_refused_anyway():
    person = Person()
    trial, _, world = run(person, [[(RED, (400.0, 60.0))]])
    assert (trial.stage, world.ran, person.asked) == ("gate", 0, [])


def test_the_page_is_there_before_the_question_and_consent_is_to_that_page(tmp_path):
    page = tmp_path / "page.html"

    def write():
        page.write_text("what will be done", encoding="utf-8")
        return page

    def reads(proposal):
        assert proposal.page.read_text(encoding="utf-8") == "what will be done"
        return proposal.approve("Ada")

    def finds_another_page_later(proposal):
        consent = proposal.approve("Ada")
        page.write_text("something else", encoding="utf-8")
        return consent

    assert run(Person(reads), [[(RED, UP)]], page=write)[2].ran == 1
    trial, _, world = run(Person(finds_another_page_later), [[(RED, UP)]], page=write)
    assert (trial.stage, world.ran, "approved page" in trial.reason) == ("gate", 0, True)


def test_what_moved_while_she_was_reading_is_noticed():
    world = SquaresWorld()

    def slowly(proposal):
        world.squares["red"] = (66.0, 60.0)
        return proposal.approve("Ada")

    trial, _, _ = run(Person(slowly), [[(RED, UP)]], world)
    assert (trial.stage, world.ran, "unchanged: T1 (pick)" in trial.reason) == ("gate", 0, True)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda consent: replace(consent, plan_id=consent.plan_id[:12]), "approval: plan"),
        (lambda consent: replace(consent, picture=""), "approved picture: none named"),
        (lambda consent: replace(consent, expires_s=1.0), "approval still holds: expired"),
        (lambda consent: replace(consent, expires_s=0.0), "approval still holds: no end"),
        (lambda consent: replace(consent, by=" "), "by nobody"),
    ],
)
def test_consent_to_something_else_is_none(change, says):
    trial, _, world = run(Person(lambda proposal: change(proposal.approve("Ada"))), [[(RED, UP)]])
    assert (trial.stage, world.ran) == ("gate", 0)
    assert says in trial.reason


def test_consent_given_beforehand_is_to_one_plan_so_no_other_is_made():
    world = SquaresWorld()
    seen = world.observe()
    plan = make_plan(seen, [(RED, MIDDLE)])
    consent = Proposal(plan, plan.actions, None, seen.hash).approve("Ada")
    trial, policy, _ = run(consent, [[(RED, UP)]] * 3, world, replans=3)
    assert (trial.stage, world.ran, len(policy.asked)) == ("gate", 0, 1)


def test_an_answer_that_is_none_of_ours_is_wrong_use_and_moves_nothing():
    world = SquaresWorld()
    with pytest.raises(ConfigError, match=r"returned a bool; valid: proposal\.approve\(by\)"):
        run(lambda proposal: True, [[(RED, UP)]], world)
    assert (world.ran, world.stopped) == (0, 1)
