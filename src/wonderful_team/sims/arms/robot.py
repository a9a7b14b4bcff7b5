"""The robot of a scene: moves its tool in straight lines by joint servos, grips by contact alone, and says what it measures."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.arms.giving import GivesSideways, shifted
from wonderful_team.sims.arms.kinematics import Kinematics, downwards
from wonderful_team.sims.arms.model import BuiltArm
from wonderful_team.sims.arms.reports import Moved
from wonderful_team.sims.arms.touch import Touch
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.model import TIMESTEP_S

TICK = 5
"""Steps of physics between two commands to the servos: 10 ms."""
SPEED_M_S, CONTACT_SPEED_M_S = 0.35, 0.1
TURN_RAD_S, JOINT_RAD_S = 1.6, 1.8
"""How fast the tool turns, and how fast any joint does on the way from and to its parking place."""
APART_M = 0.015
"""Distance of the points of a line at which inverse kinematics is solved [m]."""
TOUCH_N, COLLISION_N = 6.0, 40.0
"""A tool that goes down stops at the first force; any other motion at the second [N]."""
ARRIVED_M, ARRIVED_RAD = 0.0015, 0.01
"""A motion is over when the tool is this near to its goal."""
WAIT_S = 1.5
"""How long a motion that has ended is waited for to settle, and a gripper to stop moving [s]."""
EMPTY_M = 0.003
"""Fingers that are closed up to this hold nothing [m]."""
MOST_LEAP_RAD = 1.0
"""A joint that turns farther between two points of a turn takes another posture [rad]."""
DOWN_SHARE = 0.5
PRESS_N, PRESS_TICKS, MOST_PRESS_TICKS = 3.0, 40, 150
"""With so much a tool that is led along a surface presses on it [N]; so many commands long before it is led, and at most, until it touches."""
GIVES_M_N, MOST_LEAN_M = 2e-5, 0.008
"""How far it goes down at each command for a newton that is missing, and at most in all [m]."""
OVER_M = 0.32
"""Height at which the tool comes from its parking place, and goes there [m]."""


class Robot:
    """Moves a MuJoCo state.

    Attributes:
        watch: Called after every command to the servos.
        each_step: Called after every step of physics.
        trace: Where the tool was after every command, while somebody wants to know; None otherwise.
        tip_m: Where the tool's point lies, seen from the middle between the fingertips, in the tool's own frame [m]: that
            of a pen that the fingers hold, for instance.
    """

    def __init__(self, built: BuiltArm, state: Any) -> None:
        self._built, self._model, self._state = built, built.model, state
        self.kinematics = Kinematics(built.row)
        row, obj = built.row, mj.mjtObj
        joints = [built.arm_id(obj.mjOBJ_JOINT, name) for name in row.joints]
        self._q_at = np.array([int(self._model.jnt_qposadr[joint]) for joint in joints])
        self._v_at = np.array([int(self._model.jnt_dofadr[joint]) for joint in joints])
        drives = [k for joint in joints for k in range(self._model.nu) if int(self._model.actuator_trnid[k, 0]) == joint
                  and int(self._model.actuator_trntype[k]) == int(mj.mjtTrn.mjTRN_JOINT)]  # fmt: skip
        self._drives = np.array(drives)
        self._lag_s = -self._model.actuator_biasprm[drives, 2] / self._model.actuator_gainprm[drives, 0]
        self._grip = built.arm_id(obj.mjOBJ_ACTUATOR, row.grip)
        self._flange = built.arm_id(obj.mjOBJ_SITE, row.flange)
        self._tips = [(built.arm_id(obj.mjOBJ_BODY, name), np.array(at)) for name, at in row.tips]
        self._touch = Touch(built, state)
        self.watch: Callable[[], None] | None = None
        self.each_step: Callable[[], None] | None = None
        self.trace: list[Array] | None = None
        self.tip_m = np.zeros(3)
        self._halted = False
        self._lean_m = 0.0
        self._led: tuple[Array, Array] | None = None
        self._command(self.kinematics.parked(), self._state.qpos.copy())

    def _command(self, q: Array, qpos: Array) -> None:
        """Stand at these joint angles, at once: for setting a scene."""
        self._state.qpos[:] = qpos
        self._state.qpos[self._q_at] = q
        for name, open_at in self._built.row.open_fingers:
            joint = self._built.arm_id(mj.mjtObj.mjOBJ_JOINT, name)
            self._state.qpos[int(self._model.jnt_qposadr[joint])] = open_at
        self._state.ctrl[self._drives] = self._told = q
        self._state.ctrl[self._grip] = self._built.row.grip_ctrl[0]
        mj.mj_forward(self._model, self._state)
        self._tool_of_flange = self._tool_frame()
        self.parked = True
        self.closed = False

    def _tool_frame(self) -> Array:
        """Axes of the tool in the flange's frame, shape (3, 3): it closes along y and points along z."""
        left, right = self._tip_points()
        turn = self._state.site_xmat[self._flange].reshape(3, 3)
        ahead = np.array([0.0, 0.0, 1.0])
        across = turn.T @ (right - left)
        across -= ahead * (across @ ahead)
        across /= np.linalg.norm(across)
        return np.column_stack([np.cross(across, ahead), across, ahead])

    def _tip_points(self) -> tuple[Array, Array]:
        left, right = (self._state.xpos[b] + self._state.xmat[b].reshape(3, 3) @ at for b, at in self._tips)
        return np.asarray(left), np.asarray(right)

    @property
    def q(self) -> Array:
        """Joint angles, shape (N,) [rad]."""
        return np.asarray(self._state.qpos[self._q_at].copy())

    @property
    def turn(self) -> Array:
        """How the tool is turned, shape (3, 3)."""
        return np.asarray(self._state.site_xmat[self._flange].reshape(3, 3) @ self._tool_of_flange)

    @property
    def tool_m(self) -> Array:
        """Where the tool's point is, shape (3,) [m]."""
        left, right = self._tip_points()
        return np.asarray((left + right) / 2 + self.turn @ self.tip_m)

    @property
    def yaw_rad(self) -> float:
        """Heading of the tool's x axis; the fingers close across it."""
        return float(math.atan2(self.turn[1, 0], self.turn[0, 0]))

    @property
    def opening_m(self) -> float:
        """Between the fingers [m]."""
        left, right = self._tip_points()
        return max(0.0, float((right - left) @ self.turn[:, 1]))

    @property
    def holding(self) -> bool:
        """Whether fingers that were closed came to a stand apart from each other, and something presses on both."""
        return self.closed and self.opening_m > EMPTY_M and bool(self.held_bodies())

    @property
    def loosened(self) -> bool:
        """Whether fingers that were told to close give way."""
        row = self._built.row
        return self.closed and float(self._state.ctrl[self._grip]) == row.grip_ctrl[0]

    def held_bodies(self) -> frozenset[int]:
        """Bodies that both fingers touch."""
        return self._touch.held()

    def force_n(self) -> float:
        """Sum of the forces with which what does not belong to the robot presses on it or on what it holds [N]."""
        return self._touch.force_n(self.closed)

    # Motion.

    def halt(self) -> None:
        """Stay where it is, from the next command on; what is held stays held."""
        self._halted = True

    def move(self, position_m: Array, yaw_rad: float, *, touching: bool = False) -> Moved:
        """The tool in a straight line to a point, pointing down, at a yaw.

        Args:
            position_m: Of the tool's point, shape (3,) [m].
            yaw_rad: Heading of the tool's x axis.
            touching: Contact is wanted all along: slowly, and without stopping at a touch.
        """
        goal = np.asarray(position_m, dtype=np.float64)
        if self.parked:
            over = np.array([goal[0], goal[1], max(OVER_M, float(goal[2]))])
            # Searched from where it is parked, an answer may fold the arm over backwards, into what stands on the table.
            ready = self.kinematics.facing(over[:2], yaw_rad)
            found = self.kinematics.reach(*self._flange_at(over, yaw_rad), near=ready)
            if found is None:
                return self._ended(over, yaw_rad, 0.0, "reach")
            stopped, force = self._swing(found)
            if stopped:
                return self._ended(over, yaw_rad, force, stopped)
            self.parked = False
        return self._straight(goal, yaw_rad, touching)

    def rotate(self, turn_rad: float) -> Moved:
        """Turn the tool where it stands, about the vertical; nothing turns where the wrist has no room for all of it.

        Args:
            turn_rad: Counter-clockwise, seen from above; more than half a circle is turned that way round.
        """
        return self._straight(self.tool_m, self.yaw_rad + turn_rad, False, turn_rad)

    def _straight(self, goal: Array, yaw_rad: float, touching: bool, turn_rad: float | None = None) -> Moved:
        start, from_q = self._led if touching and self._led is not None else (self.tool_m, self.q)
        from_yaw = self.yaw_rad
        way = goal - start
        turn = math.remainder(yaw_rad - from_yaw, 2 * math.pi) if turn_rad is None else turn_rad
        length = float(np.linalg.norm(way))
        count = max(1, math.ceil(length / APART_M), math.ceil(abs(turn) / 0.2))
        near, path = from_q, [from_q]
        for share in np.linspace(0, 1, count + 1)[1:]:
            found = self.kinematics.reach(*self._flange_at(start + share * way, from_yaw + share * turn), near=near)
            if found is None or (turn_rad is not None and float(np.abs(found - near).max()) > MOST_LEAP_RAD):
                # A wrist at the end of its range would go all the way back, and what is held with it.
                return self._ended(goal, yaw_rad, 0.0, "reach" if turn_rad is None else "wrist")
            path.append(found)
            near = found
        down = length > 1e-6 and -float(way[2]) > DOWN_SHARE * length and not touching
        speed = CONTACT_SPEED_M_S if touching or (down and length < 0.15) else SPEED_M_S
        most = float(np.abs(path[-1] - path[0]).max()) / JOINT_RAD_S
        seconds = max(1.5 * length / speed, 1.5 * abs(turn) / TURN_RAD_S, most, 0.1)
        if not touching:
            self._lean_m = 0.0
        # Where the next edge of a path along a surface begins: where this one would end without the pressing.
        self._led = (goal, path[-1]) if touching else None
        stopped, force = self._along(np.array(path), seconds, TOUCH_N if down else COLLISION_N, touching)
        if not stopped and not touching:
            stopped, pressed = self._settle(goal, yaw_rad, TOUCH_N if down else COLLISION_N)
            force = max(force, pressed)
        if stopped == "collision" and down:
            stopped = "contact"
        return self._ended(goal, yaw_rad, force, stopped)

    def press(self) -> None:
        """Press as a tool does that is led along a surface, before it is: where it touches, and until it does so steadily."""
        self._led = (self.tool_m, self.q)
        q, self._lean_m, force = self.q, 0.0, self.force_n()
        for k in range(MOST_PRESS_TICKS):
            self._state.ctrl[self._drives] = self._leant(q, force)
            self._tick()
            force = self.force_n()
            # A jolt in the air is taken for a touch now and then: then it goes on down, as far as a path's surface is looked for.
            if k >= PRESS_TICKS and force > 0:
                break

    def park(self) -> Moved:
        """Straight up, then to the parking place beside the table."""
        at = self.tool_m
        if not self.parked and at[2] < OVER_M:
            moved = self._straight(np.array([at[0], at[1], OVER_M]), self.yaw_rad, False)
            if moved.stopped_by:
                return moved
        goal = self.kinematics.parked()
        stopped, force = self._swing(goal)
        self.parked = not stopped
        return Moved(0.0, float(np.abs(self.q - goal).max()), force, stopped)

    def grip(self, closed: bool, tight: bool = False) -> Moved:
        """Close or open the fingers; the point between their tips stays where it is until they hold something, which may push it aside."""
        row = self._built.row
        force = row.grip_force[1 if tight else 0] if closed else row.grip_force[1]
        self._model.actuator_forcerange[self._grip] = (-force, force)
        goal, yaw, q = self.tool_m, self.yaw_rad, self.q
        start, end = float(self._state.ctrl[self._grip]), row.grip_ctrl[1 if closed else 0]
        still, before, count = 0, self.opening_m, round(0.5 / (TICK * TIMESTEP_S))
        held, gives, eased = False, GivesSideways(), True
        for k in range(round((0.5 + WAIT_S) / (TICK * TIMESTEP_S))):
            if self._halted:
                return self._ended(goal, yaw, 0.0, "stop")
            self._state.ctrl[self._grip] = start + (end - start) * min(1.0, (k + 1) / count)
            if closed and not held and still >= 2 and self.held_bodies():
                # From here on it would lift, or press down, what it holds. Fingertips that only touch, such as the plate under a handle, go on.
                held, self._state.ctrl[self._drives] = True, (q := self.q)
            if held and not (eased := gives.step(self._touch.push_n())):
                self._state.ctrl[self._drives] = self._shifted(q, gives.by_m)
            if closed and not held and k % 3 == 0:
                q = self._keep(goal, yaw, q)
            self._tick()
            still = still + 1 if eased and abs(self.opening_m - before) < 2e-5 else 0
            before = self.opening_m
            if k >= count and still >= 10:
                break
        self.closed = closed
        return self._ended(goal, yaw, 0.0, "")

    def loosen(self) -> None:
        """The fingers give way, as when something slips: nobody has told the gripper to open."""
        self._state.ctrl[self._grip] = self._built.row.grip_ctrl[0]

    def tighten(self) -> None:
        """The fingers close again as they were told to."""
        self._state.ctrl[self._grip] = self._built.row.grip_ctrl[1 if self.closed else 0]

    def _keep(self, goal: Array, yaw_rad: float, q: Array) -> Array:
        """Stay with the middle between the fingertips where it is, while the fingers swing."""
        found = self.kinematics.solve(*self._flange_at(goal, yaw_rad), start=q)
        if found is not None and float(np.abs(found - q).max()) < 0.1:
            self._state.ctrl[self._drives] = q = found
        return q

    def _flange_at(self, position_m: Array, yaw_rad: float) -> tuple[Array, Array]:
        """Where the flange has to be, and how it is turned, for the tool's point to be somewhere."""
        turn = downwards(yaw_rad)
        offset = self.turn.T @ (self.tool_m - self._state.site_xpos[self._flange])
        return position_m - turn @ offset, turn @ self._tool_of_flange.T

    def _swing(self, goal: Array) -> tuple[str, float]:
        """All joints together to these angles."""
        start = self.q
        seconds = max(1.5 * float(np.abs(goal - start).max()) / JOINT_RAD_S, 0.3)
        shares = np.linspace(0, 1, 24)[:, None]
        stopped, force = self._along(start + shares * (goal - start), seconds, COLLISION_N)
        if not stopped:
            for _ in range(round(0.4 / (TICK * TIMESTEP_S))):
                self._tick()
        return stopped, force

    def _leant(self, q: Array, force_n: float) -> Array:
        """Joint angles a little lower, or higher, so that the tool presses as it should on what it is led along."""
        change = GIVES_M_N * (force_n - PRESS_N)
        self._lean_m = float(np.clip(self._lean_m + change, -MOST_LEAN_M, MOST_LEAN_M))
        return self._shifted(q, np.array([0.0, 0.0, self._lean_m]))

    def _shifted(self, q: Array, by_m: Array) -> Array:
        return shifted(self._model, self._state, self._flange, self._v_at, q, by_m)

    def _along(self, path: Array, seconds: float, most_n: float, touching: bool = False) -> tuple[str, float]:
        """Servo the joints along a path, slow at both ends; the speed is told to the servos, which would lag behind."""
        count, worst = max(2, math.ceil(seconds / (TICK * TIMESTEP_S))), 0.0
        at = np.linspace(0, 1, len(path))

        def goal(share: float) -> Array:
            eased = share * share * (3 - 2 * share)
            return np.array([np.interp(eased, at, path[:, j]) for j in range(path.shape[1])])

        before, force = goal(0.0), self.force_n()
        for k in range(1, count + 1):
            if self._halted:
                self._hold()
                return "stop", worst
            q = goal(k / count)
            told = q + (q - before) / (TICK * TIMESTEP_S) * self._lag_s
            self._state.ctrl[self._drives] = self._leant(told, force) if touching else told
            before = q
            self._tick()
            force = self.force_n()
            worst = max(worst, force)
            if force > most_n:
                self._hold()
                return "collision", worst
        if not touching:
            self._state.ctrl[self._drives] = before
            return "", worst
        for _ in range(round(3 * float(self._lag_s.max()) / (TICK * TIMESTEP_S))):
            # The corner is reached before the next edge begins.
            self._state.ctrl[self._drives] = self._leant(before, force)
            self._tick()
            force = self.force_n()
            worst = max(worst, force)
        return "", worst

    def _settle(self, goal: Array, yaw_rad: float, most_n: float) -> tuple[str, float]:
        worst = 0.0
        for _ in range(round(WAIT_S / (TICK * TIMESTEP_S))):
            ended = self._ended(goal, yaw_rad, 0.0, "")
            if ended.error_m < ARRIVED_M and ended.error_rad < ARRIVED_RAD:
                break
            if self._halted:
                self._hold()
                return "stop", worst
            self._tick()
            worst = max(worst, self.force_n())
            if worst > most_n:
                self._hold()
                return "collision", worst
        return "", worst

    def _hold(self) -> None:
        """Stay here; the gripper keeps what it was told."""
        self._state.ctrl[self._drives] = self.q
        for _ in range(10):
            self._tick()

    def _tick(self) -> None:
        told = self._state.ctrl[self._drives].copy()
        for share in np.linspace(0, 1, TICK + 1)[1:]:
            # Controllers of real arms interpolate, too: in steps of 10 ms the fingers shake, and what they hold creeps out of them.
            self._state.ctrl[self._drives] = self._told + share * (told - self._told)
            mj.mj_step(self._model, self._state)
            if self.each_step is not None:
                self.each_step()
        self._told = told
        if self.trace is not None:
            self.trace.append(self.tool_m)
        if self.watch is not None:
            self.watch()

    def rest(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(round(seconds / (TICK * TIMESTEP_S))):
            self._tick()

    def _ended(self, goal: Array, yaw_rad: float, force_n: float, stopped_by: str) -> Moved:
        off = float(np.linalg.norm(self.tool_m - goal))
        return Moved(off, abs(math.remainder(self.yaw_rad - yaw_rad, 2 * math.pi)), force_n, stopped_by)
