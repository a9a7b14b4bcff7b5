"""Write a tiny vision-language model with random weights, to try a real model server without downloading anything.

    python -m tools.tiny_model FOLDER [--seed N]

The same weights, in the architecture of Qwen2.5-VL, are written in two forms: `hf/` (for vLLM, SGLang, `transformers serve`) and `model.gguf`
with `mmproj.gguf` (for llama.cpp). Seven megabytes, made in seconds with the standard library and numpy, the same for the
same seed and checkout. What it answers is noise; only the marks that end a text, a list and an answer are made likelier, so that answers under a schema come to an end.
"""

from __future__ import annotations

import argparse
import json
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tools.weight_files import Numbers, Tensors, write_gguf, write_safetensors

NAME = "qwen2.5-vl-tiny"
HIDDEN, HEADS, LAYERS, INNER = 128, 2, 2, 256
EYE_HIDDEN, EYE_HEADS, EYE_LAYERS, EYE_INNER = 64, 2, 2, 128
PATCH, MERGE, FRAMES = 14, 2, 2
CONTEXT = 131072
SOURCES = ("models.md", "worlds.md", "architecture.md")
"""Pages of docs/ that the tokenizer is made from."""
MERGES = 1000
"""Joined pairs of the tokenizer: about three characters of English are one token, as with real ones."""
CONTROL = ("<|endoftext|>", "<|im_start|>", "<|im_end|>", "<|vision_start|>", "<|vision_end|>", "<|image_pad|>", "<|video_pad|>")  # fmt: skip
END, TURN_END = CONTROL[0], CONTROL[2]
LIKELIER = {'"': 5.0, "]": 3.0, "}": 3.0, ",": 2.0, TURN_END: 4.0}
"""How much a token's logit is raised."""
CONSTANT = 8.0
"""Value of the first channel in every token: the output layer reads it, and so a token can be made likelier."""
MEAN, STD = (0.48145466, 0.4578275, 0.40821073), (0.26862954, 0.26130258, 0.27577711)
WORD = r"(?i:'s|'t|'re|'ve|'m|'ll|'d)|[^\r\n\p{L}\p{N}]?\p{L}+|\p{N}| ?[^\s\p{L}\p{N}]+[\r\n]*|\s*[\r\n]+|\s+(?!\S)|\s+"
"""How Qwen2's tokenizer cuts text before it joins pairs."""
TEMPLATE = """\
{%- for message in messages -%}
<|im_start|>{{ message['role'] }}
{% if message['content'] is string %}{{ message['content'] }}{% else %}{% for part in message['content'] -%}
{% if part['type'] in ('image', 'image_url') %}<|vision_start|><|image_pad|><|vision_end|>{% elif 'text' in part %}{{ part['text'] }}{% endif %}
{%- endfor %}{% endif %}<|im_end|>
{% endfor -%}
{% if add_generation_prompt %}<|im_start|>assistant
{% endif %}"""

# -- tokenizer -----------------------------------------------------------------------------------------------------


def letters() -> list[str]:
    """The 256 bytes, each as the printable letter that stands for it in byte-level tokenizers (GPT-2)."""
    printable = {*range(33, 127), *range(161, 173), *range(174, 256)}
    others = iter(range(256, 512))
    return [chr(byte) if byte in printable else chr(next(others)) for byte in range(256)]


def learn_merges(text: str) -> list[tuple[str, str]]:
    """The most frequent pairs of a text, joined one after the other (byte-pair encoding)."""
    byte = letters()
    found = Counter(re.findall(r" ?[A-Za-z]+| ?[^\sA-Za-z0-9]+|\s+", text))
    words = {
        tuple(byte[b] for b in word.encode()): count
        for word, count in sorted(found.items(), key=lambda item: (-item[1], item[0]))[:1500]
    }
    merges: list[tuple[str, str]] = []
    while len(merges) < MERGES:
        pairs: Counter[tuple[str, str]] = Counter()
        for word, count in words.items():
            for pair in zip(word, word[1:], strict=False):
                pairs[pair] += count
        if not pairs:
            break
        best = min(pairs, key=lambda pair: (-pairs[pair], pair))
        merges.append(best)
        words = {joined(word, best): count for word, count in words.items()}
    return merges


def joined(word: tuple[str, ...], pair: tuple[str, str]) -> tuple[str, ...]:
    """A word with every such pair joined."""
    found, at = [], 0
    while at < len(word):
        both = word[at : at + 2] == pair
        found.append(word[at] + word[at + 1] if both else word[at])
        at += 2 if both else 1
    return tuple(found)


