"""Seamless square tiles, drawn in code: each function gives one tile, shape (SIDE_PX, SIDE_PX, 3), floats 0 to 255."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from wonderful_team.core.geometry.arrays import Array

Colour: TypeAlias = tuple[int, int, int]
SIDE_PX = 128
"""Side of a tile [px]."""
TILE_M = 0.11
"""Side of a tile on a thing [m]."""


def mixed(first: Colour, second: Colour, share: float) -> Colour:
    """A colour between two, `share` of the second."""
    red, green, blue = (round((1 - share) * a + share * b) for a, b in zip(first, second, strict=True))
    return red, green, blue


def tile_grid() -> tuple[Array, Array]:
    """Tile coordinates in 0..1, (row, column), at pixel centres."""
    steps = (np.arange(SIDE_PX) + 0.5) / SIDE_PX
    v, u = np.meshgrid(steps, steps, indexing="ij")
    return v, u


def noise(seed: int, low: float, high: float) -> Array:
    """Seamless noise in -1..1 with wavelengths between 1/high and 1/low of a tile."""
    rng = np.random.default_rng(seed)
    spectrum = np.fft.fft2(rng.standard_normal((SIDE_PX, SIDE_PX)))
    frequency = np.fft.fftfreq(SIDE_PX) * SIDE_PX
    radius = np.hypot(*np.meshgrid(frequency, frequency, indexing="ij"))
    field = np.real(np.fft.ifft2(spectrum * ((radius >= low) & (radius <= high))))
    return np.asarray(np.clip(field / (2.2 * field.std()), -1, 1))


def blended(weight: Array, first: Colour, second: Colour) -> Array:
    """Two colours mixed pixel by pixel, `weight` of the second."""
    w = np.clip(weight, 0, 1)[..., None]
    return np.asarray((1 - w) * np.array(first) + w * np.array(second))


def _ramp(value: Array, colours: list[Colour]) -> Array:
    stops = np.linspace(0, 1, len(colours))
    return np.stack([np.interp(value, stops, [c[k] for c in colours]) for k in range(3)], axis=-1)


def _edge(distance: Array, softness: float = 0.02) -> Array:
    """0 where distance is negative, 1 where positive, soft between."""
    return np.asarray(np.clip(distance / softness + 0.5, 0, 1))


def stripe(first: Colour, second: Colour) -> Array:
    v, u = tile_grid()
    return blended(_edge(np.sin(2 * np.pi * 3 * (u + v) / 1.0), 0.35), first, second)


def dots(ground: Colour, dot: Colour, count: int = 3, radius: float = 0.31) -> Array:
    v, u = tile_grid()
    away = np.full(u.shape, 9.0)
    for row in range(-1, 2 * count + 1):
        shift = 0.5 if row % 2 else 0.0
        dv = (v * 2 * count - (row + 0.5)) * 0.5
        du = (u * count - shift + 0.5) % 1.0 - 0.5
        away = np.minimum(away, np.hypot(du, dv))
    return blended(_edge(radius - away, 0.06), ground, dot)


def plain(rgb: Colour) -> Array:
    return np.tile(np.array(rgb, dtype=float), (SIDE_PX, SIDE_PX, 1))


def swirl(ground: Colour) -> Array:
    v, u = tile_grid()
    a, b = u - 0.5, v - 0.5
    radius, angle = np.hypot(a, b), np.arctan2(b, a)
    arms = np.sin(angle * 2 + radius * 2 * np.pi * 5.5)
    fade = np.clip((0.5 - radius) / 0.04, 0, 1)
    return blended(_edge(arms, 0.4) * fade, ground, (250, 250, 250))


def paisley(ground: Colour) -> Array:
    v, u = tile_grid()
    image = np.tile(np.array(ground, dtype=float), (SIDE_PX, SIDE_PX, 1))
    pale = mixed(ground, (250, 250, 250), 0.65)
    for row, column, flip in ((0.25, 0.25, 1), (0.75, 0.75, -1), (0.25, 0.75, -1), (0.75, 0.25, 1)):
        a = ((u - column + 0.5) % 1 - 0.5) * flip
        b = (v - row + 0.5) % 1 - 0.5
        bent = a + 1.6 * np.clip(-b, 0, 1) ** 1.6
        drop = np.hypot(bent, 0.62 * b + 0.02) + 0.22 * np.clip(-b, 0, None)
        for reach, colour in ((0.15, pale), (0.11, ground), (0.075, pale), (0.035, ground)):
            weight = _edge(reach - drop, 0.015)[..., None]
            image = (1 - weight) * image + weight * np.array(colour)
    return image


def brick() -> Array:
    v, u = tile_grid()
    row = np.floor(v * 5) % 5
    across = (u * 2 + 0.5 * (row % 2)) % 1
    # Five rows would not meet their neighbours half a brick apart at the seam: the last row is shifted by a quarter.
    across = np.where(row == 4, (u * 2 + 0.25) % 1, across)
    joint = np.minimum(np.minimum(across, 1 - across) * 0.5, np.minimum(v * 5 % 1, 1 - v * 5 % 1) * 0.2)
    tone = 1 + 0.1 * np.sin(13 * row + 7 * np.floor(u * 2 + 0.5 * (row % 2)) % 2) + 0.08 * noise(3, 6, 40)
    clay = np.array((172, 84, 60)) * tone[..., None]
    mortar = _edge(joint - 0.016, 0.012)[..., None]
    return np.asarray((1 - mortar) * np.array((214, 204, 190)) + mortar * clay)


def tiles() -> Array:
    v, u = tile_grid()
    joint = np.minimum(np.minimum(u * 3 % 1, 1 - u * 3 % 1), np.minimum(v * 3 % 1, 1 - v * 3 % 1))
    shade = 1 + 0.05 * noise(5, 2, 12) + 0.06 * np.sin(9 * np.floor(u * 3) + 5 * np.floor(v * 3))
    body = np.array((112, 170, 178)) * shade[..., None]
    line = _edge(joint - 0.06, 0.04)[..., None]
    return np.asarray((1 - line) * np.array((242, 242, 236)) + line * body)


def wooden() -> Array:
    v, u = tile_grid()
    rings = np.sin(2 * np.pi * (4 * v + 0.35 * noise(11, 1, 2))) * 0.5 + 0.5
    fine = 0.5 + 0.5 * np.sin(2 * np.pi * (22 * v + 0.8 * noise(12, 1, 3)))
    return blended(0.75 * rings + 0.25 * fine + 0.06 * noise(13, 8, 40), (196, 146, 92), (138, 90, 48))


def granite() -> Array:
    grain = 0.5 + 0.35 * noise(21, 8, 44) + 0.2 * noise(22, 20, 60)
    return _ramp(grain, [(58, 58, 62), (128, 126, 128), (176, 172, 170), (226, 222, 218)])


def plastic() -> Array:
    v, u = tile_grid()
    ridges = 0.5 + 0.5 * np.sin(2 * np.pi * 8 * u) * np.sin(2 * np.pi * 8 * v)
    return blended(ridges, (206, 220, 226), (150, 170, 182))


def checkerboard() -> Array:
    v, u = tile_grid()
    return blended(_edge(np.sin(2 * np.pi * 2 * u) * np.sin(2 * np.pi * 2 * v), 0.1), (34, 34, 38), (244, 244, 244))


def tiger() -> Array:
    v, u = tile_grid()
    bands = np.sin(2 * np.pi * (4 * v + 0.55 * noise(31, 1, 3) + 0.5 * np.sin(2 * np.pi * u)))
    return blended(_edge(bands - 0.25 + 0.3 * noise(32, 2, 5), 0.25), (232, 146, 44), (32, 24, 20))


def magma() -> Array:
    vein = np.abs(noise(41, 2, 5)) + 0.25 * np.abs(noise(42, 6, 12))
    return _ramp(
        np.clip(1 - 2.2 * vein, 0, 1), [(46, 22, 20), (92, 30, 20), (208, 66, 16), (252, 176, 40), (255, 236, 150)]
    )


def skin(fruit: str, rgb: Colour) -> Array:
    """A fruit's skin as seen from above, its marks where they belong: the tile's centre is the fruit's."""
    v, u = tile_grid()
    right, up = (u - 0.5) * TILE_M, (v - 0.5) * TILE_M
    away = np.hypot(right, up)
    image = np.array(rgb) * (1 + 0.05 * noise(51, 4, 20))[..., None]
    brown, leaf = (96, 62, 34), (70, 110, 40)
    match fruit:
        case "apple":
            image = _over(image, 0.5 * _edge(0.011 - away, 0.008), (120, 16, 24))
            image = _over(image, _edge(0.0032 - away, 0.001), brown)
            image = _over(image, _edge(0.0036 - np.hypot((right - 0.008) * 0.5, up - 0.004), 0.001), leaf)
        case "orange":
            image = _over(image, _edge(0.0045 - away, 0.001), leaf)
        case "lime":
            image = _over(image, _edge(np.abs(right) - 0.034, 0.006), (176, 200, 110))
        case "plum":
            image = _over(image, 0.6 * _edge(0.0014 - np.abs(up + 12 * right**2), 0.001), (70, 26, 84))
        case "blueberry":
            star = 0.006 + 0.0025 * np.cos(5 * np.arctan2(up, right))
            image = _over(image, _edge(star - away, 0.001), (26, 38, 84))
    return image


def _over(image: Array, weight: Array, rgb: Colour) -> Array:
    return np.asarray((1 - weight[..., None]) * image + weight[..., None] * np.array(rgb))


def rainbow() -> Array:
    v, u = tile_grid()
    hues = [(228, 60, 60), (244, 150, 50), (246, 220, 70), (80, 180, 90), (70, 120, 210), (140, 80, 180), (228, 60, 60)]
    return _ramp((u + v) % 1.0, hues)
