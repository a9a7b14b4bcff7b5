"""Geometry of pictures and of the table: boxes, frames, poses, cameras. numpy only."""

from wonderful_team.core.geometry.boxes import Box
from wonderful_team.core.geometry.cameras import AffineCamera, Camera, PinholeCamera, PlanarCamera
from wonderful_team.core.geometry.frames import Frame
from wonderful_team.core.geometry.poses import Pose, wrap_angle

__all__ = ["AffineCamera", "Box", "Camera", "Frame", "PinholeCamera", "PlanarCamera", "Pose", "wrap_angle"]
