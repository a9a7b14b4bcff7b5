"""The benchmark's tasks and generalisation levels by name, known even where the benchmark itself is not installed."""

from __future__ import annotations

TASKS: dict[str, str] = {
    "visual_manipulation": "Put the pictured object into the pictured container.",
    "scene_understanding": "Put the object of one texture, as in a pictured scene, into the object of another.",
    "rotate": "Turn the pictured object by a stated angle, clockwise.",
    "rearrange": "Arrange the table as in the pictured scene.",
    "rearrange_then_restore": "Arrange the table as in the pictured scene, then put everything back.",
    "novel_adj": "An adjective is defined by pictures; put the one that it fits into the container.",
    "novel_noun": "Two nouns are defined by pictures; put one into the other.",
    "novel_adj_and_noun": "Nouns and an adjective are defined by pictures.",
    "twist": "A turn is defined by pairs of pictures; turn every object of a texture so.",
    "follow_motion": "Move the pictured object as in a sequence of pictures.",
    "follow_order": "Stack objects in the order of a sequence of pictures.",
    "sweep_without_exceeding": "Push a stated number of blocks into an area without passing a line.",
    "sweep_without_touching": "Push a stated number of blocks into an area round a line.",
    "same_texture": "Put all objects with the container's texture into it.",
    "same_shape": "Put all objects with the container's profile into it.",
    "manipulate_old_neighbor": "Put an object into a container, then the one that was beside it.",
    "pick_in_order_then_restore": "Put an object into two containers in turn, then back.",
}
_UNSEEN_IN_TRAINING = ("sweep_without_touching", "novel_adj_and_noun", "follow_motion", "same_texture")
"""The four tasks of level 4, which levels 1 to 3 do not have."""
_NO_NOVEL_OBJECTS = ("sweep_without_exceeding",)
NOTE = "in your own copy of VIMA-Bench"


def task_names() -> dict[str, str]:
    """All tasks with one line of help each."""
    return {name: f"{words[:-1]} ({NOTE})." for name, words in TASKS.items()}


def partitions(task: str) -> tuple[str, ...]:
    """The generalisation levels at which the benchmark has a task."""
    if task in _UNSEEN_IN_TRAINING:
        return ("L4",)
    return ("L1", "L2") if task in _NO_NOVEL_OBJECTS else ("L1", "L2", "L3")
