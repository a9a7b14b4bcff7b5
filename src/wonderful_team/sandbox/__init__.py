"""Runs Python that a model wrote, in a worker process that has no files, no network and no clock."""

from wonderful_team.sandbox.errors import SandboxError, SandboxUnavailableError
from wonderful_team.sandbox.program import HostCall, ProgramRun, run_program
from wonderful_team.sandbox.run import called, run_path

__all__ = ["HostCall", "ProgramRun", "SandboxError", "SandboxUnavailableError", "called", "run_path", "run_program"]
