"""ReviewPlan: derive again what the plan must achieve, read the plan as shown, and compare.

The shown plan may be any planner's: its subgoals are read with the grammar and its targets by their words; both are
looked up in the picture, so that different words for the same thing agree and the same words for another thing do not.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from wonderful_team.contracts import CritiqueDraft, PlanReview, ReviewPlan, WalkedReview
from wonderful_team.contracts.shown import ShownTask
from wonderful_team.core.values import Subgoal, Target
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.answers.drafting import aim_text
from wonderful_team.offline.eyes import Eyes, eyes_of_task, target_description
from wonderful_team.offline.goals.aims import Aim, Aims, Named
from wonderful_team.offline.goals.clearing import cleared
from wonderful_team.offline.goals.deriving import derive
from wonderful_team.offline.goals.instruction import read_task
from wonderful_team.offline.language import try_understand


@dataclass(frozen=True)
class Finding:
    """One thing that is amiss with a plan."""

    about: str
    kind: str
    question: str


@dataclass(frozen=True, eq=False)
class ReadSubgoal:
    """A subgoal as shown: what its words come to (None where they cannot be read), and its targets."""

    subgoal: Subgoal
    aims: tuple[Aim, ...] | None
    targets: tuple[tuple[Target, Named | None], ...]

    def names(self, named: Named) -> bool:
        """Whether one of its targets means that thing."""
        return any(known is not None and known.same(named) for _, known in self.targets)


def findings(
    task: ShownTask, subgoals: Sequence[Subgoal], targets: Sequence[Target], step_kinds: Sequence[str]
) -> list[Finding]:
    """Everything that is amiss, the most telling first.

    Raises:
        NotUnderstoodError: The instruction itself cannot be read.
    """
    eyes = eyes_of_task(task)
    wanted = derive(read_task(task), eyes, strict=False)
    wanted.aims = cleared(wanted.aims, eyes)
    read = [read_subgoal(subgoal, targets, eyes) for subgoal in subgoals]
    found = [Finding(subgoals[-1].id if subgoals else "plan", "ambiguity", f"{text}; is it?") for text in wanted.absent]
    found += _cannot_be_done(read, step_kinds)
    found += _differences(wanted, read)
    found += [item for subgoal in read for item in _wrong_targets(subgoal)]
    found += _order(wanted.aims, read)
    return found


def read_subgoal(subgoal: Subgoal, targets: Sequence[Target], eyes: Eyes) -> ReadSubgoal:
    """Read a subgoal's words and look its targets up."""
    understood = try_understand(subgoal.text)
    aims: tuple[Aim, ...] | None = None
    if understood is not None:
        # What lies where it should go already is still what the words ask for.
        aims = tuple(derive(understood, eyes, strict=False, literal=True).aims)
    by_id = {target.id: target for target in targets}
    known = [(by_id[name], named(by_id[name], eyes)) for name in subgoal.targets if name in by_id]
    for target, who in tuple(known):
        if who is not None and who.description.way is not None:
            # A place inside of something stands for that thing.
            into = who.description.way.into
            known.append((target, Named(into, eyes.number(into))))
    return ReadSubgoal(subgoal, aims, tuple(known))


def named(target: Target, eyes: Eyes) -> Named | None:
    """The thing that a target means, or None where its words cannot be read."""
    try:
        description = target_description(target)
    except NotUnderstoodError:
        return None
    if description.way is not None:
        return Named(description, None)
    return Named(description, eyes.number(description))


def _cannot_be_done(read: Sequence[ReadSubgoal], step_kinds: Sequence[str]) -> list[Finding]:
    found = []
    for item in read:
        kinds = {aim.kind for aim in item.aims or ()}
        for what in lacking(kinds, step_kinds):
            text = f"Can this robot do '{item.subgoal.text}'? {what} is not among its steps."
            found.append(Finding(item.subgoal.id, "physical_constraint", text))
    return found


