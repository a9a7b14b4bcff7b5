"""The tiny model with random weights: both forms are whole, hold the same numbers, and are the same for the same seed."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tools.tiny_model import CONTROL, LIKELIER, learn_merges, letters, write_model

SIZES = {0: 1, 1: 1, 4: 4, 5: 4, 6: 4, 7: 1}
"""Bytes of the kinds of numbers in a GGUF file."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("tiny")
    write_model(made, seed=3)
    return made


def read_gguf(path: Path) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """What is said of a model, and its numbers; by the format's own description."""
    raw, at = path.read_bytes(), 0

    def take(form: str) -> tuple[Any, ...]:
        nonlocal at
        found = struct.unpack_from(f"<{form}", raw, at)
        at += struct.calcsize(f"<{form}")
        return found

    def text() -> str:
        nonlocal at
        (length,) = take("Q")
        at += length
        return raw[at - length : at].decode()

    def value(kind: int) -> Any:
        if kind == 8:
            return text()
        if kind == 9:
            inner, count = take("IQ")
            return [value(inner) for _ in range(count)]
        return take({4: "I", 5: "i", 6: "f", 7: "?"}[kind])[0]

    magic, version, tensors, said = take("4sIQQ")
    assert (magic, version) == (b"GGUF", 3)
    facts = {text(): value(take("I")[0]) for _ in range(said)}
    places = {}
    for _ in range(tensors):
        name, (dimensions,) = text(), take("I")
        shape = tuple(reversed(take(f"{dimensions}Q")))
        kind, offset = take("IQ")
        assert (kind, offset % 32) == (0, 0)
        places[name] = (shape, offset)
    start = at + (-at % 32)
    numbers = {
        name: np.frombuffer(raw, "<f4", int(np.prod(shape)), start + offset).reshape(shape)
        for name, (shape, offset) in places.items()
    }
    return facts, numbers


def read_safetensors(path: Path) -> dict[str, np.ndarray]:
    raw = path.read_bytes()
    (length,) = struct.unpack_from("<Q", raw)
    head = json.loads(raw[8 : 8 + length])
    head.pop("__metadata__")
    found = {}
    for name, held in head.items():
        first, last = held["data_offsets"]
        found[name] = np.frombuffer(raw[8 + length + first : 8 + length + last], "<f4").reshape(held["shape"])
    return found


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others(folder: Path, tmp_path: Path) -> None:
    write_model(tmp_path / "again", seed=3)
    write_model(tmp_path / "other", seed=4)
    files = sorted(path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    assert {"model.gguf", "mmproj.gguf", "hf/model.safetensors", "hf/config.json"} <= set(map(str, files))
    for file in files:
        assert (folder / file).read_bytes() == (tmp_path / "again" / file).read_bytes()
    for file in ("model.gguf", "mmproj.gguf", "hf/model.safetensors"):
        assert (folder / file).read_bytes() != (tmp_path / "other" / file).read_bytes()


def test_both_forms_hold_the_same_numbers_for_the_same_tokens(folder: Path) -> None:
    plain = read_safetensors(folder / "hf" / "model.safetensors")
    facts, model = read_gguf(folder / "model.gguf")
    _, encoder = read_gguf(folder / "mmproj.gguf")
    assert np.array_equal(model["token_embd.weight"], plain["model.embed_tokens.weight"])
    assert np.array_equal(model["blk.1.ffn_down.weight"], plain["model.layers.1.mlp.down_proj.weight"])
    parts = [encoder[f"v.blk.0.attn_{letter}.weight"] for letter in "qkv"]
    assert np.array_equal(np.concatenate(parts), plain["visual.blocks.0.attn.qkv.weight"])
    frames = [encoder["v.patch_embd.weight"], encoder["v.patch_embd.weight.1"]]
    assert np.array_equal(np.stack(frames, axis=2), plain["visual.patch_embed.proj.weight"])
    assert sum(n.size for n in (*model.values(), *encoder.values())) == sum(n.size for n in plain.values())
    tokenizer = json.loads((folder / "hf" / "tokenizer.json").read_text())
    numbered = tokenizer["model"]["vocab"] | {token["content"]: token["id"] for token in tokenizer["added_tokens"]}
    assert [numbered[token] for token in facts["tokenizer.ggml.tokens"]] == list(range(len(numbered)))
    assert facts["tokenizer.ggml.merges"] == tokenizer["model"]["merges"]
    config = json.loads((folder / "hf" / "config.json").read_text())
    assert config["vocab_size"] == len(numbered) == len(plain["lm_head.weight"])
    assert facts["tokenizer.ggml.tokens"][config["image_token_id"]] == "<|image_pad|>"
    assert facts["tokenizer.ggml.tokens"][config["eos_token_id"]] == "<|im_end|>"


def test_what_ends_a_text_is_likelier_than_other_tokens_whatever_came_before(folder: Path) -> None:
    """Without it a random model would fill every text until the answer's limit."""
    plain = read_safetensors(folder / "hf" / "model.safetensors")
    tokens = read_gguf(folder / "model.gguf")[0]["tokenizer.ggml.tokens"]
    hidden = plain["model.embed_tokens.weight"]
    hidden = hidden / np.sqrt((hidden**2).mean(axis=1, keepdims=True))
    logits = (hidden @ plain["lm_head.weight"].T).mean(axis=0)
    assert logits[tokens.index('"')] > 4.0 > np.median(logits) + 3.5
    # No layer, and no picture, changes the channel that makes them likelier.
    for name in (
        "model.layers.0.self_attn.o_proj.weight",
        "model.layers.1.mlp.down_proj.weight",
        "visual.merger.mlp.2.weight",
    ):
        assert not plain[name][0].any()


def test_the_tokenizer_knows_every_byte_and_joins_what_is_frequent() -> None:
    assert len(set(letters())) == 256
    merges = learn_merges("the picture of the thing " * 50)
    assert "Ġthe" in {"".join(pair) for pair in merges}
    assert set(LIKELIER) <= {*letters(), *CONTROL}
