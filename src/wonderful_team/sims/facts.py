"""What planners are told of a robot over a table that is seen from above and from the front, in plain words."""

from __future__ import annotations

_ALWAYS = (
    "Reach: the whole table that the top view shows, and nothing beyond its edge.",
    "Views: the top camera looks straight down; the front camera looks down at 45 degrees from the side that is the lower edge of "
    "the top view. The robot itself is not shown.",
    "North is the upper edge of the top view, south the lower, west the left, east the right.",
    "A turn without a direction is clockwise, seen from above.",
    "Where a picture shows a goal or a stage of a motion, the place of each thing counts, not how it is turned. A pair of "
    "pictures from before and after shows a turn, which counts.",
)


def suction_facts(cup_m: float | None = None) -> str:
    """One fact a line, for a suction cup of this diameter [m]."""
    size = "" if cup_m is None else f", {1000 * cup_m:.0f} mm across"
    return "\n".join(
        (
            f"Tool: a suction cup{size}. It holds one thing at a time, by a solid spot on its upper side; it cannot hold at a hole, "
            "over an edge or on bare table.",
            "A thing that is picked up is carried over all others, never through them, and set down on whatever lies below.",
            *_ALWAYS,
        )
    )


def blade_facts(blade_m: float) -> str:
    """One fact a line, for a blade of this width [m] that pushes."""
    return "\n".join(
        (
            f"Tool: a flat blade, {100 * blade_m:.0f} cm wide, across the way of the push. It comes down on the table at the start, "
            "moves straight to the end, and is lifted there. Whatever is loose in its way is pushed along.",
            "Nothing is lifted: a thing that is pushed slides on the table, may turn and drift a little, and cannot pass through "
            "walls or over other things.",
            *_ALWAYS,
        )
    )