# -- weights -------------------------------------------------------------------------------------------------------


def make_tensors(tokens: Sequence[str], seed: int) -> Tensors:
    """All weights, under the names of Qwen2.5-VL's own files."""
    rng = np.random.default_rng(seed)

    def normal(*shape: int) -> Numbers:
        return np.asarray(rng.standard_normal(shape) * (0.5 / np.sqrt(shape[-1])), np.float32)

    kept = np.ones(HIDDEN, np.float32)
    kept[0] = 0.0
    embedding = rng.standard_normal((len(tokens), HIDDEN)).astype(np.float32)
    embedding[:, 0] = CONSTANT
    head = (0.1 * rng.standard_normal((len(tokens), HIDDEN))).astype(np.float32)
    head[:, 0] = 0.0
    first = CONSTANT / np.sqrt((CONSTANT**2 + HIDDEN - 1) / HIDDEN)
    for token, more in LIKELIER.items():
        head[tokens.index(token), 0] = more / first
    found: Tensors = {
        "model.embed_tokens.weight": embedding,
        "model.norm.weight": np.ones(HIDDEN, np.float32),
        "lm_head.weight": head,
    }
    narrow = HIDDEN // HEADS
    for layer in (f"model.layers.{index}" for index in range(LAYERS)):
        found[f"{layer}.input_layernorm.weight"] = np.ones(HIDDEN, np.float32)
        found[f"{layer}.post_attention_layernorm.weight"] = np.ones(HIDDEN, np.float32)
        for name, rows in {"q": HIDDEN, "k": narrow, "v": narrow}.items():
            found[f"{layer}.self_attn.{name}_proj.weight"] = normal(rows, HIDDEN)
            found[f"{layer}.self_attn.{name}_proj.bias"] = normal(rows)
        found[f"{layer}.self_attn.o_proj.weight"] = normal(HIDDEN, HIDDEN) * kept[:, None]
        found[f"{layer}.mlp.gate_proj.weight"] = normal(INNER, HIDDEN)
        found[f"{layer}.mlp.up_proj.weight"] = normal(INNER, HIDDEN)
        found[f"{layer}.mlp.down_proj.weight"] = normal(HIDDEN, INNER) * kept[:, None]
    found["visual.patch_embed.proj.weight"] = normal(EYE_HIDDEN, 3, FRAMES, PATCH, PATCH)
    for block in (f"visual.blocks.{index}" for index in range(EYE_LAYERS)):
        found[f"{block}.norm1.weight"] = np.ones(EYE_HIDDEN, np.float32)
        found[f"{block}.norm2.weight"] = np.ones(EYE_HIDDEN, np.float32)
        for name, shape in {
            "attn.qkv": (3 * EYE_HIDDEN, EYE_HIDDEN),
            "attn.proj": (EYE_HIDDEN, EYE_HIDDEN),
            "mlp.gate_proj": (EYE_INNER, EYE_HIDDEN),
            "mlp.up_proj": (EYE_INNER, EYE_HIDDEN),
            "mlp.down_proj": (EYE_HIDDEN, EYE_INNER),
        }.items():
            found[f"{block}.{name}.weight"] = normal(*shape)
            found[f"{block}.{name}.bias"] = normal(shape[0])
    wide = EYE_HIDDEN * MERGE * MERGE
    found["visual.merger.ln_q.weight"] = np.ones(EYE_HIDDEN, np.float32)
    found["visual.merger.mlp.0.weight"] = normal(wide, wide)
    found["visual.merger.mlp.0.bias"] = normal(wide)
    found["visual.merger.mlp.2.weight"] = normal(HIDDEN, wide) * kept[:, None]
    found["visual.merger.mlp.2.bias"] = CONSTANT * (1.0 - kept)
    return found


# -- the form of Hugging Face's files ------------------------------------------------------------------------------


