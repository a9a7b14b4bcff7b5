"""Models around a model. Injecting plants a labelled fault, so that one can watch the team catch it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from wonderful_team.contracts import BoxPx, PointPx, SceneReading
from wonderful_team.contracts.give_box import BoxAnswer
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Answer, Request
from wonderful_team.models.client import as_answer, call_model, validate_answer


@dataclass
class Injection:
    """One planted fault.

    Attributes:
        contracts: Kinds of question that it may strike.
        change: Takes a right answer's value and the request; gives the wrong value, or None to wait for a better chance.
        label: What it is, for the record and the page.
        times: How often it strikes.
    """

    contracts: tuple[str, ...]
    change: Callable[[Any, Request], Any | None]
    label: str
    times: int = 1
    struck: int = field(default=0, init=False)


class Injecting:
    """Passes requests to `model` and spoils the answers that the injections name; those are labelled `injected`."""

    def __init__(self, model: Model, injections: Sequence[Injection]) -> None:
        self.model = model
        self.injections = tuple(injections)
        self.name = f"{getattr(model, 'name', type(model).__name__)}+injected"

    async def answer(self, request: Request) -> Answer:
        """The model's answer, perhaps spoiled."""
        answer = as_answer(await call_model(self.model, request), self.model)
        for injection in self.injections:
            if injection.struck < injection.times and request.contract in injection.contracts:
                value, _ = validate_answer(request, answer.value)
                changed = injection.change(value, request)
                if changed is not None:
                    injection.struck += 1
                    return replace(
                        answer, value=changed, raw="", provenance="injected", repairs=(f"injected: {injection.label}",)
                    )
        return answer


def shift_box(radii: float = 1.2) -> Callable[[Any, Request], Any | None]:
    """A change that shifts the first found box by `radii` half-widths towards the middle of the picture."""

    def change(value: Any, request: Request) -> Any | None:
        middle = request.question.view.size_px[0] / 2
        if isinstance(value, BoxAnswer) and value.box is not None:
            return value.model_copy(update={"box": _shifted(value.box, radii, middle)})
        if isinstance(value, SceneReading):
            for position, item in enumerate(value.targets):
                if item.box is None:
                    continue
                box = _shifted(item.box, radii, middle)
                dx = box.x0 - item.box.x0
                points = [p.model_copy(update={"point": PointPx(x=p.point.x + dx, y=p.point.y)}) for p in item.points]
                wrong = item.model_copy(update={"box": box, "points": points})
                return value.model_copy(
                    update={"targets": [*value.targets[:position], wrong, *value.targets[position + 1 :]]}
                )
        return None

    return change


def _shifted(box: BoxPx, radii: float, middle: float) -> BoxPx:
    radius = (box.x1 - box.x0) / 2
    dx = radii * radius * (1 if (box.x0 + box.x1) / 2 < middle else -1)
    return BoxPx(x0=box.x0 + dx, y0=box.y0, x1=box.x1 + dx, y1=box.y1)
