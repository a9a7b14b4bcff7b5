"""Views become pictures with marks, and pictures become pixels to look at."""

from wonderful_team.images.axes import Ticks
from wonderful_team.images.calibration import load_depth
from wonderful_team.images.candidates import beside_points, inside_points
from wonderful_team.images.compare import CHANGED, region_change
from wonderful_team.images.cut import Edge, StripSide, across_edge, crop, edge_strips, whole
from wonderful_team.images.draw import draw, line_width_px
from wonderful_team.images.encode import to_jpeg, to_png
from wonderful_team.images.load import OWN_FORMATS, load_picture, open_picture
from wonderful_team.images.overview import action_arrows, overview, swept_width, swept_widths
from wonderful_team.images.resample import picture_of, resampled, resampled_depth, same_pixels, valid_mask
from wonderful_team.images.turn_marks import action_turns, seen_from_above

__all__ = [
    "CHANGED",
    "Edge",
    "StripSide",
    "Ticks",
    "action_arrows",
    "action_turns",
    "beside_points",
    "crop",
    "draw",
    "across_edge",
    "edge_strips",
    "inside_points",
    "line_width_px",
    "load_depth",
    "load_picture",
    "open_picture",
    "OWN_FORMATS",
    "overview",
    "picture_of",
    "region_change",
    "resampled",
    "resampled_depth",
    "same_pixels",
    "seen_from_above",
    "swept_width",
    "swept_widths",
    "to_jpeg",
    "to_png",
    "valid_mask",
    "whole",
]
