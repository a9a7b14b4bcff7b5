"""The client library is imported while other things are read: once, and only where a service is asked."""

from __future__ import annotations

import asyncio
import importlib.metadata
import importlib.util
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.models.providers.asking import question
from wonderful_team import registry
from wonderful_team.errors import MissingExtraError
from wonderful_team.models.providers import VENDORS, library, make_provider

PATIENCE_S = 60.0
SERVER = "http://127.0.0.1:9/v1#m"


@pytest.fixture
def nothing_loaded(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[Callable[[str], Any]], None]]:
    """Forgets what was imported; what is given takes the place of importing."""

    def importing(instead: Callable[[str], Any]) -> None:
        held = SimpleNamespace(import_module=instead, util=importlib.util, metadata=importlib.metadata)
        monkeypatch.setattr(library, "importlib", held)

    monkeypatch.setattr(library, "_loading", {})
    yield importing
    for future in library._loading.values():
        future.exception(PATIENCE_S)  # no thread of a test goes on after it


def test_whoever_names_a_model_does_not_wait_for_the_import(nothing_loaded: Any) -> None:
    goes_on, imported = threading.Event(), []

    def slow(name: str) -> None:
        assert goes_on.wait(PATIENCE_S)
        imported.append(name)

    nothing_loaded(slow)
    registry.load_ahead(SERVER)
    provider = make_provider(SERVER)
    service = provider.spec.service
    assert imported == []
    assert not library.is_loaded(service)
    goes_on.set()
    library.loaded(service, SERVER)
    assert library.is_loaded(service)
    assert imported == ["httpx2", "pydantic_ai.direct", service.module]


def test_many_who_wait_import_it_once(nothing_loaded: Any) -> None:
    imported: list[str] = []
    nothing_loaded(imported.append)
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda _: library.loaded(VENDORS["anthropic"], "anthropic:m"), range(40)))
    assert sorted(imported) == sorted(["httpx2", "pydantic_ai.direct", VENDORS["anthropic"].module])


def test_a_part_that_cannot_be_imported_is_told_by_the_first_request_and_tried_anew(nothing_loaded: Any) -> None:
    tried = []

    def broken(name: str) -> None:
        tried.append(name)
        raise ImportError(name)

    nothing_loaded(broken)
    provider = make_provider(SERVER)
    for count in (1, 2):
        with pytest.raises(MissingExtraError, match="vendors"):
            asyncio.run(provider.answer(question()))
        assert len(tried) == count


def test_what_is_not_installed_is_told_when_the_model_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(library, "_is_installed", lambda name: name != "anthropic")
    with pytest.raises(MissingExtraError, match="vendors"):
        make_provider("anthropic:claude-opus-4-5", api_key="x")
    registry.load_ahead({"*": "anthropic:claude-opus-4-5"})  # said later, by whoever makes the model
    assert make_provider(SERVER).name == SERVER


@pytest.mark.parametrize("name", ["httpx2", "no_such_library", "no_such_library.part"])
def test_looking_for_a_package_imports_nothing(name: str) -> None:
    before = set(sys.modules)
    assert library._is_installed(name) == (name == "httpx2")
    assert not any(module.startswith("no_such_library") for module in set(sys.modules) - before)


def test_models_without_a_service_never_import_it(tmp_path: Path) -> None:
    code = f"""
import sys, threading
import numpy as np
import wonderful_team as wt
from wonderful_team import registry
registry.load_ahead({{"*": "offline", "critic": "simulated:perfect"}})
picture = np.full((240, 320, 3), 200, np.uint8)
picture[100:130, 60:90] = (200, 30, 30)
wt.Team(model="offline", out={str(tmp_path)!r}).plan(picture, "put the red block on the left")
assert not [name for name in sys.modules if name.partition(".")[0] in ("pydantic_ai", "httpx2", "openai")]
assert not [one.name for one in threading.enumerate() if one.name == "client library"]
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr


def test_every_connection_pool_trusts_the_same_certificates_without_reading_them_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import httpx2

    library._tls.cache_clear()
    read = []
    made = httpx2.create_ssl_context
    monkeypatch.setattr(httpx2, "create_ssl_context", lambda **how: read.append(how) or made(**how))
    spec = make_provider("anthropic:claude-opus-4-5", api_key="x").spec
    for _ in range(3):
        asyncio.run(library.http_client(spec, "x", False).aclose())
    assert len(read) == 1
    monkeypatch.setenv("SSL_CERT_DIR", "/nowhere")
    asyncio.run(library.http_client(spec, "x", False).aclose())
    assert len(read) == 2
