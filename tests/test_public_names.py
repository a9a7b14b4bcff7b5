"""What `import wonderful_team as wt` promises."""

from __future__ import annotations

import importlib
import pkgutil
import subprocess
import sys
import time

import pytest

import wonderful_team as wt

PACKAGES = ["wonderful_team"] + [
    f"wonderful_team.{module.name}" for module in pkgutil.iter_modules(wt.__path__) if module.ispkg
]


def test_star_import_brings_every_public_name() -> None:
    held: dict[str, object] = {}
    exec("from wonderful_team import *", held)  # noqa: S102  a star import must stand at module level
    assert set(wt.__all__) <= set(held)


@pytest.mark.parametrize("name", wt.__all__)
def test_every_public_name_is_documented(name: str) -> None:
    value = getattr(wt, name)
    if callable(value):
        doc = (value.__doc__ or "").strip()
        assert doc, f"wonderful_team.{name} has no docstring"
        assert not doc.startswith(f"{name}("), f"wonderful_team.{name} has only the docstring that dataclass makes"


@pytest.mark.parametrize("package", PACKAGES)
def test_all_is_right_in_every_package(package: str) -> None:
    module = importlib.import_module(package)
    names = getattr(module, "__all__", [])
    assert len(names) == len(set(names))
    assert [name for name in names if not hasattr(module, name)] == []
    assert (module.__doc__ or "").strip(), f"{package} does not say what it is"


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(AttributeError, match="no attribute 'Teem'.*Team"):
        wt.Teem  # noqa: B018


def test_importing_is_fast_and_brings_nothing_heavy() -> None:
    code = (
        "import sys, wonderful_team; print([m for m in ('cv2', 'mujoco', 'skimage', 'pydantic') if m in sys.modules])"
    )
    started = time.monotonic()
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    assert time.monotonic() - started < 2.0
