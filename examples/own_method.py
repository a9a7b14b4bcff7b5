"""An own method: a class with the Policy interface. This one stirs at random, as a floor to compare with. Run it with

    wonderful-team run tabletop/rotate --seed 3 --method examples/own_method.py:Stirring

A method that asks a model takes `client` as a parameter of its constructor: questions asked there are capped and recorded.
"""

import numpy as np

import wonderful_team as wt


class Stirring:
    """Picks somewhere, places somewhere, once."""

    name = "stirring"

    def __init__(self) -> None:
        self.rng = np.random.default_rng(0)

    def decide(self, situation: wt.Situation) -> wt.Act | wt.Done:
        """The next actions, or that it is done."""
        if situation.executed:
            return wt.Done("stirred once")
        view = situation.observation.main
        low, high = np.array(situation.limits.low_m), np.array(situation.limits.high_m)
        ends = (0.9 * self.rng.random((2, 3)) + 0.05) * (high - low) + low
        # The height of an action is that of the surface it touches: what depth shows at that pixel.
        pixels = view.camera.project(ends * (1.0, 1.0, 0.0))
        depths_m = [view.depth_m[int(v), int(u)] for u, v in pixels]
        pick, place = np.clip(view.camera.deproject(pixels, depths_m), low, high)
        step = wt.PickPlaceStep("G1", pick="somewhere", place=wt.At("elsewhere"))
        return wt.Act((wt.PlannedAction(step, wt.PickPlace(pick, place)),))


if __name__ == "__main__":
    trial = wt.rollout(Stirring(), wt.make_world("tabletop/rotate", seed=3))
    print(trial.outcome, trial.reason)
