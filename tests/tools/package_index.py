"""A package index on this machine, with packages of a few bytes, that notes what it was asked for."""

from __future__ import annotations

import base64
import hashlib
import http.server
import io
import threading
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field


def wheel(name: str, version: str, requires: tuple[str, ...] = (), extras: tuple[str, ...] = ()) -> bytes:
    """A wheel with one module that holds its version."""
    about = f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n"
    about += "".join(f"Provides-Extra: {extra}\n" for extra in extras)
    about += "".join(f"Requires-Dist: {line}\n" for line in requires)
    folder = f"{name}-{version}.dist-info"
    files = {
        f"{name}.py": f"VERSION = {version!r}\n",
        f"{folder}/METADATA": about,
        f"{folder}/WHEEL": "Wheel-Version: 1.0\nGenerator: tests\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    digests = {path: hashlib.sha256(text.encode()).digest() for path, text in files.items()}
    rows = [
        f"{path},sha256={base64.urlsafe_b64encode(digest).rstrip(b'=').decode()},{len(files[path])}"
        for path, digest in digests.items()
    ]
    files[f"{folder}/RECORD"] = "\n".join([*rows, f"{folder}/RECORD,,", ""])
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for path, text in files.items():
            archive.writestr(zipfile.ZipInfo(path), text)
    return packed.getvalue()


@dataclass
class Index:
    """What the index serves, by file name, and what it was asked for since `asked` was last cleared."""

    url: str = ""
    files: dict[str, bytes] = field(default_factory=dict)
    asked: list[str] = field(default_factory=list)
    broken: set[str] = field(default_factory=set)

    def add(self, name: str, version: str, requires: tuple[str, ...] = (), extras: tuple[str, ...] = ()) -> str:
        """Offer one release; its line of a lock comes back."""
        packed = wheel(name, version, requires, extras)
        self.files[f"{name}-{version}-py3-none-any.whl"] = packed
        return f"{name}=={version} --hash=sha256:{hashlib.sha256(packed).hexdigest()}\n"

    def answer(self, path: str) -> tuple[int, str, bytes]:
        """Status, content type and body for one path."""
        self.asked.append(path)
        last = path.strip("/").split("/")[-1]
        if last in self.broken:
            return 404, "text/plain", b"gone"
        if path.startswith("/files/") and last in self.files:
            return 200, "application/octet-stream", self.files[last]
        names = [file for file in self.files if file.split("-")[0] == last.replace("-", "_")]
        links = "".join(f'<a href="/files/{file}">{file}</a>\n' for file in names)
        return (200 if names else 404), "text/html", f"<!DOCTYPE html><html><body>\n{links}</body></html>".encode()


@contextmanager
def serving(index: Index) -> Iterator[Index]:
    """Serve the index on 127.0.0.1 until the block ends."""

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_HEAD(self) -> None:
            self.do_GET(head=True)

        def do_GET(self, head: bool = False) -> None:
            status, kind, body = index.answer(self.path)
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            if not head:
                self.wfile.write(body)

        def log_message(self, *_: object) -> None: ...

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True)
        thread.start()
        index.url = f"http://127.0.0.1:{server.server_address[1]}/simple/"
        yield index
        server.shutdown()
        thread.join(timeout=10)