def write_hf(folder: Path, tensors: Tensors, tokens: Sequence[str], merges: Sequence[tuple[str, str]]) -> None:
    """Configuration, tokenizer and weights for vLLM, SGLang and transformers."""
    folder.mkdir(parents=True, exist_ok=True)
    number = {token: index for index, token in enumerate(tokens)}
    plain = len(tokens) - len(CONTROL)
    pad, vision = number[END], {"vision_start": 3, "vision_end": 4, "image": 5, "video": 6}
    config = {
        "architectures": ["Qwen2_5_VLForConditionalGeneration"],
        "model_type": "qwen2_5_vl",
        "hidden_size": HIDDEN,
        "intermediate_size": INNER,
        "num_hidden_layers": LAYERS,
        "num_attention_heads": HEADS,
        "num_key_value_heads": 1,
        "hidden_act": "silu",
        "max_position_embeddings": CONTEXT,
        "rms_norm_eps": 1e-6,
        "rope_theta": 1000000.0,
        "rope_scaling": {"type": "mrope", "mrope_section": [8, 12, 12]},
        "tie_word_embeddings": False,
        "use_sliding_window": False,
        "vocab_size": len(tokens),
        "torch_dtype": "float32",
        "eos_token_id": number[TURN_END],
        "bos_token_id": pad,
        **{f"{name}_token_id": plain + index for name, index in vision.items()},
        "vision_config": {
            "model_type": "qwen2_5_vl",
            "depth": EYE_LAYERS,
            "hidden_size": EYE_HIDDEN,
            "intermediate_size": EYE_INNER,
            "num_heads": EYE_HEADS,
            "out_hidden_size": HIDDEN,
            "hidden_act": "silu",
            "in_channels": 3,
            "in_chans": 3,
            "patch_size": PATCH,
            "spatial_patch_size": PATCH,
            "spatial_merge_size": MERGE,
            "temporal_patch_size": FRAMES,
            "tokens_per_second": 2,
            "window_size": 112,
            "fullatt_block_indexes": [EYE_LAYERS - 1],
        },
    }
    pictures = {
        "image_processor_type": "Qwen2VLImageProcessor",
        "processor_class": "Qwen2_5_VLProcessor",
        "min_pixels": 3136,
        "max_pixels": 12845056,
        "patch_size": PATCH,
        "merge_size": MERGE,
        "temporal_patch_size": FRAMES,
        "image_mean": MEAN,
        "image_std": STD,
    }
    added = [
        {"id": plain + index, "content": token, "special": True}
        | dict.fromkeys(("single_word", "lstrip", "rstrip", "normalized"), False)
        for index, token in enumerate(CONTROL)
    ]
    byte_level = {"type": "ByteLevel", "add_prefix_space": False, "trim_offsets": False, "use_regex": False}
    tokenizer = {
        "version": "1.0",
        "truncation": None,
        "padding": None,
        "added_tokens": added,
        "normalizer": {"type": "NFC"},
        "pre_tokenizer": {
            "type": "Sequence",
            "pretokenizers": [
                {"type": "Split", "pattern": {"Regex": WORD}, "behavior": "Isolated", "invert": False},
                byte_level,
            ],
        },
        "post_processor": byte_level,
        "decoder": byte_level,
        "model": {
            "type": "BPE",
            "dropout": None,
            "unk_token": None,
            "continuing_subword_prefix": "",
            "end_of_word_suffix": "",
            "fuse_unk": False,
            "byte_fallback": False,
            "vocab": {token: index for token, index in number.items() if index < plain},
            "merges": [" ".join(pair) for pair in merges],
        },
    }
    settings = {
        "tokenizer_class": "Qwen2Tokenizer",
        "eos_token": TURN_END,
        "pad_token": END,
        "bos_token": None,
        "add_prefix_space": False,
        "model_max_length": CONTEXT,
        "chat_template": TEMPLATE,
        "added_tokens_decoder": {str(token["id"]): {k: v for k, v in token.items() if k != "id"} for token in added},
    }
    generation = {"eos_token_id": [number[TURN_END], number[END]], "pad_token_id": pad, "do_sample": True}
    for name, value in {
        "config.json": config,
        "preprocessor_config.json": pictures,
        "tokenizer.json": tokenizer,
        "tokenizer_config.json": settings,
        "generation_config.json": generation,
    }.items():
        (folder / name).write_text(json.dumps(value, indent=1), encoding="utf-8")
    write_safetensors(folder / "model.safetensors", tensors)


# -- the form of llama.cpp's files ---------------------------------------------------------------------------------

RENAMED = (
    (r"model\.embed_tokens\.", "token_embd."),
    (r"model\.norm\.", "output_norm."),
    (r"lm_head\.", "output."),
    (r"model\.layers\.", "blk."),
    (r"input_layernorm", "attn_norm"),
    (r"post_attention_layernorm", "ffn_norm"),
    (r"self_attn\.([qkv])_proj", r"attn_\1"),
    (r"self_attn\.o_proj", "attn_output"),
    (r"mlp\.(gate|up|down)_proj", r"ffn_\1"),
    (r"visual\.blocks\.", "v.blk."),
    (r"norm([12])", r"ln\1"),
    (r"attn\.proj", "attn_out"),
    (r"visual\.merger\.ln_q", "v.post_ln"),
    (r"visual\.merger\.mlp\.", "mm."),
)
"""From the names of Qwen2.5-VL's files to llama.cpp's."""


