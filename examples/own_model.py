"""An own model: anything with answer(request). This one counts what it is asked and lets `offline` answer. Run it with

    wonderful-team run tabletop/rotate --seed 3 --model examples/own_model.py:Counting

A client of a vision-language model would render `request.system` and `request.parts` (words, and pictures that
`wonderful_team.images.draw` turns into pixels), send them, and return the JSON text that comes back.
"""

from collections import Counter
from typing import Any

import wonderful_team as wt


class Counting:
    """Passes every request on and counts it by role and kind of question."""

    name = "counting"

    def __init__(self) -> None:
        self.asked: Counter[str] = Counter()
        self.inner = wt.make_model("offline")

    def answer(self, request: wt.Request) -> Any:
        """The answer to one request: an Answer, a value of `request.output`, a dict, or JSON text."""
        self.asked[f"{request.role}: {request.contract}"] += 1
        return self.inner.answer(request)


if __name__ == "__main__":
    model = Counting()
    trial = wt.rollout(wt.Team(model=model), wt.make_world("tabletop/rotate", seed=3))
    print(trial.outcome, trial.reason)
    for kind, count in model.asked.most_common():
        print(f"{count:3d}  {kind}")
