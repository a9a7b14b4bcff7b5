"""New words that pictures define: nouns by one picture each, adjectives by pairs of things."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.registering import task
from wonderful_team.sims.tabletop.scene import Scene
from wonderful_team.sims.tabletop.tasks.choices import (
    L4,
    L123,
    base_shapes,
    base_textures,
    kit_shapes,
    kit_textures,
    one_of,
    some_of,
)
from wonderful_team.sims.tabletop.textures import DARK, GREY

ADJECTIVES = ("daxer", "blicker", "modier", "kobar")
NOUNS = ("dax", "blicket", "wug", "zup")
MEANINGS = ("taller", "shorter", "lighter", "darker")
TALL = 2.0
EXAMPLES = 3
PAIRED_COLOURS = tuple(name.removeprefix("dark ") for name in DARK)
DEMOS = " ".join(
    f"{{demo_blicker_obj_{k}}} is {{adjective}} than {{demo_less_blicker_obj_{k}}}." for k in range(1, EXAMPLES + 1)
)


@dataclass(frozen=True)
class _Adjective:
    """A word for being taller, shorter, lighter or darker; `less` asks for the opposite."""

    word: str
    meaning: str
    less: bool

    def looks(self, colour: str, more: bool) -> tuple[str, float]:
        """Texture and height of a thing that is more, or less, so."""
        if self.meaning in ("taller", "shorter"):
            return colour, TALL if (self.meaning == "taller") == more else 1.0
        return f"dark {colour}" if (self.meaning == "darker") == more else colour, 1.0


@task(
    "novel_adj",
    instruction=DEMOS + " Put the {quality} {dragged_obj} into the {base_obj}.",
    horizon=5,
    partitions=L123,
)
def novel_adj(scene: Scene, rng: np.random.Generator) -> None:
    """Put the taller, shorter, lighter or darker of two like things into a container; pictures define the adjective."""
    carried, base, adjective = _comparison(scene, rng)
    scene.show(dragged_obj=scene.prop(carried.shape, GREY), base_obj=scene.prop(base.shape, GREY))
    scene.say(adjective=adjective.word, quality=f"less {adjective.word}" if adjective.less else adjective.word)


@task(
    "novel_noun",
    instruction="{definitions} Put a {first_noun} into a {second_noun}.",
    horizon=5,
    partitions=L123,
)
def novel_noun(scene: Scene, rng: np.random.Generator) -> None:
    """Put one thing into another, both known only by new nouns that pictures define; another geometry stands by."""
    base = scene.add(one_of(rng, base_shapes(scene)), scene.pick_textures(1, base_textures(scene))[0])
    cover, other = scene.pick_textures(2, kit_textures(scene))
    carried = scene.add(one_of(rng, kit_shapes(scene)), cover)
    _other_geometry(scene, rng, carried, base, like_base=rng.random() < 0.5, cover=other)
    scene.goal(carried, near=base)
    first, second = _definitions(scene, rng, carried, base, "dragged_obj_1")
    scene.say(first_noun=first, second_noun=second)


@task(
    "novel_adj_and_noun",
    instruction="{definitions} " + DEMOS + " Put the {quality} {first_noun} into the {second_noun}.",
    horizon=5,
    partitions=L4,
)
def novel_adj_and_noun(scene: Scene, rng: np.random.Generator) -> None:
    """Put the right one of two like things into a container: nouns and adjective are new, and pictures define them."""
    carried, base, adjective = _comparison(scene, rng)
    covers = scene.pick_textures(2, kit_textures(scene))
    for cover, like_base in zip(covers, (False, True), strict=True):
        _other_geometry(scene, rng, carried, base, like_base=like_base, cover=cover)
    first, second = _definitions(scene, rng, carried, base, "dragged_obj")
    quality = f"less {adjective.word}" if adjective.less else adjective.word
    scene.say(adjective=adjective.word, quality=quality, first_noun=first, second_noun=second)


def _comparison(scene: Scene, rng: np.random.Generator) -> tuple[Thing, Thing, _Adjective]:
    """Two variants of a thing, a container, and three pairs that show what the adjective means."""
    adjective = _Adjective(one_of(rng, ADJECTIVES), one_of(rng, MEANINGS), bool(rng.random() < 0.5))
    colours = scene.pick_textures(1 + EXAMPLES, PAIRED_COLOURS)
    base_cover = scene.pick_textures(1, [n for n in base_textures(scene) if n not in PAIRED_COLOURS])[0]
    base = scene.add(one_of(rng, base_shapes(scene)), base_cover)
    shape, *examples = some_of(rng, kit_shapes(scene), 1 + EXAMPLES)
    variants = {}
    for more in (True, False):
        cover, stretch = adjective.looks(colours[0], more)
        variants[more] = scene.add(shape, cover, stretch=stretch, distractor=more == adjective.less)
    for k, (example, colour) in enumerate(zip(examples, colours[1:], strict=True), start=1):
        for slot, more in ((f"demo_blicker_obj_{k}", True), (f"demo_less_blicker_obj_{k}", False)):
            cover, stretch = adjective.looks(colour, more)
            scene.show(**{slot: scene.prop(example, cover, stretch=stretch)})
    scene.goal(variants[not adjective.less], near=base)
    return variants[not adjective.less], base, adjective


def _definitions(scene: Scene, rng: np.random.Generator, carried: Thing, base: Thing, slot: str) -> tuple[str, str]:
    """Say what two nouns mean, in any order, with grey pictures of the shapes; `slot` shows what is carried."""
    first, second = some_of(rng, NOUNS, 2)
    lines = [f"This is a {first} {{{slot}}}.", f"This is a {second} {{base_obj}}."]
    if rng.random() < 0.5:
        lines.reverse()
    scene.show(**{slot: scene.prop(carried.shape, GREY), "base_obj": scene.prop(base.shape, GREY)})
    scene.say(definitions=" ".join(lines))
    return first, second


def _other_geometry(
    scene: Scene, rng: np.random.Generator, carried: Thing, base: Thing, *, like_base: bool, cover: str
) -> None:
    """A thing that must stay away, of a shape that neither noun names."""
    pool = base_shapes(scene) if like_base else kit_shapes(scene)
    scene.add(one_of(rng, [n for n in pool if n not in (carried.shape, base.shape)]), cover, distractor=True)
