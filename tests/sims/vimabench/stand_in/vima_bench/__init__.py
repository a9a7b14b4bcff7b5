"""A tiny stand-in with the same face as the real benchmark: written for these tests, nothing of it is copied.

Blocks are drawn as squares; a pick moves the block under it, a push moves every block on its way. Odd seeds of its own
make it fail in the ways that the real one can: see `Env.step`.
"""

import math
import os
import time

import kornia.augmentation  # noqa: F401  absent here, as torch is
import numpy as np
import pybullet
import torch  # noqa: F401

LOW, HIGH = np.array([0.25, -0.5]), np.array([0.75, 0.5])
ALL_TASKS = ["a/rotate", "a/visual_manipulation", "b/sweep_without_exceeding", "c/follow_motion", "c/twist"]
ALL_PARTITIONS = ["placement", "combinatorial", "novel object", "novel task"]
PARTITION_TO_SPECS = {
    "train": {},
    "test": {
        "placement": {"rotate": None, "visual_manipulation": {"size": 0.08}},
        "combinatorial": {"rotate": {}},
        "novel object": {},
        "novel task": {"follow_motion": None},
    },
}
NO_ROOM, CRASH, HANG, LATE, SLOW, ENDS_BADLY = 100, 101, 102, 103, 104, 105
COLOURS = {"ruby": (200, 30, 30), "jade": (30, 160, 60), "amber": (220, 170, 40)}


class Space:
    """Holds float32 positions on the table and quaternions, like the real one."""

    def contains(self, action):
        for name, value in action.items():
            if not isinstance(value, np.ndarray) or value.dtype != np.float32:
                return False
            low, high = (LOW, HIGH) if name.endswith("position") else (-np.ones(4), np.ones(4))
            if value.shape != low.shape or (value < low).any() or (value > high).any():
                return False
        return True


class Cup:
    def __init__(self):
        self.holds = False

    def check_grasp(self):
        return self.holds


class Oracle:
    def __init__(self, env):
        self._env = env

    def act(self, observed):
        at = np.array(pybullet.BODIES[5]["at"][:2])
        target = self._env.task.goals[0][2][0][0][:2]
        way = (target - at) / np.linalg.norm(target - at)
        quat = np.array([0, 0, 0, 1], np.float32)
        # Told where the spatula is to be 2 cm later and 5 cm further than it really goes.
        first, last = at - 0.03 * way, target + 0.035 * way
        return {
            "pose0_position": first.astype(np.float32),
            "pose0_rotation": quat,
            "pose1_position": last.astype(np.float32),
            "pose1_rotation": quat,
        }


class Task:
    def __init__(self, name, env):
        self.name, self.env = name, env
        self.oracle_max_steps = 3
        self.pos_eps, self.rot_eps = 0.05, math.radians(15)
        self.goals, self.distractors = [], [(6, (0, None))]

    def oracle(self, env):
        return Oracle(env)

    def update_goals(self):
        self.goals = [goal for goal in self.goals if not self._met(goal)]

    def _met(self, goal):
        body, (at, quat) = pybullet.BODIES[goal[0][0][0]], goal[2][0]
        yaw = 2 * math.atan2(quat[2], quat[3])
        turned = abs(math.remainder(body["yaw"] - yaw, 2 * math.pi)) if goal[0][0][1][0] else 0.0
        return math.dist(body["at"][:2], at[:2]) < self.pos_eps and turned < self.rot_eps


