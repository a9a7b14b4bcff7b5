"""Models around a model. Injecting plants a labelled fault, so that one can watch the team catch it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from wonderful_team.contracts import BoxPx
from wonderful_team.contracts.give_box import BoxAnswer
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Answer, Request
from wonderful_team.models.client import as_answer, call_model, validate_answer

SHIFT_RADII = 1.2


@dataclass
class Injection:
    """One planted fault; it strikes once.

    Attributes:
        contracts: Kinds of question that it may strike.
        change: Takes a right answer's value and the request; gives the wrong value, or None to wait for a better chance.
        label: What it is, for the record and the page.
    """

    contracts: tuple[str, ...]
    change: Callable[[Any, Request], Any | None]
    label: str
    struck: bool = field(default=False, init=False)


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
            if not injection.struck and request.contract in injection.contracts:
                value, _ = validate_answer(request, answer.value)
                changed = injection.change(value, request)
                if changed is not None:
                    injection.struck = True
                    return replace(
                        answer, value=changed, raw="", provenance="injected", repairs=(f"injected: {injection.label}",)
                    )
        return answer


def shift_box(value: Any, request: Request) -> BoxAnswer | None:
    """A box that was found, shifted by SHIFT_RADII half-widths towards the middle of the picture."""
    if not isinstance(value, BoxAnswer) or value.box is None:
        return None
    box, middle = value.box, request.question.view.size_px[0] / 2
    dx = SHIFT_RADII * (box.x1 - box.x0) / 2 * (1 if (box.x0 + box.x1) / 2 < middle else -1)
    return value.model_copy(update={"box": BoxPx(x0=box.x0 + dx, y0=box.y0, x1=box.x1 + dx, y1=box.y1)})
