"""Arms at a table: real arm models in MuJoCo that run the arm's vocabulary by contact. Needs the optional part `arms`."""

from wonderful_team.sims.arms.disturbances import check_possible
from wonderful_team.sims.arms.options import TIERS, asked
from wonderful_team.sims.arms.rows import ARMS, check_ready
from wonderful_team.sims.arms.scene import ArmScene
from wonderful_team.sims.arms.tasks import find_arm_task, task_names
from wonderful_team.sims.arms.world import ArmWorld

make_world = ArmWorld
"""make_world("block_in_bowl", seed=3, arm="ur5e", depth=0, calibration=0); the name may say the same: "block_in_bowl@depth=1"."""


def partitions(name: str) -> tuple[str, ...]:
    """Tasks of arms have no generalisation levels."""
    return ()


def check_options(task: str) -> None:
    """Whether what stands behind a task's name can be asked for, as in "block_in_bowl@depth=1@nudge=1".

    Raises:
        ConfigError: It cannot; says what can.
    """
    wanted = asked(task, None, 0, 0)
    if wanted.disturbances:
        scene = find_arm_task(wanted.task).scene(0, made=ArmScene)
        assert isinstance(scene, ArmScene)
        check_possible(wanted.task, scene, wanted.disturbances)


__all__ = ["ARMS", "TIERS", "ArmWorld", "check_options", "check_ready", "make_world", "partitions", "task_names"]
