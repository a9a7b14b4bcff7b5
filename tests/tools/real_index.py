"""Stands between an installer and the real package index: notes every question, and offers newer releases of all that is locked."""

from __future__ import annotations

import hashlib
import json
import os
import re
import ssl
import threading
import urllib.request
from pathlib import Path

from tests.tools.package_index import Index, wheel

UPSTREAM = os.environ.get("PIP_INDEX_URL", "https://pypi.org/simple/").rstrip("/")
JSON = "application/vnd.pypi.simple.v1+json"
NEWER = "9999.0"
"""A release of every locked package that nobody has published, and that any resolver would prefer."""


def normal(name: str) -> str:
    """A package's name as an index spells it."""
    return re.sub(r"[-_.]+", "-", name).lower()


class Lock:
    """What a lock names: the versions and the digests of every package."""

    def __init__(self, path: Path) -> None:
        self.versions: dict[str, set[str]] = {}
        self.digests: set[str] = set()
        for line in path.read_text(encoding="utf-8").splitlines():
            if found := re.match(r"([\w.-]+)(?:\[[^]]*\])?==([^\s;]+)", line):
                self.versions.setdefault(normal(found[1]), set()).add(found[2])
            self.digests.update(re.findall(r"--hash=sha256:(\w{64})", line))


class RealIndex(Index):
    """The real index's pages and files, with a newer release beside those of every locked package.

    Attributes:
        asked: Every path that was asked for.
        sent: Every file that was handed out: its name and SHA-256.
    """

    def __init__(self, lock: Lock, kept: Path) -> None:
        super().__init__()
        self.lock, self.kept = lock, kept
        self.sent: list[tuple[str, str]] = []
        self.sources: dict[str, str] = {}
        self._turn = threading.Lock()
        self._ssl = ssl.create_default_context(cafile=os.environ.get("PIP_CERT"))

    def answer(self, path: str) -> tuple[int, str, bytes]:
        """Status, content type and body for one path."""
        with self._turn:
            self.asked.append(path)
            last = path.strip("/").split("/")[-1]
            if path.startswith("/files/"):
                body = self.files.get(last) or self._file(last)
                self.sent.append((last, hashlib.sha256(body).hexdigest()))
                return 200, "application/octet-stream", body
            return 200, "text/html", self._page(normal(last)).encode()

    def _page(self, name: str) -> str:
        """Every release that the real index has, and one that it has not."""
        found = json.loads(self._read(f"{UPSTREAM}/{name}/", JSON))
        lines = ["<!DOCTYPE html>", "<html><body>"]
        for file in found["files"]:
            self.sources[file["filename"]] = file["url"]
            needs = str(file.get("requires-python") or "").replace("<", "&lt;").replace(">", "&gt;")
            needs = f' data-requires-python="{needs}"' if needs else ""
            digest = file["hashes"]["sha256"]
            lines.append(f'<a href="/files/{file["filename"]}#sha256={digest}"{needs}>{file["filename"]}</a>')
        if name in self.lock.versions:
            newer = f"{name.replace('-', '_')}-{NEWER}-py3-none-any.whl"
            self.files[newer] = wheel(name.replace("-", "_"), NEWER, ("never-locked",))
            lines.append(f'<a href="/files/{newer}">{newer}</a>')
        return "\n".join([*lines, "</body></html>"])

    def _file(self, name: str) -> bytes:
        """One file, asked of the real index once and kept for the next installer."""
        kept = self.kept / name
        if not kept.exists():
            kept.write_bytes(self._read(self.sources[name], "*/*"))
        return kept.read_bytes()

    def _read(self, url: str, accept: str) -> bytes:
        request = urllib.request.Request(url, headers={"Accept": accept})
        with urllib.request.urlopen(request, timeout=120, context=self._ssl) as response:
            return bytes(response.read())
