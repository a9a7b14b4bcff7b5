"""Materials by eye: brick, wood, granite, … from colours and texture."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wonderful_team.offline.vision.things import Look


def material_score(look: Look, material: str) -> float:
    """How much a surface looks like a material, 0 to 1."""
    return float(np.clip(_JUDGES[material](look), 0, 1))


def _share(look: Look, *names: str) -> float:
    return sum(look.memberships[name] for name in names)


def _enough(share: float, needed: float) -> float:
    """0 without any, 1 from the needed share on."""
    return float(np.clip(share / needed, 0, 1))


def _rough(look: Look) -> float:
    """How far the surface is not plain, 0 to 1."""
    return 1 - look.patterns["plain"]


def _brick(look: Look) -> float:
    warm = _enough(_share(look, "red", "orange", "brown"), 0.5)
    joints = _enough(_share(look, "white", "grey", "brown", "pink"), 0.12)
    no_dark = 1 - _enough(_share(look, "black"), 0.2)
    return warm * (0.5 + 0.5 * joints) * (0.35 + 0.65 * look.surface.checks) * _rough(look) * no_dark


def _tile(look: Look) -> float:
    lines = float(np.clip((0.46 - look.surface.rare_share) / 0.08, 0, 1))
    warm = _enough(_share(look, "red", "brown", "orange"), 0.5)
    return max(look.surface.checks * (0.4 + 0.6 * lines) * _rough(look) * (1 - 0.5 * warm), _mosaic(look))


def _mosaic(look: Look) -> float:
    """Small grey tiles with a few tinted ones among them."""
    tinted = _enough(_share(look, "red", "green", "brown", "olive", "cyan"), 0.18)
    plain_light = float(np.clip((_share(look, "white", "black") - 0.1) / 0.15, 0, 1))
    return _enough(_share(look, "grey"), 0.5) * tinted * look.patterns["mottled"] * (1 - plain_light)


def _wood(look: Look) -> float:
    grain = float(np.clip((look.surface.edges - 0.9) / 0.8, 0, 1)) * (1 - look.patterns["checkered"])
    return grain * _enough(_share(look, "brown", "orange", "olive"), 0.75) * _enough(_share(look, "brown"), 0.3)


def _granite(look: Look) -> float:
    grey = float(np.clip((_share(look, "grey", "white", "black") - 0.55) / 0.3, 0, 1))
    grain = float(np.clip((look.surface.edges - 0.4) / 0.8, 0, 1))
    orderly = max(look.patterns[name] for name in ("striped", "dotted", "checkered"))
    return grey * (0.35 + 0.65 * grain) * (1 - 0.8 * orderly)


def _plastic(look: Look) -> float:
    calm = 1 - max(look.patterns[name] for name in ("striped", "dotted", "checkered", "multicoloured"))
    pale = _enough(_share(look, "white", "grey"), 0.7)
    smooth = float(np.clip((14 - look.surface.contrast) / 8, 0, 1))
    return calm * smooth * (0.45 + 0.55 * pale)


def _tiger(look: Look) -> float:
    coat = _enough(_share(look, "orange", "yellow", "brown"), 0.35)
    bands = _enough(_share(look, "black") + 0.3 * _share(look, "grey"), 0.14)
    mostly_coat = float(np.clip((_share(look, "orange", "yellow") - 0.2) / 0.2, 0, 1))
    return coat * bands * (0.4 + 0.6 * mostly_coat) * _rough(look)


def _lava(look: Look) -> float:
    crust = _enough(sum(c.share for c in look.colours if c.lab[0] < 32 or c.name == "black"), 0.3)
    glow = _enough(_share(look, "orange", "yellow", "red", "brown"), 0.15)
    tangled = float(np.clip((0.6 - look.surface.one_way) / 0.2, 0, 1))
    mostly_crust = float(np.clip((0.62 - _share(look, "orange", "yellow")) / 0.2, 0, 1))
    return crust * glow * tangled * mostly_crust * _rough(look)


def _paisley(look: Look) -> float:
    swirled = max(look.patterns["swirled"], look.patterns["dotted"], look.patterns["mottled"])
    one_hue = float(np.clip((3.5 - look.surface.hues) / 1.0, 0, 1))
    soft = float(np.clip((32 - look.surface.contrast) / 10, 0.3, 1))
    return swirled * one_hue * soft


_JUDGES: dict[str, Callable[[Look], float]] = {
    "brick": _brick,
    "tile": _tile,
    "wood": _wood,
    "granite": _granite,
    "plastic": _plastic,
    "tiger": _tiger,
    "lava": _lava,
    "paisley": _paisley,
}