_ABLE = (
    ("pushing", {"push"}, {"move", "push", "pick_place"}),
    ("picking up", {"put", "rotate"}, {"move", "push", "pick_place"}),
    ("turning things", {"rotate"}, {"pick_place", "rotate_gripper"}),
    ("following a path", {"trace", "shake"}, {"follow"}),
    ("turning what is gripped", {"twist"}, {"rotate_gripper"}),
)
"""What a robot has to be able to do for which kinds of aims, and the kinds of steps of which it needs one."""


def lacking(kinds: Collection[str], step_kinds: Sequence[str]) -> list[str]:
    """What a robot with these kinds of steps cannot do of what these kinds of aims take."""
    return [what for what, asked, needed in _ABLE if {*kinds} & asked and not needed & {*step_kinds}]


def _differences(wanted: Aims, read: Sequence[ReadSubgoal]) -> list[Finding]:
    """Compare what must be achieved with what the subgoals say, one to one."""
    open_aims = list(range(len(wanted.aims)))
    spare: list[tuple[ReadSubgoal, Aim]] = []
    unread: list[ReadSubgoal] = []
    for item in read:
        if item.aims is None or (not item.aims and item.targets):
            unread.append(item)
            continue
        for aim in item.aims:
            match = next((index for index in open_aims if wanted.aims[index].same(aim)), None)
            if match is None:
                spare.append((item, aim))
            else:
                open_aims.remove(match)
    open_aims, unread_found = _by_targets(wanted, open_aims, unread)
    found = [_spare(item, aim, wanted, open_aims) for item, aim in spare] + unread_found
    return found + [_missing(wanted.aims[index], index, wanted, read) for index in open_aims]


def _by_targets(wanted: Aims, open_aims: list[int], unread: Sequence[ReadSubgoal]) -> tuple[list[int], list[Finding]]:
    """Subgoals whose words cannot be read are judged by their targets; what they cover is not missing."""
    left, found = list(open_aims), []
    for item in unread:
        covered = next((k for k in left if _covers(item, wanted.aims[k])), None)
        if covered is not None:
            left.remove(covered)
        elif left or not item.targets:
            text = f"What does '{item.subgoal.text}' bring about? I cannot read it."
            found.append(Finding(item.subgoal.id, "ambiguity", text))
    return left, found


def _covers(item: ReadSubgoal, aim: Aim) -> bool:
    return item.names(aim.thing) and (aim.to is None or item.names(aim.to))


def _spare(item: ReadSubgoal, aim: Aim, wanted: Aims, open_aims: list[int]) -> Finding:
    """A subgoal that nothing asks for: the wrong thing or place when it resembles an open aim, else needless."""
    text = item.subgoal.text
    # Before and after the words for what is asked for; braces in any of these words are pictures of the instruction.
    likenesses: tuple[tuple[Callable[[Aim], bool], str, str], ...] = (
        (lambda open_: open_.thing.same(aim.thing), "Should it not be '", f"' instead of '{text}'?"),
        (
            lambda open_: open_.same_goal(aim),
            f"Is {aim.thing.words!r} the right thing? The instruction and the picture ask for '",
            "'.",
        ),
        (
            lambda open_: open_.to is not None and open_.to.same(aim.thing),
            "Are thing and place swapped? Asked for is '",
            "'.",
        ),
        (lambda open_: True, f"Nothing asks for '{text}'; asked for is '", "'."),
    )
    for resembles, before, after in likenesses:
        index = next((k for k in open_aims if resembles(wanted.aims[k])), None)
        if index is not None:
            open_aims.remove(index)
            return Finding(item.subgoal.id, "wrong_target", f"{before}{aim_text(wanted.aims[index])}{after}")
    why = f"What is '{text}' for? The instruction does not ask for it."
    return Finding(item.subgoal.id, "needless_step", why)


