"""Perception laboratory: what does a model see, and in which numbers does it say so?"""

from wonderful_team.lab.fit import Fit, Sighting, fit_convention
from wonderful_team.lab.marks import Mark, MarkedScene, marked_scene
from wonderful_team.lab.measure import LabScene, LabTarget, measure_errors
from wonderful_team.lab.probe import Options, Probed, Subject, probe

__all__ = [
    "Fit",
    "LabScene",
    "LabTarget",
    "Mark",
    "MarkedScene",
    "Options",
    "Probed",
    "Sighting",
    "Subject",
    "fit_convention",
    "marked_scene",
    "measure_errors",
    "probe",
]
