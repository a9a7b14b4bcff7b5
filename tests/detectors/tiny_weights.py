"""Checkpoints with random weights in the real architectures, in a few hundred kilobytes: what can be tested without a download.

They show whether loading, pixels, prompts, boxes and masks fit the library. They show nothing about what a trained model finds.
"""

from __future__ import annotations

import string
from pathlib import Path
from typing import Any

TEXT_TOKENS = 16


def write_owlv2(folder: Path, kind: str = "owlv2") -> Path:
    """OWLv2 (or OWL-ViT) with 16 patches, reading descriptions letter by letter."""
    import transformers
    from transformers.models.owlv2.image_processing_pil_owlv2 import Owlv2ImageProcessorPil
    from transformers.models.owlvit.image_processing_pil_owlvit import OwlViTImageProcessorPil

    signs = string.ascii_letters + string.digits + string.punctuation
    vocabulary = [*signs, *(f"{sign}</w>" for sign in signs), "<|startoftext|>", "<|endoftext|>"]
    tokens = {token: number for number, token in enumerate(vocabulary)}
    ends = {"bos_token_id": len(tokens) - 2, "eos_token_id": len(tokens) - 1}
    small = {"hidden_size": 16, "intermediate_size": 32, "num_hidden_layers": 1, "num_attention_heads": 2}
    text = {**small, **ends, "vocab_size": len(tokens), "max_position_embeddings": TEXT_TOKENS}
    vision = {**small, "image_size": 64, "patch_size": 16}
    named = {"owlv2": "Owlv2", "owlvit": "OwlViT"}[kind]
    pixels = {"owlv2": Owlv2ImageProcessorPil, "owlvit": OwlViTImageProcessorPil}[kind]
    configuration = getattr(transformers, f"{named}Config")(text_config=text, vision_config=vision, projection_dim=16)
    processor = getattr(transformers, f"{named}Processor")(
        pixels(size={"height": 64, "width": 64}), transformers.CLIPTokenizer(vocab=tokens, merges=[])
    )
    return _saved(folder, getattr(transformers, f"{named}ForObjectDetection"), configuration, processor)


def write_grounding_dino(folder: Path) -> Path:
    """GroundingDINO with 12 queries and a dozen words."""
    import transformers
    from transformers.models.grounding_dino.image_processing_pil_grounding_dino import GroundingDinoImageProcessorPil

    words = "[PAD] [UNK] [CLS] [SEP] [MASK] . red blue block bowl a the".split()
    small = {"hidden_size": 16, "intermediate_size": 32, "num_hidden_layers": 1, "num_attention_heads": 2}
    configuration = transformers.GroundingDinoConfig(
        backbone_config=transformers.SwinConfig(
            image_size=64,
            embed_dim=8,
            depths=[1, 1, 1, 1],
            num_heads=[1, 1, 1, 1],
            window_size=4,
            out_features=["stage2", "stage3", "stage4"],
        ),
        text_config=transformers.BertConfig(vocab_size=len(words), max_position_embeddings=64, **small),
        num_queries=12,
        encoder_layers=1,
        decoder_layers=2,
        encoder_attention_heads=2,
        decoder_attention_heads=2,
        encoder_ffn_dim=32,
        decoder_ffn_dim=32,
        d_model=32,
        encoder_n_points=2,
        decoder_n_points=2,
        max_text_len=32,
    )
    processor = transformers.GroundingDinoProcessor(
        GroundingDinoImageProcessorPil(size={"shortest_edge": 64, "longest_edge": 128}),
        transformers.BertTokenizer(vocab={word: number for number, word in enumerate(words)}),
    )
    return _saved(folder, transformers.GroundingDinoForObjectDetection, configuration, processor)


def write_sam(folder: Path) -> Path:
    """SAM with 64 patches."""
    import transformers
    from transformers.models.sam.image_processing_pil_sam import SamImageProcessorPil

    configuration = transformers.SamConfig(
        vision_config={
            "hidden_size": 16,
            "output_channels": 16,
            "num_hidden_layers": 1,
            "num_attention_heads": 2,
            "image_size": 64,
            "patch_size": 8,
            "window_size": 4,
            "global_attn_indexes": [0],
            "num_pos_feats": 8,
            "mlp_dim": 32,
            "initializer_range": 0.02,
        },
        prompt_encoder_config={"hidden_size": 16, "image_size": 64, "patch_size": 8, "mask_input_channels": 4},
        mask_decoder_config={"hidden_size": 16, "mlp_dim": 32, "num_attention_heads": 2, "iou_head_hidden_dim": 16},
    )
    pixels = SamImageProcessorPil(
        size={"longest_edge": 64},
        pad_size={"height": 64, "width": 64},
        mask_size={"longest_edge": 16},
        mask_pad_size={"height": 16, "width": 16},
    )
    return _saved(folder, transformers.SamModel, configuration, transformers.SamProcessor(pixels))


def _saved(folder: Path, model_class: Any, configuration: Any, processor: Any) -> Path:
    import torch

    torch.manual_seed(0)
    model = model_class(configuration)
    if hasattr(model, "box_head"):
        # Chance alone makes OWLv2's boxes thinner than a pixel: near its own bias each stands on its patch.
        last = model.box_head.dense2
        last.weight.data *= 0.01
        last.bias.data *= 0.0
    model.save_pretrained(folder)
    processor.save_pretrained(folder)
    return folder