def _missing(aim: Aim, index: int, wanted: Aims, read: Sequence[ReadSubgoal]) -> Finding:
    """An aim that no subgoal serves; the doubt is about the subgoal that should follow it, or the last one."""
    about = read[-1].subgoal.id if read else "plan"
    followers = [k for k, other in enumerate(wanted.aims) if index in other.after]
    for item in read:
        if any(wanted.aims[k].same(own) for k in followers for own in item.aims or ()):
            about = item.subgoal.id
            break
    why = f" ({aim.why})" if aim.why else ""
    return Finding(about, "missing_subgoal", f"Where is '{aim_text(aim)}'{why}? No subgoal brings it about.")


def _wrong_targets(item: ReadSubgoal) -> list[Finding]:
    """Targets that mean something else than the subgoal's words, or are missing."""
    if not item.targets or not item.aims:
        return []
    needed = [who for aim in item.aims for who in (aim.thing, aim.to, aim.other) if who is not None]
    found: list[str] = []
    for target, known in item.targets:
        if known is None:
            continue
        spot = target.kind == "area" and known.number is None
        if not spot and not any(known.same(who) for who in needed):
            found.append(
                f"{target.id} ({target.words}) is not what '{item.subgoal.text}' speaks of; is it the right target?"
            )
    if all(known is not None for _, known in item.targets):
        ends = [who for aim in item.aims if aim.how != "between" for who in (aim.thing, aim.to) if who is not None]
        found += [f"Which target of {item.subgoal.id} is the {who.words}?" for who in ends if not item.names(who)]
    return [Finding(item.subgoal.id, "wrong_target", text) for text in found[:1] + _wrong_use(item)]


def _wrong_use(item: ReadSubgoal) -> list[str]:
    """The thing to be moved must have a point to pick it at."""
    return [
        f"{target.id} ({target.words}) is to be moved, but its use is {', '.join(target.use)}; is it swapped?"
        for aim in item.aims or ()
        for target, known in item.targets
        if aim.kind != "trace"
        and known is not None
        and known.same(aim.thing)
        and not (aim.to is not None and known.same(aim.to))
        if target.use and not {*target.use} & {"pick", "grasp", "push_start"}
    ]


def _order(wanted: Sequence[Aim], read: Sequence[ReadSubgoal]) -> list[Finding]:
    """What must come first must stand first."""
    place: dict[int, int] = {}
    used: set[tuple[int, int]] = set()
    for index, aim in enumerate(wanted):
        for position, item in enumerate(read):
            for k, own in enumerate(item.aims or ()):
                if index not in place and (position, k) not in used and aim.same(own):
                    place[index] = position
                    used.add((position, k))
    for index, aim in enumerate(wanted):
        for first in aim.after:
            if index in place and first in place and place[index] < place[first]:
                late, early = read[place[index]].subgoal, read[place[first]].subgoal
                text = f"Must '{early.text}' not come before '{late.text}'?"
                return [Finding(late.id, "missing_prerequisite", text)]
    return []


def answer_review(question: ReviewPlan) -> WalkedReview:
    """One doubt about one subgoal, or approval."""
    return question.walked(review_of_plan(question))


def review_of_plan(question: ReviewPlan) -> PlanReview:
    """The same, without a walk."""
    found = findings(question.task, question.subgoals, question.targets, question.step_kinds)
    if question.under_check is not None:
        found = [item for item in found if item.about in (question.under_check, "plan")]
    fresh = [item for item in found if not _asked(item, question.checked)]
    scope = question.under_check or "the plan"
    if not fresh:
        whole = "what it must bring about is in it, each thing and place as asked"
        why = f"Derived again from words and picture; {scope}: {'asked already and answered' if found else whole}."
        return PlanReview(reasoning=why, approved=True, doubt=None)
    first = fresh[0]
    why = f"Derived again from words and picture, {scope} differs: {first.kind} in {first.about}."
    doubt = CritiqueDraft(about=first.about, kind=first.kind, question=first.question)
    return PlanReview(reasoning=why, approved=False, doubt=doubt)


def _asked(item: Finding, checked: Sequence[str]) -> bool:
    return any(item.question in line for line in checked)