class Env:
    def __init__(self, task, seed, size):
        self.task_name, self.global_seed, self.size = task, seed, size
        self.action_space, self.client_id, self.step_counter = Space(), 0, 0
        self.task, self.tool = Task(task, self), int(task.startswith("sweep"))

    def reset(self):
        if self.global_seed == NO_ROOM:
            raise ValueError("no free place after 10 tries")
        os.write(1, b"text argument:\nint args: [")
        rng = np.random.default_rng(self.global_seed)
        self.task.oracle_max_steps = 1
        y = float(rng.uniform(-0.3, -0.2))
        pybullet.BODIES.clear()
        pybullet.BODIES[4] = _box((0.45, 0.2, 0.01), (0.2, 0.2, 0.02), flat=self.tool == 1)
        pybullet.BODIES[5] = _box((0.55, y, 0.03), (self.size, self.size, 0.06), 0.3)
        pybullet.BODIES[6] = _box((0.35, 0.0, 0.03), (self.size, self.size, 0.06), 0.0)
        self.obj_ids = {"fixed": [4], "rigid": [5, 6]}
        infos = {4: ("amber", "tray"), 5: ("ruby", "cube"), 6: ("jade", "cube")}
        self.meta_info = {"obj_id_to_info": {k: {"texture_name": c, "obj_name": s} for k, (c, s) in infos.items()}}
        self.ee = Cup() if self.tool == 0 else object()
        self.prompt, turns = self._prompt(rng)
        turned = 0.3 - math.radians(30) if turns else 0.0
        at = (0.55, y, 0.03) if turns else (0.45, 0.2, 0.01)
        quat = (0.0, 0.0, math.sin(turned / 2), math.cos(turned / 2))
        symmetry = 2 * math.pi if turns else 0
        self.task.goals = [([(5, (symmetry, None))], np.ones((1, 1)), [(at, quat)], False, True, "pose", None, 1)]
        return self._get_obs()

    def _prompt(self, rng):
        shown = {"obj_id": 0, "obj_name": "cube", "obj_color": "ruby"}
        white = np.full((3, 128, 256), 255, np.uint8)
        white[:, 50:78, 114:142] = np.array(COLOURS["ruby"], np.uint8)[:, None, None]
        segm = np.where(white[1] == 255, 255, 0).astype(np.uint8)
        picture = {
            "rgb": {"front": white, "top": white},
            "segm": {"front": segm, "top": segm, "obj_info": shown},
            "placeholder_type": "object",
        }
        scene = {
            "rgb": {"front": white, "top": white},
            "segm": {"front": segm, "top": segm, "obj_info": [shown, dict(shown, obj_id=1, obj_color="onyx")]},
            "placeholder_type": "scene",
        }
        if self.task_name == "rotate":
            self.prompt_assets = {"dragged_obj": picture}
            return "Rotate the {dragged_obj} 30 degrees.", True
        if self.task_name == "twist":
            self.prompt_assets = {"after_twist_1": scene, "before_twist_1": scene}
            return "From {before_twist_1} to {after_twist_1}.", True
        if self.task_name == "follow_motion":
            self.prompt_assets = {"frame_0": scene, "frame_1": scene, "dragged_obj": picture}
            return "Follow this motion for {dragged_obj}: {frame_0} {frame_1}.", False
        self.prompt_assets = {"base_obj": dict(scene, placeholder_type="scene"), "dragged_obj_1": picture}
        return "Put the {dragged_obj_1} into the {base_obj}.", False

    def step(self, action):
        assert self.action_space.contains(action), action
        if self.global_seed == CRASH:
            os.write(2, b"something broke inside\n")
            os._exit(3)
        if self.global_seed == HANG:
            time.sleep(60)
        late = self.movej(None)
        self.step_counter += 240
        if late:
            return self._get_obs(), 0.0, True, {"success": False, "failure": False}
        first, last = (np.array(action[f"pose{k}_position"], float) for k in (0, 1))
        self._push(first, last) if self.tool else self._carry(first, last, action["pose1_rotation"])
        if not self.task.goals and self.global_seed == ENDS_BADLY:
            raise IndexError("judged after its end")
        self.task.update_goals()
        success = not self.task.goals
        bad = pybullet.BODIES[6]["at"]
        failure = not success and math.dist(bad[:2], pybullet.BODIES[4]["at"][:2]) < self.task.pos_eps
        return self._get_obs(), 0.0, success or failure, {"success": success, "failure": failure}

    def _carry(self, first, last, quat):
        under = [k for k in (5, 6) if np.abs(first - pybullet.BODIES[k]["at"][:2]).max() < self.size / 2]
        self.ee.holds = bool(under)
        # Asked once after the lift, as the real arm does.
        if self.ee.check_grasp():
            body = pybullet.BODIES[under[0]]
            yaw = 2 * math.atan2(quat[2], quat[3])
            c, s = math.cos(yaw), math.sin(yaw)
            dx, dy = body["at"][0] - first[0], body["at"][1] - first[1]
            body["at"] = (last[0] + c * dx - s * dy, last[1] + s * dx + c * dy, body["at"][2])
            body["yaw"] += yaw

    def _push(self, first, last):
        way = (last - first) / np.linalg.norm(last - first)
        start, end = first - 0.02 * way, last - 0.05 * way
        for k in (5, 6):
            at = np.array(pybullet.BODIES[k]["at"][:2])
            along, across = (at - start) @ way, abs((at - start) @ [-way[1], way[0]])
            if 0 < along < (end - start) @ way + self.size / 2 and across < 0.025:
                moved = end + self.size / 2 * way
                pybullet.BODIES[k]["at"] = (moved[0], moved[1], 0.03)

    def movej(self, goal, timeout=0.25):
        started = time.time()
        if self.global_seed == SLOW:
            time.sleep(2 * timeout)
        return self.global_seed == LATE or time.time() - started > timeout

    def close(self):
        os.write(1, b"bye\n")

    def _get_obs(self):
        rgb, segm = {}, {}
        for camera in ("front", "top"):
            segm[camera] = np.zeros((128, 256), np.uint8)
            picture = np.full((3, 128, 256), 60, np.uint8)
            for body, one in pybullet.BODIES.items():
                half = round(one["size"][0] / 2 * 251)
                column = round(250.98 * one["at"][1] + 128)
                row = round(250.98 * (one["at"][0] - 0.5) + 63)
                box = slice(max(row - half, 0), row + half), slice(max(column - half, 0), column + half)
                segm[camera][box] = body
                colour = COLOURS[self.meta_info["obj_id_to_info"][body]["texture_name"]]
                picture[(slice(None), *box)] = np.array(colour, np.uint8)[:, None, None]
            rgb[camera] = picture
        return {"rgb": rgb, "segm": segm, "ee": self.tool}


def _box(at, size, yaw=0.0, flat=False):
    return {"at": at, "size": size, "yaw": yaw, "flat": flat, "shape": "box"}


def make(task_name, *, task_kwargs=None, modalities=None, seed=None):
    assert modalities == ["rgb", "segm"]
    return Env(task_name, seed, (task_kwargs or {}).get("size", 0.07))
