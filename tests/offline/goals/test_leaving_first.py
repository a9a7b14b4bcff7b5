"""A place that a thing leaves anyway is left before another thing goes there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import wonderful_team as wt
from wonderful_team.offline.description import Description
from wonderful_team.offline.goals.aims import Aim, Named
from wonderful_team.offline.goals.clearing import leaving_first

BOWL, TRAY, TABLE, SHELF = 10, 11, 12, 13


@dataclass
class Standing:
    on: int | None


class Eyes:
    """Things by number, and what each stands on."""

    def __init__(self, **on: int) -> None:
        self.on = {int(name[1:]): place for name, place in on.items()}

    def thing(self, number: int | None) -> Standing | None:
        return None if number is None else Standing(self.on.get(number))


def put(thing: int, place: int) -> Aim:
    named = (Named(Description("object", f"thing {number}"), number) for number in (thing, place))
    return Aim("put", next(named), "in", next(named))


def order(aims: list[Aim], **on: int) -> list[int | None]:
    eyes: Any = Eyes(**on)
    return [aim.thing.number for aim in leaving_first(aims, eyes)]


def test_what_stands_in_a_place_leaves_it_before_another_comes() -> None:
    assert order([put(1, BOWL), put(2, TRAY)], _1=TABLE, _2=BOWL) == [2, 1]
    assert order([put(1, BOWL), put(2, TRAY), put(3, SHELF)], _1=TABLE, _2=BOWL, _3=TRAY) == [3, 2, 1]


def test_the_order_stays_where_nothing_is_in_the_way() -> None:
    assert order([put(1, BOWL), put(2, TRAY)], _1=TABLE, _2=TABLE) == [1, 2]
    assert order([put(1, BOWL), put(2, BOWL)], _1=TABLE, _2=BOWL) == [1, 2]  # it is there already


def test_two_that_change_places_and_a_stated_order_stay_as_they_are() -> None:
    assert order([put(1, BOWL), put(2, TRAY)], _1=TRAY, _2=BOWL) == [1, 2]
    assert order([put(1, BOWL), replace(put(2, TRAY), after=(0,))], _1=TABLE, _2=BOWL) == [1, 2]


def test_a_plum_in_the_yellow_area_leaves_before_the_banana_comes(tmp_path: Path) -> None:
    trial = wt.rollout(wt.Team(model="offline"), "tabletop/fruit_placement/both", seed=760015, replans=0, out=tmp_path)
    assert trial.outcome == "success", trial.reason
