"""Messages over the pipe, and where the benchmark is looked for."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from wonderful_team.errors import ConfigError
from wonderful_team.sims.process.frames import HEAD, MAGIC, BrokenPipeProtocol, read_message, write_message
from wonderful_team.sims.vimabench import VimaWorld
from wonderful_team.sims.vimabench.finding import PATH_VARIABLE, PYTHON_VARIABLE, find_installation
from wonderful_team.sims.vimabench.remote import loading


def test_what_is_written_is_read() -> None:
    pipe = io.BytesIO()
    arrays = {"a": np.arange(6, dtype=np.float32).reshape(2, 3), "b": np.zeros((0, 4), np.uint8), "c": np.array([7])}
    arrays["c"] = arrays["c"].astype(np.int32)
    write_message(pipe, {"ask": "step", "word": "Zug"}, arrays)
    write_message(pipe, {"ask": "close"}, {})
    pipe.seek(0)
    said, read = read_message(pipe)
    assert (said["ask"], said["word"]) == ("step", "Zug")
    for name, value in arrays.items():
        assert read[name].dtype == value.dtype
        assert read[name].tolist() == value.tolist()
    assert read_message(pipe)[0]["ask"] == "close"
    with pytest.raises(EOFError):
        read_message(pipe)


def _message(head: object, body: bytes = b"") -> bytes:
    text = json.dumps(head).encode()
    return HEAD.pack(MAGIC, len(text), len(body)) + text + body


@pytest.mark.parametrize(
    "content",
    [
        b"Hello from a C library\n",
        _message({"arrays": []})[:-1],
        HEAD.pack(MAGIC, 2**31, 0),
        _message({"no": "arrays"}),
        _message({"arrays": [["a", "uint8", [5]]]}, b"1234"),
        _message({"arrays": [["a", "uint8", [-1]]]}, b"1234"),
        _message({"arrays": [["a", "object", [1]]]}, b"12345678"),
        _message({"arrays": [["a", "no such type", [1]]]}, b"1"),
    ],
)
def test_what_is_no_message_is_told(content: bytes) -> None:
    with pytest.raises(BrokenPipeProtocol):
        read_message(io.BytesIO(content))


def test_only_plain_numbers_are_sent() -> None:
    with pytest.raises(ValueError, match="complex128"):
        write_message(io.BytesIO(), {}, {"a": np.zeros(2, complex)})
    with pytest.raises(ValueError, match="JSON"):
        write_message(io.BytesIO(), {"a": float("nan")}, {})


def test_without_a_copy_the_error_names_every_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(PYTHON_VARIABLE)
    monkeypatch.delenv(PATH_VARIABLE)
    with pytest.raises(ConfigError) as caught:
        VimaWorld("rotate")
    text = str(caught.value)
    for word in (
        "git clone",
        "-m venv",
        "pip install pybullet",
        f"export {PATH_VARIABLE}=",
        f"export {PYTHON_VARIABLE}=",
    ):
        assert word in text


def test_variables_that_name_nothing_are_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv(PYTHON_VARIABLE, str(tmp_path / "python"))
    with pytest.raises(ConfigError, match="valid is a Python interpreter"):
        find_installation()
    monkeypatch.setenv(PATH_VARIABLE, str(tmp_path))
    with pytest.raises(ConfigError, match="valid is a checkout of VIMA-Bench"):
        find_installation()


def test_a_python_without_the_benchmark_is_told_with_the_steps(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv(PATH_VARIABLE)
    with pytest.raises(ConfigError, match=r"cannot import vima_bench: No module named 'vima_bench'(.|\n)*git clone"):
        VimaWorld("rotate")
    package = tmp_path / "vima_bench"
    package.mkdir()
    (package / "__init__.py").write_text("import omegaconfused\n", encoding="utf-8")
    monkeypatch.setenv(PATH_VARIABLE, str(tmp_path))
    with pytest.raises(ConfigError, match="No module named 'omegaconfused'"):
        VimaWorld("rotate")


def test_a_python_that_cannot_run_the_server_is_told_with_the_steps(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # An interpreter of its own without numpy, as `python -m venv` makes it.
    bare = tmp_path / "python"
    bare.write_text(f'#!/bin/sh\nexec {sys.executable} -S -I "$@"\n', encoding="utf-8")
    bare.chmod(0o755)
    monkeypatch.setenv(PYTHON_VARIABLE, str(bare))
    with pytest.raises(ConfigError, match=r"No module named 'numpy'(.|\n)*pip install pybullet"):
        VimaWorld("rotate")


def test_gymnasium_stands_in_for_the_old_gym(tmp_path: Path) -> None:
    (tmp_path / "gymnasium" / "spaces").mkdir(parents=True)
    (tmp_path / "gymnasium" / "__init__.py").write_text("SUCCESSOR = True\n", encoding="utf-8")
    (tmp_path / "gymnasium" / "spaces" / "__init__.py").write_text("class Box: ...\n", encoding="utf-8")
    (tmp_path / "vima_bench").mkdir()
    (tmp_path / "vima_bench" / "__init__.py").write_text("import gym\nfrom gym.spaces import Box\n", encoding="utf-8")
    code = (
        f"import sys; sys.path.insert(0, {str(Path(loading.__file__).parent)!r})\n"
        f"import loading\nmodule = loading.load({str(tmp_path)!r})\nprint(module.gym.SUCCESSOR, module.Box.__name__)\n"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert said.split() == ["True", "Box"]
