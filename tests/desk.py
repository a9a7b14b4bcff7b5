"""A drawn photo of two things on a desk, with depth and a camera: what tests of records and kept answers plan for."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np

WORDS = "put the red circle on the blue square"


def draw_desk(folder: Path) -> Path:
    """Write desk.png, depth.png and camera.json into a folder; returns the folder."""
    rgb = np.full((240, 320, 3), (150, 170, 186), np.uint8)
    cv2.circle(rgb, (80, 150), 26, (200, 60, 40), -1, cv2.LINE_AA)
    cv2.rectangle(rgb, (200, 60), (260, 120), (30, 80, 180), -1)
    depth = np.full((240, 320), 800, np.uint16)
    cv2.circle(depth, (80, 150), 26, 760, -1)
    depth[60:120, 200:260] = 780
    cv2.imwrite(str(folder / "desk.png"), rgb[..., ::-1])
    cv2.imwrite(str(folder / "depth.png"), depth)
    pose = [[0, -1, 0, 0.5], [-1, 0, 0, 0], [0, 0, -1, 0.8], [0, 0, 0, 1]]
    camera = {"K": [[400, 0, 160], [0, 400, 120], [0, 0, 1]], "T_base_cam": pose, "size_px": [320, 240]}
    (folder / "camera.json").write_text(json.dumps(camera), encoding="utf-8")
    return folder


def read_record(folder: Path) -> Any:
    """A run's record."""
    return json.loads((Path(folder) / "record.json").read_text(encoding="utf-8"))
