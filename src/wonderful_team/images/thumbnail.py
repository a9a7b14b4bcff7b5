"""A small picture of a run, inside of a page of many."""

from __future__ import annotations

import base64
import io
from pathlib import Path

from wonderful_team.images.load import OWN_FORMATS, open_picture

THUMBNAIL_PX = 320


def run_thumbnail(folder: Path) -> str:
    """A small picture of a run as a data address: its plan, else its last view; "" without any."""
    views = [folder / "final.png", *sorted((folder / "pictures").glob("view_*.png"), reverse=True)]
    for path in views:
        try:
            with open_picture(path, OWN_FORMATS) as opened:
                image = opened.convert("RGB")
        except OSError:
            continue
        image.thumbnail((THUMBNAIL_PX, THUMBNAIL_PX * 4))
        buffer = io.BytesIO()
        image.save(buffer, format="WEBP", quality=80)
        return "data:image/webp;base64," + base64.b64encode(buffer.getvalue()).decode()
    return ""
