"""An own task for the tabletop: run it with

wonderful-team run examples/own_task.py:blocks --seed 3
"""

import numpy as np

import wonderful_team as wt

COLOURS = ("red", "green", "blue", "yellow")


@wt.task("mine/blocks", instruction="Put the {block} block into the {bowl} bowl.", horizon=1)
def blocks(scene: wt.Scene, rng: np.random.Generator) -> None:
    """One block, one bowl, and a block of another colour that must stay where it is."""
    block, bowl, other = (COLOURS[k] for k in rng.permutation(len(COLOURS))[:3])
    target = scene.add("bowl", bowl)
    carried = scene.add("block", block)
    scene.add("block", other, distractor=True)
    scene.say(block=block, bowl=bowl)
    scene.goal(carried, near=target)


if __name__ == "__main__":
    world = wt.make_world("tabletop/mine/blocks", seed=3)
    trial = wt.rollout(wt.Team(model="offline"), world, seed=3)
    print(world.instruction.text, "->", trial.outcome, trial.stage or "", trial.reason)
    world.close()
