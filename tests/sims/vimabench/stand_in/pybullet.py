"""Our own few lines in the place of the physics engine: boxes on a table, each with a position and a yaw."""

import math

BODIES: dict[int, dict] = {}


def getBasePositionAndOrientation(body, physicsClientId=0):  # noqa: N802, N803  the engine's own name
    one = BODIES[body]
    return tuple(one["at"]), (0.0, 0.0, math.sin(one["yaw"] / 2), math.cos(one["yaw"] / 2))


def getMatrixFromQuaternion(turned):  # noqa: N802
    x, y, z, w = turned
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    c, s = math.cos(yaw), math.sin(yaw)
    return (c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)


def getVisualShapeData(body, physicsClientId=0):  # noqa: N802, N803
    one = BODIES[body]
    kind = 3 if one["shape"] == "box" else 2
    return [(body, -1, kind, tuple(one["size"]), b"", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (1, 1, 1, 1))]


def getAABB(body, physicsClientId=0):  # noqa: N802, N803
    at, size = BODIES[body]["at"], BODIES[body]["size"]
    return tuple(a - s / 2 for a, s in zip(at, size)), tuple(a + s / 2 for a, s in zip(at, size))  # noqa: B905


def getCollisionShapeData(body, link, physicsClientId=0):  # noqa: N802, N803
    return [] if BODIES[body]["flat"] else [(body, link)]
