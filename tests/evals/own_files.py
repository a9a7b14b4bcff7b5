"""A method and a world as a user writes them, for tests of `bench` and `check`."""

from __future__ import annotations

METHOD = """
import wonderful_team as wt


class Pusher:
    name = "pusher"

    def decide(self, situation: wt.Situation) -> wt.Act | wt.Done:
        if situation.executed:
            return wt.Done("moved once")
        low, high = situation.limits.low_m, situation.limits.high_m
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        step = wt.PickPlaceStep("G1", pick="middle", place=wt.At("corner"))
        return wt.Act((wt.PlannedAction(step, wt.PickPlace([*middle[:2], 0.0], [low[0] + 0.05, low[1] + 0.05, 0.0])),))
"""

LENIENT = '''
"""A desk whose scorer calls everything a success, and whose seeds are all the same."""

import numpy as np

import wonderful_team as wt


class Truth:
    def score(self):
        return wt.Score(True, None, "looks fine")

    def truth(self):
        return {}

    def oracle(self):
        return (wt.PickPlace(np.array([0.2, 0.2, 0.0]), np.array([0.3, 0.3, 0.0])),)


class AgentSession:
    vocabulary = wt.PICK_PLACE
    limits = wt.Limits((0.0, 0.0, -0.01), (0.5, 0.5, 0.4))
    instruction = wt.Instruction("tidy the desk")
    privileged = Truth()

    def __init__(self, seed: int = 0) -> None:
        self.camera = wt.AffineCamera(np.array([[0, 400.0, 0, 0], [400.0, 0, 0, 0], [0, 0, -1, 1.0]]))

    def observe(self):
        rgb, depth_m = np.full((200, 200, 3), 150, np.uint8), np.full((200, 200), 1000.0)
        return wt.Observation({"top": wt.View("top", "top", 0.0, rgb, depth_m, self.camera)})

    def execute(self, action):
        return wt.StepReport(action, True)
'''
