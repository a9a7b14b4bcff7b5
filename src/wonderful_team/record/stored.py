"""Observations, instructions and plans out of a run folder again: the same pixels, depth and camera as when it was recorded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from wonderful_team.core.geometry import AffineCamera, Camera, PinholeCamera, PlanarCamera
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import picture_hash
from wonderful_team.core.values import Instruction, Observation, Plan, RobotState, Slot, View
from wonderful_team.errors import ConfigError
from wonderful_team.images import OWN_FORMATS, open_picture
from wonderful_team.record.picture_store import PictureStore
from wonderful_team.record.plan_file import plan_from_json
from wonderful_team.record.values_file import decode, encode

_CAMERAS = (PinholeCamera, AffineCamera, PlanarCamera)


def view_entry(view: View, where: str, store: PictureStore) -> dict[str, Any]:
    """What a view is beside its pixels, so that it can be made again: names, time, depth, camera."""
    camera: Any = None
    if view.camera is not None:
        known = isinstance(view.camera, _CAMERAS)
        camera = encode(view.camera) if known else {"unknown": type(view.camera).__name__}
    return {
        "id": view.id,
        "camera_name": view.camera_name,
        "time_s": view.time_s,
        "depth": None if view.depth_m is None else store.keep_depth(view, where),
        "camera": camera,
    }


def stored_observation(folder: Path, record: Mapping[str, Any], number: int = 0) -> Observation:
    """One of the record's observations, counted from 0.

    Raises:
        ConfigError: The record was written before observations were kept whole, or a file of it is missing or changed.
    """
    seen = record["planner"]["observations"]
    if number >= len(seen):
        raise ConfigError(f"{folder}: the record has {len(seen)} observations; number {number + 1} is asked for")
    return observation_of(folder, record, seen[number])


def observation_of(folder: Path, record: Mapping[str, Any], entry: Mapping[str, Any]) -> Observation:
    """The observation of one entry of the record.

    Raises:
        ConfigError: As for stored_observation.
    """
    if "stored" not in entry:
        raise ConfigError(f"{folder}: this record keeps its pictures without camera and depth; it cannot be run again")
    views = {
        name: _view(folder, record, key, entry["stored"][name], f"view {name!r}")
        for name, key in entry["views"].items()
    }
    robot = None if entry.get("robot") is None else decode(entry["robot"], RobotState)
    return Observation(views, robot)


def stored_instruction(folder: Path, record: Mapping[str, Any]) -> Instruction:
    """The record's instruction with its pictures.

    Raises:
        ConfigError: As for stored_observation.
    """
    told = record["planner"]["instruction"]
    if told is None:
        raise ConfigError(f"{folder}: the record holds no instruction")
    slots = {}
    for name, slot in told["slots"].items():
        if "stored" not in slot:
            raise ConfigError(
                f"{folder}: this record keeps the picture {name!r} without its view; it cannot be run again"
            )
        views = {
            key: _view(folder, record, picture, slot["stored"][key], f"picture {name!r}")
            for key, picture in slot["views"].items()
        }
        slots[name] = Slot(name, slot["kind"], views, slot["index"])
    return Instruction(told["text"], slots)


def stored_plan(folder: Path, record: Mapping[str, Any], number: int) -> Plan:
    """One of the record's plans, counted from 0, with the pictures of its instruction where the record keeps them.

    Raises:
        ConfigError: It is broken, or of a schema version that cannot be read.
    """
    plan = plan_from_json(record["planner"]["plans"][number], str(folder), whole=False)
    try:
        instruction = stored_instruction(folder, record)
    except ConfigError:
        return plan
    return replace(plan, instruction=instruction) if plan.instruction.text == instruction.text else plan


def file_of_run(folder: Path, name: str, what: str) -> Path:
    """A file that a record names, inside of the record's own folder.

    Raises:
        ConfigError: It lies elsewhere, through `..`, a whole path or a link: a record may be of unknown origin.
    """
    path = folder / name
    if not path.resolve().is_relative_to(folder.resolve()):
        raise ConfigError(f"{folder}: {what}: the record names the file {name!r}, which is not in its folder")
    return path


def _view(folder: Path, record: Mapping[str, Any], key: str, facts: Mapping[str, Any], what: str) -> View:
    if key not in record["files"]:
        raise ConfigError(f"{folder}: {what}: the record names no file for picture {key}")
    path = file_of_run(folder, record["files"][key], what)
    try:
        with open_picture(path, OWN_FORMATS) as image:
            rgb = np.asarray(image.convert("RGB"), dtype=np.uint8)
    except OSError as error:
        raise ConfigError(f"{path}: {what} cannot be read: {error.strerror or error}") from error
    if picture_hash(rgb) != key:
        raise ConfigError(f"{path}: {what} is not the picture that was recorded (its hash is not {key})")
    depth = None if facts["depth"] is None else _depth(file_of_run(folder, facts["depth"], what), what)
    return View(
        facts["id"], facts["camera_name"], facts["time_s"], rgb, depth, stored_camera(folder, facts["camera"], what)
    )


def _depth(path: Path, what: str) -> Array:
    try:
        with np.load(path, allow_pickle=False) as held:
            return np.asarray(held["depth_m"])
    except (OSError, ValueError, KeyError) as error:
        raise ConfigError(f"{path}: depth of {what} cannot be read: {error}") from error


def stored_camera(folder: Path, told: Mapping[str, Any] | None, what: str) -> Camera | None:
    """The camera of a view; None where it had none.

    Raises:
        ConfigError: It is of a kind that records do not keep, or broken.
    """
    if told is None:
        return None
    if "unknown" in told:
        raise ConfigError(
            f"{folder}: {what} was taken with a camera of type {told['unknown']}, which a record cannot keep; "
            f"it keeps {', '.join(kind.__name__ for kind in _CAMERAS)}"
        )
    try:
        camera: Camera = decode(dict(told), PinholeCamera | AffineCamera | PlanarCamera, what)
    except ValueError as error:
        raise ConfigError(f"{folder}: the camera of {what} cannot be read: {error}") from error
    return camera
