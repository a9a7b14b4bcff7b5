"""An own world: three coloured tiles on a grey desk, seen by a camera straight above. Run it with

wonderful-team run examples/own_world.py:TileDesk "put the red square to the left of the blue square"
"""

import numpy as np

import wonderful_team as wt

PIXELS_PER_M = 800.0
TILE_M = 0.06
THICK_M = 0.02
COLOURS = ((200, 40, 40), (40, 70, 200), (40, 150, 60))


class TileDesk:
    """A desk of 0.5 x 0.8 m; x runs down the picture, y to the right, z up."""

    vocabulary = wt.PICK_PLACE
    limits = wt.Limits(low_m=(0.0, 0.0, -0.01), high_m=(0.5, 0.8, 0.4))
    instruction = wt.Instruction("put the red square to the left of the blue square")
    facts = (
        "Tool: a suction cup; it carries one tile at a time, over all others.\nNorth is the upper edge of the picture."
    )

    def __init__(self, seed: int = 0) -> None:
        # Where the tiles' centres are, shape (3, 2) [m].
        self.tiles_m = np.column_stack([np.full(3, 0.25), np.random.default_rng(seed).permutation([0.2, 0.45, 0.7])])
        # Pixels and depth from (x, y, z, 1): u follows y, v follows x, and the lens hangs 1 m above the desk.
        self.camera = wt.AffineCamera(np.array([[0, PIXELS_PER_M, 0, 0], [PIXELS_PER_M, 0, 0, 0], [0, 0, -1, 1.0]]))

    def observe(self) -> wt.Observation:
        """The picture from above, with its depth."""
        rgb, depth_m = np.full((400, 640, 3), 150, np.uint8), np.ones((400, 640))
        for centre_m, colour in zip(self.tiles_m, COLOURS, strict=True):
            low, high = np.rint((centre_m - TILE_M / 2) * PIXELS_PER_M), np.rint((centre_m + TILE_M / 2) * PIXELS_PER_M)
            tile = tuple(slice(int(a), int(b)) for a, b in zip(low, high, strict=True))
            rgb[tile], depth_m[tile] = colour, 1.0 - THICK_M
        return wt.Observation({"top": wt.View("top", "top", 0.0, rgb, depth_m, self.camera)})

    def execute(self, action: wt.PickPlace) -> wt.StepReport:
        """Move the tile under the pick point, if there is one."""
        under = np.abs(self.tiles_m - action.pick_m[:2]).max(axis=1) <= TILE_M / 2
        self.tiles_m[under] = action.place_m[:2]
        return wt.StepReport(action, executed=True, measured={"holding": bool(under.any())})


if __name__ == "__main__":
    trial = wt.rollout(wt.Team(model="offline"), wt.make_world(f"{__file__}:TileDesk", seed=1))
    print(trial.outcome, trial.stage or "", trial.reason)
