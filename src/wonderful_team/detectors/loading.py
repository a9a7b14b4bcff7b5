"""Weights of `transformers` models, from this machine alone: nothing is downloaded, and no code out of a checkpoint runs.

Written against transformers 5.24 and torch 2.13 (the optional part `detectors`).
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wonderful_team.errors import ConfigError, MissingExtraError, UnknownNameError

EXTRA = "detectors"
DTYPES = ("float32", "float16", "bfloat16")


@dataclass(frozen=True)
class Weights:
    """Which weights, and where they run.

    Attributes:
        model: A folder, or the name of a checkpoint that was downloaded before.
        revision: Of the checkpoint: a branch, a tag or a commit; "" for the newest that is on this machine.
        device: As torch names it; "" for the first GPU, or the processor where there is none.
        dtype: One of DTYPES.

    Raises:
        ConfigError: An empty name, or an unknown type.
    """

    model: str
    revision: str = ""
    device: str = ""
    dtype: str = "float32"

    def __post_init__(self) -> None:
        if not self.model.strip():
            raise ConfigError(
                "a detector's model is empty; valid: a folder, or a checkpoint's name as in owlv2:MAKER/NAME"
            )
        object.__setattr__(self, "model", str(Path(self.model).expanduser()) if self.model[0] == "~" else self.model)
        if self.dtype not in DTYPES:
            raise UnknownNameError("dtype", self.dtype, DTYPES)


@dataclass(frozen=True, eq=False)
class Loaded:
    """A model in memory with what prepares its inputs and reads its outputs.

    Attributes:
        commit: Of the checkpoint, where the local copy tells; "" for a folder.
    """

    model: Any
    processor: Any
    device: str
    commit: str

    def setting(self, weights: Weights, **thresholds: float) -> dict[str, str]:
        """What a record says of a detector with these weights."""
        return {
            "model": weights.model,
            "revision": weights.revision,
            "commit": self.commit,
            "device": self.device,
            "dtype": weights.dtype,
            **{name: f"{value:g}" for name, value in thresholds.items()},
        }


def load(weights: Weights, feature: str, types: Sequence[str], model_class: str) -> Loaded:
    """A model of `transformers` with its processor, ready to be asked.

    Args:
        weights: Which, and where.
        feature: Who needs it, for messages.
        types: Model types (`model_type` of its configuration) that serve.
        model_class: Name of the class in `transformers`.

    Raises:
        MissingExtraError: torch or transformers are not installed.
        ConfigError: The weights are not on this machine, are of another type or incomplete, or there is no such device.
    """
    torch, transformers = _imported("torch", feature), _imported("transformers", feature)
    device = _device(torch, weights.device)
    where: dict[str, Any] = {"local_files_only": True, "trust_remote_code": False}
    if weights.revision:
        where["revision"] = weights.revision
    with _quiet(transformers), _from_here(weights, feature):
        configuration = transformers.AutoConfig.from_pretrained(weights.model, **where)
        if configuration.model_type not in types:
            raise ConfigError(
                f"{feature}: {weights.model!r} is of the type {configuration.model_type!r}; valid: {', '.join(types)}"
            )
        # Pixels are prepared the same way whether or not torchvision is there.
        processor = transformers.AutoProcessor.from_pretrained(weights.model, backend="pil", **where)
        model, report = getattr(transformers, model_class).from_pretrained(
            weights.model,
            use_safetensors=True,
            dtype=getattr(torch, weights.dtype),
            output_loading_info=True,
            **where,
        )
    missing = sorted(report["missing_keys"])
    if missing:
        raise ConfigError(
            f"{feature}: {weights.model!r} lacks {len(missing)} of its weights, as {', '.join(missing[:3])}: what they are "
            "would be left to chance; download it anew"
        )
    return Loaded(model.to(device).eval(), processor, device, str(getattr(configuration, "_commit_hash", "") or ""))


def _imported(name: str, feature: str) -> Any:
    if importlib.util.find_spec(name) is None:
        raise MissingExtraError(feature, EXTRA)
    try:
        return importlib.import_module(name)
    except (ImportError, OSError, RuntimeError) as error:
        raise ConfigError(f"{feature}: {name} is installed and cannot be imported: it", cause=error) from error


def _device(torch: Any, named: str) -> str:
    device = named or ("cuda" if torch.cuda.is_available() else "cpu")
    try:
        # A device that is not there fails at the first tensor.
        torch.zeros(1, device=device)
    except (RuntimeError, AssertionError, NotImplementedError) as error:
        said = str(error).partition("\n")[0]
        raise ConfigError(
            f"device {device!r} cannot be used: {said}; valid: cpu, or one that torch finds here"
        ) from error
    return device


@contextlib.contextmanager
def _from_here(weights: Weights, feature: str) -> Iterator[None]:
    """What fails while weights are read is said with the way to get them."""
    try:
        yield
    except (OSError, ValueError, KeyError, RuntimeError) as error:
        name, said = weights.model, str(error).partition("\n")[0][:300]
        if Path(name).is_dir():
            raise ConfigError(f"{feature}: the folder {name!r} cannot be read as a checkpoint: {said}") from error
        if Path(name).is_absolute() or name.startswith("."):
            raise ConfigError(f"{feature}: there is no folder {name!r}; valid: one that holds a checkpoint") from error
        revision = ["--revision", weights.revision] if weights.revision else []
        command = shlex.join(["hf", "download", name, *revision])
        raise ConfigError(
            f"{feature}: the weights of {name!r}{f' at {weights.revision!r}' if weights.revision else ''} are not on this "
            f"machine, and nothing is downloaded without being asked for. Download them once, with `{command}` (it comes "
            f"with the optional part {EXTRA!r}), or name a folder that holds them, as in NAME:/path/to/folder"
        ) from error


@contextlib.contextmanager
def _quiet(transformers: Any) -> Iterator[None]:
    """No bars of progress among our own lines; warnings and errors stay."""
    log = transformers.utils.logging
    shown = log.is_progress_bar_enabled()
    log.disable_progress_bar()
    try:
        yield
    finally:
        if shown:
            log.enable_progress_bar()
