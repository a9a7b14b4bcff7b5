"""The table: the dominant, smoothly lit surface of a picture, and what stands out from it in colour or height."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.offline.vision.background import room_distance
from wonderful_team.offline.vision.depth import steady
from wonderful_team.offline.vision.fitting import least_squares

_FLOOR = np.array([1.7, 1.3, 1.3])
"""Least standard deviation assumed for the table in L, a, b: sensor noise and rounding."""

_CEILING = np.array([7.0, 5.0, 5.0])
"""Largest spread that a table's colour may have about its fit: a table of two colours is no table."""

_LEAST_TABLE = 0.12
"""Share of the picture that must lie on one smooth surface; with less there is no table and nothing stands out."""

_CLEAN = 1.05
"""A table that spreads no more than this share of the floor is computed, without noise."""

NO_TABLE = 1000.0
"""Spread that is given when the picture has no table."""

_SEED = 5.0
"""Standard deviations by which a pixel must differ from the table to start a thing."""

_GROW = 3.2
"""Standard deviations by which its neighbours must differ to belong to it."""

RAISED_M = 0.006
"""Height above the table plane from which a surface counts as raised [m]; papers stay below."""


@dataclass(frozen=True, eq=False)
class Table:
    """What is known of the table in one picture, at working resolution.

    Attributes:
        surface: The table's own colour at each pixel as fitted, shape (H, W, 3), CIELAB.
        spread: Robust standard deviation of the table's L, a, b about the fit, shape (3,).
        distance: Standard deviations by which each pixel differs in colour, shape (H, W).
        stands_out: Pixels that differ in colour, shape (H, W), bool.
        height_m: Height above the table plane, shape (H, W) [m]; None without depth.
        raised: Pixels above RAISED_M, shape (H, W), bool; None without depth.
        clean: Computed, without noise: its colours are exact.
    """

    surface: Array
    spread: Array
    distance: Array
    stands_out: Array
    height_m: Array | None
    raised: Array | None
    clean: bool = False


def find_table(lab: Array, valid: Array, depth_m: Array | None = None) -> Table:
    """Fit the table of a picture.

    Args:
        lab: CIELAB, shape (H, W, 3).
        valid: Pixels that show the view (not padding), shape (H, W), bool.
        depth_m: Distance along the optical axis, shape (H, W) [m]; NaN where unknown.
    """
    height_m = None if depth_m is None else height_above_table(depth_m, valid)
    surface, spread = _fit_surface(lab, valid, height_m)
    residual = lab - surface
    distance = np.sqrt(((residual / spread) ** 2).sum(axis=-1) / 1.5)
    if height_m is None and (spread < NO_TABLE).all():
        room = room_distance(lab, valid, surface, spread)
        distance = distance if room is None else np.minimum(distance, room)
    distance[~valid] = 0.0
    # Without noise every pixel says for itself what it shows.
    smooth = distance.astype(np.float32)
    clean = bool((spread < _CLEAN * _FLOOR).all())
    if not clean:
        smooth = cv2.GaussianBlur(smooth, (0, 0), 0.8)
    stands_out = _hysteresis(smooth, _GROW, _SEED) & valid
    raised = None
    if height_m is not None:
        known = np.isfinite(height_m)
        flat = known & ~stands_out & valid
        noise = 1.4826 * np.median(np.abs(height_m[flat])) if flat.any() else 0.0
        if (spread >= NO_TABLE).all():  # noise over a depth of something else: nothing is seen
            known = np.zeros_like(known)
        # What is as low as a plate is not to be in parts raised and in parts not.
        raised = known & valid & (np.nan_to_num(height_m) > RAISED_M + 3.0 * float(noise))
    return Table(surface, spread, distance, stands_out, height_m, raised, clean)


def _hysteresis(values: Array, low: float, high: float) -> Array:
    """Pixels above `low` whose connected patch reaches `high`."""
    count, labels = cv2.connectedComponents((values > low).astype(np.uint8), connectivity=8)
    keep = np.zeros(count, dtype=bool)
    keep[np.unique(labels[values > high])] = True
    keep[0] = False
    return np.asarray(keep[labels])


