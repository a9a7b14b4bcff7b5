"""The rules of each VIMA-Bench task, tried with wrong, half-right, right-in-another-order and lucky actions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from wonderful_team.core.actions import PickPlace, Push
from wonderful_team.sims.tabletop import TabletopWorld, make_world


@pytest.fixture
def table() -> Iterator[Callable[..., TabletopWorld]]:
    """Makes worlds and closes them."""
    made: list[TabletopWorld] = []

    def make(name: str, seed: int = 1, fits: Callable[[dict], bool] = lambda truth: True) -> TabletopWorld:
        for number in range(seed, seed + 60):
            made.append(make_world(name, number))
            if fits(made[-1].privileged.truth()):
                return made[-1]
        raise AssertionError(f"no seed of {name} from {seed} on fits")

    yield make
    for world in made:
        world.close()


def _things(world: TabletopWorld) -> dict:
    return world.privileged.truth()["things"]


def _move(world: TabletopWorld, name: str, to: tuple[float, ...], yaw_rad: float = 0.0) -> None:
    """Carry a thing so that its centre lands at a point."""
    thing = _things(world)[name]
    pick, centre = np.array(thing["grasp_m"]), np.array(thing["position_m"])
    turn = np.array([[math.cos(yaw_rad), -math.sin(yaw_rad)], [math.sin(yaw_rad), math.cos(yaw_rad)]])
    end = np.array(to[:2]) + turn @ (pick - centre)[:2]
    assert world.execute(PickPlace(pick, (*end, 0.0), yaw_rad)).measured["held"]


def _at(world: TabletopWorld, name: str) -> tuple[float, ...]:
    return _things(world)[name]["position_m"]


def _bare(world: TabletopWorld, *away: tuple[float, ...]) -> tuple[float, float]:
    """A point of bare table, far from everything and from some more points."""
    busy = [thing["position_m"][:2] for thing in _things(world).values()] + [point[:2] for point in away]
    points = [(x, y) for x in np.arange(0.33, 0.68, 0.02) for y in np.arange(-0.41, 0.42, 0.02)]
    return max(points, key=lambda p: min(math.dist(p, other) for other in busy))


def _verdict(world: TabletopWorld) -> tuple[bool, str]:
    score = world.privileged.score()
    return bool(score.success), score.reason


def _goals(world: TabletopWorld, phase: int = 0) -> list[dict]:
    return world.privileged.truth()["phases"][phase]


def test_rearrange_any_order_any_yaw_but_every_thing(table: Callable[..., TabletopWorld]) -> None:
    world = table("rearrange", 0, lambda truth: len(truth["goals"]) == 2 and not truth["distractors"])
    first, second = _goals(world)
    _move(world, second["thing"], second["at_m"], 0.8)
    assert not _verdict(world)[0], "half of it"
    x, y = first["at_m"]
    _move(world, first["thing"], (x, y + 0.08), -0.5)
    assert _verdict(world)[0]


def test_rearrange_within_a_decimetre_only(table: Callable[..., TabletopWorld]) -> None:
    world = table("rearrange", 0, lambda truth: len(truth["goals"]) == 1 and abs(truth["goals"][0]["at_m"][1]) < 0.3)
    (goal,) = _goals(world)
    other = world.privileged.truth()["distractors"][0]
    x, y = goal["at_m"]
    if math.dist(_at(world, other)[:2], (x, y)) < 0.1:
        _move(world, other, _bare(world, (x, y)))
        assert not _verdict(world)[1].startswith("the distractor"), "moving what is in the way is no failure"
    _move(world, goal["thing"], (x, y + 0.13))
    assert not _verdict(world)[0]


def test_rearrange_on_top_of_what_is_in_the_way_fails_only_then(table: Callable[..., TabletopWorld]) -> None:
    def covered(truth: dict) -> bool:
        places = [truth["things"][name]["position_m"][:2] for name in truth["distractors"]]
        return any(math.dist(place, truth["goals"][0]["at_m"]) < 0.05 for place in places)

    world = table("rearrange", 0, covered)
    assert world.privileged.score().stage is None, "where it stands at the start costs nothing"
    (goal,) = _goals(world)
    _move(world, goal["thing"], goal["at_m"])
    success, reason = _verdict(world)
    assert not success
    assert "distractor" in reason


def test_restore_counts_only_after_the_picture_was_reached(table: Callable[..., TabletopWorld]) -> None:
    world = table("rearrange_then_restore", 0, lambda truth: len(truth["goals"]) == 4)
    start = {goal["thing"]: _at(world, goal["thing"]) for goal in _goals(world)}
    first, second = _goals(world)
    assert not _verdict(world)[0], "everything is where it has to end, but nothing was done"
    _move(world, first["thing"], first["at_m"])
    assert world.privileged.truth()["phase"] == 0
    _move(world, second["thing"], second["at_m"])
    assert world.privileged.truth()["phase"] == 1
    for name in (first["thing"], second["thing"]):
        assert not _verdict(world)[0]
        _move(world, name, start[name])
    assert _verdict(world)[0]


@pytest.mark.parametrize(
    ("off_deg", "off_m", "success"), [(0, 0, True), (11, 0, True), (20, 0, False), (0, 0.07, False)]
)
def test_twist_wants_angle_and_place(
    table: Callable[..., TabletopWorld], off_deg: float, off_m: float, success: bool
) -> None:
    world = table("twist", 0, lambda truth: len(truth["goals"]) == 1)
    (goal,) = _goals(world)
    thing = _things(world)[goal["thing"]]
    turn = math.remainder(goal["yaw_rad"] - thing["yaw_rad"], 2 * math.pi)
    assert -math.radians(151) < turn < -math.radians(29), "clockwise"
    x, y = goal["at_m"]
    _move(world, goal["thing"], (x + (off_m if x < 0.5 else -off_m), y), turn + math.radians(off_deg))
    assert _verdict(world)[0] is success


def test_twist_needs_every_thing_of_the_texture(table: Callable[..., TabletopWorld]) -> None:
    world = table("twist", 0, lambda truth: len(truth["goals"]) == 2)
    texture = world.privileged.truth()["words"]["texture"]
    assert {_things(world)[goal["thing"]]["texture"] for goal in _goals(world)} == {texture}
    *_, last = world.privileged.oracle()
    world.execute(last)
    assert not _verdict(world)[0]
    world.execute(world.privileged.oracle()[0])
    assert _verdict(world)[0]


@pytest.mark.parametrize("name", ["same_texture", "same_shape"])
def test_same_needs_both_in_any_order_and_no_other(table: Callable[..., TabletopWorld], name: str) -> None:
    world = table(name)
    first, second = _goals(world)
    base = first["near"][0]
    _move(world, second["thing"], _at(world, base))
    assert not _verdict(world)[0]
    _move(world, first["thing"], _at(world, base))
    assert _verdict(world)[0]
    wrong = table(name)
    _move(wrong, wrong.privileged.truth()["distractors"][0], _at(wrong, base))
    success, reason = _verdict(wrong)
    assert not success
    assert "distractor" in reason


def test_same_is_stricter_with_a_bowl(table: Callable[..., TabletopWorld]) -> None:
    def within(truth: dict) -> float:
        return truth["goals"][0]["within_m"]

    bowl = table("same_texture", 0, lambda truth: truth["things"][truth["slots"]["base_obj"]]["shape"] == "bowl")
    other = table("same_texture", 0, lambda truth: truth["things"][truth["slots"]["base_obj"]]["shape"] != "bowl")
    assert (within(bowl.privileged.truth()), within(other.privileged.truth())) == (0.0875, 0.125)


def test_follow_motion_must_make_every_step_in_order(table: Callable[..., TabletopWorld]) -> None:
    world = table("follow_motion")
    name, spots = _goals(world)[0]["thing"], [_goals(world, k)[0]["at_m"] for k in (0, 1)]
    _move(world, name, spots[0])
    assert not _verdict(world)[0]
    _move(world, name, spots[1])
    assert _verdict(world)[0]
    skipped = table("follow_motion")
    _move(skipped, name, spots[1])
    _move(skipped, name, spots[0])
    _move(skipped, name, spots[1])
    assert not _verdict(skipped)[0], "the second place was reached first"


def test_follow_motion_a_missed_pick_fails(table: Callable[..., TabletopWorld]) -> None:
    world = table("follow_motion")
    assert not _verdict(world)[1].startswith("an action")
    empty = (*_bare(world), 0.0)
    world.execute(PickPlace(empty, empty))
    success, reason = _verdict(world)
    assert not success
    assert "did not bring" in reason


def test_follow_order_stacks_in_the_order_of_the_frames(table: Callable[..., TabletopWorld]) -> None:
    world = table("follow_order")
    (middle,), (top,) = _goals(world, 0), _goals(world, 1)
    low = middle["near"][0]
    other = table("follow_order")
    _move(other, top["thing"], _at(other, low))
    _move(other, middle["thing"], _at(other, low))
    assert not _verdict(other)[0], "the right things in the wrong order"
    _move(world, middle["thing"], _at(world, low))
    _move(world, top["thing"], _at(world, low))
    assert _verdict(world)[0]


def test_old_neighbour_comes_second(table: Callable[..., TabletopWorld]) -> None:
    world = table("manipulate_old_neighbor")
    (first,), (second,) = _goals(world, 0), _goals(world, 1)
    base = first["near"][0]
    _move(world, first["thing"], _at(world, base))
    assert not _verdict(world)[0]
    _move(world, second["thing"], _at(world, base))
    assert _verdict(world)[0]
    turned = table("manipulate_old_neighbor")
    _move(turned, second["thing"], _at(turned, base))
    _move(turned, first["thing"], _at(turned, base))
    success, reason = _verdict(turned)
    assert not success
    assert "before the next one" in reason
    assert turned.privileged.score().stage == "plan"


def test_another_neighbour_is_a_distractor(table: Callable[..., TabletopWorld]) -> None:
    world = table("manipulate_old_neighbor")
    truth = world.privileged.truth()
    carried, base = truth["slots"]["dragged_obj"], truth["slots"]["base_obj"]
    step = {"north": (-1, 0), "south": (1, 0), "west": (0, -1), "east": (0, 1)}[truth["words"]["direction"]]
    second = truth["phases"][1][0]["thing"]
    way = np.subtract(truth["things"][second]["position_m"][:2], truth["things"][carried]["position_m"][:2])
    assert np.allclose(way / np.linalg.norm(way), step, atol=0.05), "the neighbour is where the words say"
    _move(world, carried, _at(world, base))
    _move(world, truth["distractors"][0], _at(world, base))
    assert "distractor" in _verdict(world)[1]


def test_pick_in_order_then_restore(table: Callable[..., TabletopWorld]) -> None:
    world = table("pick_in_order_then_restore")
    name = _goals(world)[0]["thing"]
    boxes = [_goals(world, k)[0]["near"][0] for k in range(3)]
    own, free = boxes[2], [n for n, t in _things(world).items() if not t["movable"] and n not in boxes][0]
    _move(world, name, _at(world, free))
    assert not _verdict(world)[1].startswith(name), "a container that no one named is no failure"
    for box in boxes:
        assert not _verdict(world)[0]
        _move(world, name, _at(world, box))
    assert _verdict(world)[0]
    skipping = table("pick_in_order_then_restore")
    _move(skipping, name, _at(skipping, boxes[1]))
    assert "before the next one" in _verdict(skipping)[1]
    early = table("pick_in_order_then_restore")
    for box in (boxes[0], own, boxes[1], own):
        assert not _verdict(early)[0]
        _move(early, name, _at(early, box))
    assert _verdict(early)[0], "where it came from it may be at any time: that skips nothing"


@pytest.mark.parametrize("name", ["novel_adj", "novel_adj_and_noun"])
def test_the_other_variant_is_wrong(table: Callable[..., TabletopWorld], name: str) -> None:
    world = table(name)
    (goal,) = _goals(world)
    things, base = _things(world), goal["near"][0]
    right = things[goal["thing"]]
    like = [n for n in world.privileged.truth()["distractors"] if things[n]["shape"] == right["shape"]]
    assert len(like) == 1
    assert (things[like[0]]["texture"], things[like[0]]["stretch"]) != (right["texture"], right["stretch"])
    _move(world, like[0], _at(world, base))
    assert "distractor" in _verdict(world)[1]


def test_adjectives_mean_what_their_examples_show(table: Callable[..., TabletopWorld]) -> None:
    for seed in range(12):
        truth = table("novel_adj", seed).privileged.truth()
        things, props, slots = truth["things"], truth["props"], truth["slots"]
        less = truth["words"]["quality"].startswith("less ")
        assert truth["words"]["quality"].removeprefix("less ") == truth["words"]["adjective"]
        right = things[truth["goals"][0]["thing"]]
        wrong = next(things[n] for n in truth["distractors"])
        more, fewer = (wrong, right) if less else (right, wrong)
        for k in (1, 2, 3):
            one, two = (props[slots[f"demo_{w}blicker_obj_{k}"]] for w in ("", "less_"))
            assert one["shape"] == two["shape"]
            assert one["texture"].startswith("dark") == more["texture"].startswith("dark")
            assert two["texture"].startswith("dark") == fewer["texture"].startswith("dark")
            assert np.sign(one["stretch"] - two["stretch"]) == np.sign(more["stretch"] - fewer["stretch"])
        assert more["stretch"] != fewer["stretch"] or more["texture"] != fewer["texture"]


def _push_through(world: TabletopWorld, name: str, to: tuple[float, float]) -> None:
    x, y, _ = _at(world, name)
    way = np.subtract(to, (x, y)) / math.dist(to, (x, y))
    world.execute(Push((*((x, y) - 0.035 * way), 0.0), (*to, 0.0)))


def _frame(world: TabletopWorld) -> tuple[np.ndarray, np.ndarray]:
    """Middle of the frame and the unit vector out of its open side."""
    frame = _things(world)[world.privileged.truth()["slots"]["bounds"]]
    yaw = frame["yaw_rad"]
    return np.array(frame["position_m"][:2]), np.array([-math.cos(yaw), -math.sin(yaw)])


def _solve(world: TabletopWorld) -> None:
    while world.privileged.oracle():
        world.execute(world.privileged.oracle()[0])


def test_sweep_exactly_so_many(table: Callable[..., TabletopWorld]) -> None:
    world = table("sweep_without_exceeding", 0, lambda t: t["words"]["number"] == "any" and len(t["things"]) == 6)
    (count,) = world.privileged.truth()["counts"]
    assert count["exactly"] == 1
    _solve(world)
    assert _verdict(world)[0]
    (done,) = world.privileged.truth()["counted"]
    assert len(done) == 1


def test_sweep_one_too_many_fails(table: Callable[..., TabletopWorld]) -> None:
    world = table(
        "sweep_without_exceeding", 0, lambda t: t["counts"][0]["exactly"] == 2 == len(t["counts"][0]["things"])
    )
    _solve(world)
    assert _verdict(world)[0]
    again = table(
        "sweep_without_exceeding", 0, lambda t: t["counts"][0]["exactly"] == 1 and len(t["counts"][0]["things"]) > 1
    )
    middle, out = _frame(again)
    for name in again.privileged.truth()["counts"][0]["things"]:
        again.privileged.nudge(name, *(middle + 0.3 * out - _at(again, name)[:2]))
    assert not _verdict(again)[0]
    first, second = again.privileged.truth()["counts"][0]["things"][:2]
    spots = [middle + 0.03 * out + sign * 0.06 * np.array([-out[1], out[0]]) for sign in (1, -1)]
    for name, spot in zip((first, second), spots, strict=True):
        again.privileged.nudge(name, *(spot - _at(again, name)[:2]))
    edge = middle + 0.4 * out
    again.execute(Push((*edge, 0.0), (*(edge + 0.02 * out), 0.0)))
    success, reason = _verdict(again)
    assert not success
    assert "exactly 1 may" in reason


@pytest.mark.parametrize("name", ["sweep_without_exceeding", "sweep_without_touching"])
def test_sweep_straight_over_the_line_fails_even_if_it_ends_well(
    table: Callable[..., TabletopWorld], name: str
) -> None:
    world = table(name)
    (count,) = world.privileged.truth()["counts"]
    middle, out = _frame(world)
    block = count["things"][0]
    world.privileged.nudge(block, *(middle + 0.17 * out - _at(world, block)[:2]))
    _push_through(world, block, tuple(middle - 0.04 * out))
    success, reason = _verdict(world)
    assert not success
    assert "touched" in reason
    assert world.privileged.score().stage == "plan"


def test_sweep_another_block_in_the_zone_fails(table: Callable[..., TabletopWorld]) -> None:
    world = table("sweep_without_exceeding")
    (count,) = world.privileged.truth()["counts"]
    middle, out = _frame(world)
    stranger = count["strangers"][0]
    world.privileged.nudge(stranger, *(middle + 0.17 * out - _at(world, stranger)[:2]))
    _push_through(world, stranger, tuple(middle + 0.06 * out))
    assert "came into the zone" in _verdict(world)[1]
    assert world.privileged.score().stage == "wrong object"


def test_a_push_is_reported_as_a_robot_measures_it(table: Callable[..., TabletopWorld]) -> None:
    world = table("sweep_without_touching")
    middle, out = _frame(world)
    assert world.vocabulary.kinds == ("push",)
    nothing = world.execute(Push((0.5, 0.0, 0.0), (0.5, 0.0, 0.0)))
    assert "no direction" in nothing.fault
    wall = world.execute(Push((*(middle + 0.05 * out), 0.0), (*(middle - 0.12 * out), 0.0)))
    assert wall.executed
    assert wall.measured["short_of_end_m"] == pytest.approx(0.034, abs=0.01), "the blade stops at the wall"
    assert not set(map(str, wall.measured)) & set(_things(world))