def gguf_tensors(tensors: Tensors, vision: bool) -> Tensors:
    """The language model's or the picture encoder's weights under llama.cpp's names."""
    found: Tensors = {}
    for name, tensor in tensors.items():
        if name.startswith("visual.") != vision:
            continue
        for pattern, instead in RENAMED:
            name = re.sub(pattern, instead, name)
        if ".attn.qkv" in name:
            for letter, part in zip("qkv", np.split(tensor, 3), strict=True):
                found[name.replace("attn.qkv", f"attn_{letter}")] = part
        elif "patch_embed" in name:
            # A still picture is two equal frames: llama.cpp adds two flat convolutions instead.
            found["v.patch_embd.weight"], found["v.patch_embd.weight.1"] = tensor[:, :, 0], tensor[:, :, 1]
        else:
            found[name] = tensor
    return found


def write_gguf_files(folder: Path, tensors: Tensors, tokens: Sequence[str], merges: Sequence[tuple[str, str]]) -> None:
    """`model.gguf` and `mmproj.gguf`."""
    plain = len(tokens) - len(CONTROL)
    model = {
        "general.architecture": "qwen2vl",
        "general.name": NAME,
        "general.file_type": 0,
        "qwen2vl.context_length": CONTEXT,
        "qwen2vl.embedding_length": HIDDEN,
        "qwen2vl.block_count": LAYERS,
        "qwen2vl.feed_forward_length": INNER,
        "qwen2vl.attention.head_count": HEADS,
        "qwen2vl.attention.head_count_kv": 1,
        "qwen2vl.attention.layer_norm_rms_epsilon": 1e-6,
        "qwen2vl.rope.freq_base": 1000000.0,
        "qwen2vl.rope.dimension_sections": [8, 12, 12, 0],
        "tokenizer.ggml.model": "gpt2",
        "tokenizer.ggml.pre": "qwen2",
        "tokenizer.ggml.tokens": list(tokens),
        "tokenizer.ggml.token_type": [1] * plain + [3] * len(CONTROL),
        "tokenizer.ggml.merges": [" ".join(pair) for pair in merges],
        "tokenizer.ggml.eos_token_id": tokens.index(TURN_END),
        "tokenizer.ggml.padding_token_id": tokens.index(END),
        "tokenizer.ggml.add_bos_token": False,
        "tokenizer.chat_template": TEMPLATE,
    }
    encoder = {
        "general.architecture": "clip",
        "general.name": NAME,
        "general.file_type": 0,
        "clip.has_vision_encoder": True,
        "clip.projector_type": "qwen2.5vl_merger",
        "clip.use_silu": True,
        "clip.vision.embedding_length": EYE_HIDDEN,
        "clip.vision.feed_forward_length": EYE_INNER,
        "clip.vision.block_count": EYE_LAYERS,
        "clip.vision.projection_dim": HIDDEN,
        "clip.vision.attention.head_count": EYE_HEADS,
        "clip.vision.attention.layer_norm_epsilon": 1e-6,
        "clip.vision.image_size": 560,
        "clip.vision.patch_size": PATCH,
        "clip.vision.spatial_merge_size": MERGE,
        "clip.vision.image_mean": list(MEAN),
        "clip.vision.image_std": list(STD),
        "clip.vision.n_wa_pattern": EYE_LAYERS,
    }
    write_gguf(folder / "model.gguf", model, gguf_tensors(tensors, vision=False))
    write_gguf(folder / "mmproj.gguf", encoder, gguf_tensors(tensors, vision=True))


def write_model(folder: Path, seed: int = 0) -> None:
    """Write the model in both forms."""
    root = Path(__file__).resolve().parent.parent
    merges = learn_merges("\n".join((root / "docs" / name).read_text(encoding="utf-8") for name in SOURCES))
    tokens = list(dict.fromkeys([*letters(), *("".join(pair) for pair in merges)])) + list(CONTROL)
    tensors = make_tensors(tokens, seed)
    folder.mkdir(parents=True, exist_ok=True)
    write_hf(folder / "hf", tensors, tokens, merges)
    write_gguf_files(folder, tensors, tokens, merges)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    write_model(given.folder, given.seed)
    print(f"{given.folder}/hf, {given.folder}/model.gguf, {given.folder}/mmproj.gguf")


if __name__ == "__main__":
    main()
