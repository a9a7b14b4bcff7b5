"""The session: where questions become requests. It holds one trial's notebooks and memory, and numbers what is sent."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from wonderful_team.agents import build_request
from wonderful_team.agents.request import role_for
from wonderful_team.contracts import QUESTIONS, MemoryEntry, Question, Remember
from wonderful_team.core.protocols import Detector
from wonderful_team.core.values import NOTEBOOK, Answer, Detection, HelperFunction, Note, View
from wonderful_team.detectors import found_words, look, name_of
from wonderful_team.errors import ConfigError, ModelOutputError
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.config import Members, TeamConfig
from wonderful_team.planning.memory import Notebooks, SystemMemory
from wonderful_team.planning.notes import note_of

STAGES = ("plan", "ground", "act", "replan", "memory")
"""Order in which memory entries of one attempt stand."""


@dataclass
class AgentSession:
    """Ask on behalf of the roles.

    Attributes:
        attempt: Number of the plan within the trial; part of every request's id.
        detector: Who finds things, where a detector takes the place of the grounding team.
        functions: Helper functions that this trial accepted, oldest first; later steps may call them. They are the Supervisor's own
            work and no notes: they are kept without Memory, too.
    """

    client: ModelClient
    config: TeamConfig
    instruction: str
    detector: Detector | None = None
    notebooks: Notebooks = field(default_factory=Notebooks)
    memory: SystemMemory = field(default_factory=SystemMemory)
    attempt: int = 0
    functions: tuple[HelperFunction, ...] = ()
    _counts: dict[tuple[str, str, str], int] = field(default_factory=dict)
    _skipped: dict[str, dict[str, set[str]]] = field(default_factory=dict)

    @property
    def members(self) -> Members:
        return self.config.members

    async def ask(
        self, question: Question, *, stage: str, branch: str = "", role: str | None = None, sample: int = 0
    ) -> Any:
        """The validated value that answers the question."""
        return (await self.ask_whole(question, stage=stage, branch=branch, role=role, sample=sample)).value

    async def ask_whole(
        self, question: Question, *, stage: str, branch: str = "", role: str | None = None, sample: int = 0
    ) -> Answer:
        """Like ask, with provenance and cost."""
        asker = role_for(question, role)
        key = (stage, branch, question.contract)
        self._counts[key] = number = self._counts.get(key, 0) + 1
        request = build_request(
            question,
            id=f"{self.attempt}/{stage}/{branch or 'main'}/{question.contract}/{number}",
            stage=stage,
            role=asker,
            notes=(*(self.memory.notes if self.members.memory else ()), *self.notebooks.read(asker.name, branch)),
            sample=sample,
            prompts=self.config.prompts,
        )
        write_down = self.notebooks.begin(asker.name, branch)
        answer = await self.client.ask(request)
        said = note_of(question, answer.value)
        write_down(Note(question.contract, said, NOTEBOOK) if said else None)
        return answer

    async def look(self, view: View, words: Sequence[str]) -> tuple[Detection, ...]:
        """What the detector finds in a view; told to subscribers.

        Raises:
            NotUnderstoodError: It refuses some of the words.
            DetectorCodeError: It broke, or returned what are no detections.
            BudgetReached: The cap on seconds was met.
        """
        assert self.detector is not None
        found = await look(self.detector, view, words, self.client.budget, self.client.tell)
        self.stage("detected", f"{name_of(self.detector)}: {found_words(found, words)}")
        return found

    def note(self, role: str, key: str, text: str) -> None:
        """Write a line into a role's notebook that no answer of its own brought."""
        self.notebooks.begin(role, "")(Note(key, text, NOTEBOOK))

    def skip(self, contract: str, why: str, about: str = "") -> None:
        """Note that a question is not asked, and why; told in one line when planning ends."""
        self._skipped.setdefault(contract, {}).setdefault(why, set()).update({about} if about else ())

    def tell_skipped(self) -> None:
        """Tell which questions were not asked, in an order that no race changes."""
        parts = []
        for question in QUESTIONS:
            for why, about in sorted(self._skipped.get(question.contract, {}).items()):
                named = f" ({', '.join(sorted(about))})" if about else ""
                parts.append(f"{question.contract}{named}: {why}")
        self._skipped.clear()
        if parts:
            self.stage("not asked", "; ".join(parts))

    def begin_attempt(self) -> None:
        """The next plan is made from a new picture."""
        self.attempt += 1
        self.notebooks.begin_attempt()

    def remember(self, role: str, stage: str, asked: str, answered: str, *, target: int = 0, branch: str = "") -> None:
        """Let Memory keep what was decided and the plan does not show, beside the main line; nothing when it is switched off.

        Asked only of a doubt that was settled, a box that was rejected, one of several look-alikes that was chosen, an angle
        that nobody stated, a helper function that was criticised, and what the user was asked and answered.
        """
        if not self.members.memory:
            return
        question = Remember(self.instruction, role, asked, answered, self.memory.keys)
        order = (self.attempt * len(STAGES) + STAGES.index(stage), target)
        self.memory.submit(order, self._remember(question, f"{stage}.{branch}" if branch else stage))

    async def _remember(self, question: Remember, branch: str) -> MemoryEntry | None:
        try:
            value = await self.ask(question, stage="memory", branch=branch)
        except ModelOutputError as error:
            # A lost note must not lose the plan; the page shows the warning.
            self.client.tell("warning", "memory", f"nothing remembered: {error}")
            return None
        assert isinstance(value, MemoryEntry)
        return value

    def stage(self, name: str, text: str) -> None:
        """Tell subscribers that a stage is finished, in one line."""
        self.client.tell("stage", name, {"text": text, "attempt": self.attempt})

    def warn(self, text: str) -> None:
        self.client.tell("warning", "planning", text)


def needed_detector(config: TeamConfig, detector: Detector | None) -> Detector | None:
    """The detector where the team grounds with one; None elsewhere.

    Raises:
        ConfigError: It is needed and not there.
    """
    if config.grounding != "detector":
        return None
    if detector is None:
        raise ConfigError("grounding 'detector' needs a detector: anything with a name and detect(rgb, words)")
    return detector


async def settle(session: AgentSession) -> None:
    """Drop what is still under way when planning ends early."""
    await asyncio.shield(session.memory.cancel())
