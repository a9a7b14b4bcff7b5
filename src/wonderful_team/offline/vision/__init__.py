"""Classical computer vision: what a picture of a table shows, read from its pixels (and depth if given) and nothing else."""

from wonderful_team.offline.vision.examples import likeness, study_example
from wonderful_team.offline.vision.heights import with_heights
from wonderful_team.offline.vision.light import in_plain_light
from wonderful_team.offline.vision.measure import BoxFit, fit_box, strip_presence
from wonderful_team.offline.vision.resolve import resolve, suits
from wonderful_team.offline.vision.scene import see
from wonderful_team.offline.vision.spots import free_spots
from wonderful_team.offline.vision.things import Example, Match, NotSeen, Scene, Thing

__all__ = [
    "BoxFit",
    "Example",
    "Match",
    "NotSeen",
    "Scene",
    "Thing",
    "fit_box",
    "free_spots",
    "in_plain_light",
    "likeness",
    "resolve",
    "see",
    "strip_presence",
    "study_example",
    "suits",
    "with_heights",
]
