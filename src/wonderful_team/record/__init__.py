"""Run folders: what happened, written as it happens, and read back."""

from wonderful_team.record.plan_file import plan_from_json, plan_to_json, read_plan
from wonderful_team.record.plan_scene import read_plan_scene, read_run_plan
from wonderful_team.record.recorder import Recorder

__all__ = ["Recorder", "plan_from_json", "plan_to_json", "read_plan", "read_plan_scene", "read_run_plan"]