def _fit_surface(lab: Array, valid: Array, height_m: Array | None) -> tuple[Array, Array]:
    """The table's colour as a quadratic of position, and its spread; fitted on the dominant colour."""
    H, W = valid.shape
    step = max(1, round((H * W / 6000) ** 0.5))
    blurred = cv2.blur(lab, (step, step)) if step > 1 else lab
    sub, ok = blurred[::step, ::step].reshape(-1, 3).astype(np.float64), valid[::step, ::step].ravel()
    fine = lab[::step, ::step].reshape(-1, 3).astype(np.float64)
    if height_m is not None:
        level = np.nan_to_num(height_m[::step, ::step].ravel(), nan=1.0)
        if (ok & (np.abs(level) < RAISED_M)).sum() > 0.1 * max(ok.sum(), 1):
            ok = ok & (np.abs(level) < RAISED_M)
    yy, xx = np.mgrid[0:H:step, 0:W:step]
    x, y = (xx.ravel() / W * 2 - 1), (yy.ravel() / H * 2 - 1)
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
    peak = _dominant_colour(sub[ok])
    gap = np.abs(sub - peak)
    chosen = ok & (gap[:, 0] < 14) & (np.hypot(gap[:, 1], gap[:, 2]) < 11)
    order = 1
    spread = np.array([8.0, 4.0, 4.0])
    coefficients = np.zeros((6, 3))
    for limit in (4.0, 3.5, 3.0, 3.0, 3.0):
        columns = 3 if order == 1 else 6
        if chosen.sum() < 4 * columns:
            columns = 1
        fitted = least_squares(terms[chosen][:, :columns], sub[chosen])
        coefficients[:] = 0.0
        coefficients[:columns] = fitted
        residual = np.abs(sub - terms @ coefficients)
        spread = np.clip(1.4826 * np.median(residual[chosen], axis=0), _FLOOR, _CEILING)
        chosen = ok & (residual < limit * spread * np.array([1.2, 1.0, 1.0])).all(axis=1)
        if chosen.sum() < 24:
            break
        order = 2
    is_surface = chosen.sum() > _LEAST_TABLE * max(ok.sum(), 1)
    residual = np.abs(fine - terms @ coefficients)[chosen]
    spread = np.maximum(1.4826 * np.median(residual, axis=0), _FLOOR) if is_surface else np.full(3, NO_TABLE)
    Y, X = np.mgrid[0:H, 0:W].astype(np.float32)
    X, Y = X / W * 2 - 1, Y / H * 2 - 1
    c = coefficients.astype(np.float32)
    surface = np.stack(
        [c[0, k] + c[1, k] * X + c[2, k] * Y + c[3, k] * X * X + c[4, k] * X * Y + c[5, k] * Y * Y for k in range(3)],
        axis=-1,
    )
    return surface, spread


def _dominant_colour(samples: Array) -> Array:
    """The colour round which most samples lie, shape (3,)."""
    if len(samples) == 0:
        return np.array([50.0, 0.0, 0.0])
    size = np.array([5.0, 5.0, 5.0])
    shape = (20, 52, 52)
    index = np.clip(((samples + [0, 130, 130]) / size).astype(int), 0, np.array(shape) - 1)
    counts = np.zeros(shape, dtype=np.float32)
    np.add.at(counts, tuple(index.T), 1.0)
    for axis in range(3):
        counts = counts + 0.5 * (np.roll(counts, 1, axis) + np.roll(counts, -1, axis))
    best = np.array(np.unravel_index(counts.argmax(), shape))
    near = (np.abs(index - best) <= 1).all(axis=1)
    return np.asarray(np.median(samples[near], axis=0))


def height_above_table(depth_m: Array, valid: Array) -> Array | None:
    """Height of each pixel above the dominant plane, shape (H, W) [m]; None when the depth shows no plane.

    Works for pinhole cameras (where the inverse depth of a plane is linear in the pixel) and for parallel ones
    (where the depth is), whichever fits better; the height is measured along the optical axis.
    """
    depth_m = steady(depth_m)
    known = np.isfinite(depth_m) & (depth_m > 0) & valid
    if known.sum() < 50:
        return None
    H, W = depth_m.shape
    yy, xx = np.nonzero(known)
    stride = max(1, len(xx) // 5000)
    yy, xx = yy[::stride], xx[::stride]
    z = depth_m[yy, xx].astype(np.float64)
    terms = np.stack([np.ones(len(xx)), xx / W, yy / H], axis=1)
    best: tuple[float, Array, bool] | None = None
    for inverse in (False, True):
        plane = _robust_plane(terms, 1 / z if inverse else z, 1 / np.median(z) ** 2 if inverse else 1.0)
        error = float(np.median(np.abs(_depth(terms @ plane, inverse=inverse) - z)))
        if best is None or error < best[0] - 1e-6:
            best = (error, plane, inverse)
    assert best is not None
    _, plane, inverse = best
    full = (plane[0] + plane[1] * np.arange(W) / W)[None, :] + (plane[2] * np.arange(H) / H)[:, None]
    return np.where(known, _depth(full, inverse=inverse) - depth_m, np.nan).astype(np.float32)


def _depth(values: Array, *, inverse: bool) -> Array:
    """Depth from a plane's values, which are its inverse for pinhole cameras."""
    return np.asarray(1 / np.maximum(values, 1e-9)) if inverse else values


def _robust_plane(terms: Array, values: Array, unit: float) -> Array:
    """Coefficients of the plane that most values lie on; things above it are nearer, so smaller depths are outliers."""
    rng = np.random.default_rng(0)
    tolerance = 0.003 * unit
    best, most = least_squares(terms, values), -1
    for _ in range(40):
        pick = rng.choice(len(values), 3, replace=False)
        matrix = terms[pick]
        if abs(np.linalg.det(matrix)) < 1e-4:
            continue
        plane = np.linalg.solve(matrix, values[pick])
        inliers = int((np.abs(terms @ plane - values) < tolerance).sum())
        if inliers > most:
            best, most = plane, inliers
    for _ in range(3):
        near = np.abs(terms @ best - values) < tolerance
        if near.sum() >= 10:
            best = least_squares(terms[near], values[near])
    return np.asarray(best)
