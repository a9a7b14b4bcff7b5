"""A key that a server echoes, or that code of one's own has in hand, stands in no byte that is written or printed."""

from __future__ import annotations

import http.server
import json
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

import wonderful_team as wt
from tests.key_codings import AWKWARD, CODINGS, told, told_below
from tests.models.providers.asking import known_brain, small_scene
from tests.servers.brains import AgentSession
from tests.servers.faults import SERVER
from tests.servers.server import Rules, WireServer
from tests.servers.wiring import WIRES
from wonderful_team.cli.app import run
from wonderful_team.core.values import Answer, Request
from wonderful_team.images import to_png
from wonderful_team.models.providers import SERVER_KEY, Provider
from wonderful_team.models.providers import make as making

WIRE = WIRES["server"]
WORDS = "put the first thing into the second thing"
ECHOED_IN = ("reasoning", "text", "words", "where")
"""Fields of answers that a model fills with words of its own."""


@pytest.fixture(autouse=True)
def key(monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setenv(SERVER_KEY, AWKWARD)
    return AWKWARD


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> AgentSession:
    """Where the requests of every provider lie while they are under way; retries are quick."""
    session, asked, made = AgentSession(), Provider.answer, making.Settings

    async def answer(self: Provider, request: Request) -> Answer:
        session.put(request)
        try:
            return await asked(self, request)
        finally:
            session.take(request)

    monkeypatch.setattr(Provider, "answer", answer)
    monkeypatch.setattr(
        making, "Settings", lambda thinking, most, *_, **more: made(thinking, most, 20.0, 2, 0.01, **more)
    )
    return session


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    path = tmp_path / "desk.png"
    path.write_bytes(to_png(small_scene().rgb))
    return path


def command(photo: Path, spec: str, folder: Path, *more: str) -> list[str]:
    cache = ["--cache", "on", "--cache-file", str(folder / "kept.sqlite")]
    return ["plan", str(photo), WORDS, "--model", spec, "--allow-unpriced", *cache, "--out", str(folder), *more]


def echoing(session: AgentSession, coded: str) -> WireServer:
    """A server whose model writes the key into every text of its answers, and into its thinking."""
    brain = known_brain(session, WIRE.speech)

    def echo(heard):
        said = brain(heard)
        text = json.dumps(_with(json.loads(said.text), "@@")).replace("@@", coded)
        return replace(said, text=text, thinking=f"my key is {coded}")

    return WireServer(echo, Rules(key=AWKWARD, local=True))


def _with(value, text):
    if isinstance(value, dict):
        return {
            name: f"{item} {text}" if name in ECHOED_IN and isinstance(item, str) else _with(item, text)
            for name, item in value.items()
        }
    return [_with(item, text) for item in value] if isinstance(value, list) else value


# As the text of an answer is JSON, the codings that are none are written into it as JSON writes them.
IN_JSON = ("json", "json twice", "json with slashes", "every letter escaped", "base64 in json")


@pytest.mark.parametrize("coding", CODINGS)
def test_a_key_in_a_servers_answers(coding, session, photo, tmp_path, capsys, key):
    coded = CODINGS[coding](key)
    coded = coded if coding in IN_JSON else json.dumps(coded)[1:-1]
    folder = tmp_path / "out"
    with echoing(session, coded) as server:
        as_json = ["--json"] if coding in IN_JSON[:4] else []
        assert run(command(photo, WIRE.spec(server), folder, *as_json)) == 0
        # The answers reached the record, and came out of the cache the second time.
        asked = len(server.log)
        assert run(command(photo, WIRE.spec(server), folder)) == 0
        assert len(server.log) == asked
    assert "[redacted]" in (wt_run := next(folder.glob("*_put*")) / "record.json").read_text(encoding="utf-8")
    for argv in (["show", str(wt_run.parent)], ["show", str(wt_run.parent), "--role", "supervisor"]):
        assert run(argv) == 0
    assert run(["list", "runs", "--out", str(folder), "--html", str(folder / "table.html")]) == 0
    captured = capsys.readouterr()
    assert told(captured.out + captured.err, key) == []
    assert told_below(folder, key) == {}


@pytest.mark.parametrize(
    ("fault", "coding"),
    [*(("bad_request", coding) for coding in CODINGS), ("unauthorized", "plain"), ("error_500", "plain")],
)
def test_a_key_in_a_servers_error(fault, coding, session, photo, tmp_path, capsys, key, monkeypatch):
    status, _, code = SERVER[fault]
    # Long enough that the text is cut somewhere in the key.
    monkeypatch.setitem(SERVER, fault, (status, f"{'Wrong. ' * 41} your key is {CODINGS[coding](key)}", code))
    with WireServer(known_brain(session, WIRE.speech), Rules(key=AWKWARD, local=True)) as server:
        server.always(fault)
        assert run(command(photo, WIRE.spec(server), tmp_path / "out", "--json")) in (2, 3)
    captured = capsys.readouterr()
    assert told(captured.out + captured.err, key) == []
    assert told_below(tmp_path / "out", key) == {}
    assert key[:8] not in captured.out + captured.err


class _Echo(http.server.BaseHTTPRequestHandler):
    """Answers with the key in the reason, in a header, and in a body that is no answer."""

    header, status = "X-Request-Id", 500

    def do_POST(self) -> None:
        self.rfile.read(int(self.headers["Content-Length"]))
        said = self.headers["Authorization"].removeprefix("Bearer ")
        self.send_response(self.status, f"No {said}")
        self.send_header(self.header, said)
        self.end_headers()
        self.wfile.write(f"<html>{said}".encode())

    def log_message(self, *_: object) -> None:
        """Say nothing on stderr, which the test searches."""


@pytest.fixture
def echo() -> Iterator[tuple[str, type[_Echo]]]:
    class Handler(_Echo):
        pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/v1#test-model", Handler
    server.shutdown()
    server.server_close()


@pytest.mark.parametrize("header", ["X-Request-Id", "Content-Encoding", "Retry-After", "Location", "Content-Type"])
@pytest.mark.parametrize("status", [200, 302, 400, 429])
def test_a_key_in_a_servers_headers(header, status, echo, session, photo, tmp_path, capsys, key):
    address, handler = echo
    handler.header, handler.status = header, status
    assert run(command(photo, address, tmp_path / "out", "--json")) in (1, 2, 3)
    captured = capsys.readouterr()
    assert told(captured.out + captured.err, key) == []
    assert told_below(tmp_path / "out", key) == {}


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_a_key_follows_no_redirect(status, echo, session, photo, tmp_path, capsys, key):
    address, handler = echo
    reached = []

    class Elsewhere(_Echo):
        def do_GET(self) -> None:
            reached.append(dict(self.headers))
            self.send_error(404)

    class Sends(_Echo):
        def do_GET(self) -> None:
            self.send_response(status)
            self.send_header("Location", f"http://127.0.0.1:{other.server_port}/v1/chat/completions")
            self.end_headers()

    Elsewhere.do_POST = Elsewhere.do_GET
    other = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Elsewhere)
    threading.Thread(target=other.serve_forever, daemon=True).start()
    try:
        handler.do_GET = handler.do_POST = Sends.do_GET
        # With a model's name it is asked at once; without, for its models first.
        for spec in (address, address.partition("#")[0]):
            assert run(command(photo, spec, tmp_path / "out")) in (2, 3)
    finally:
        other.shutdown()
        other.server_close()
    assert reached == []
    assert told(capsys.readouterr().err, key) == []


OWN = """
import os, sys, threading, warnings
KEY = os.environ["WONDERFUL_TEAM_SERVER_KEY"]

class Own:
    name = "own"

    def answer(self, request):
        self.tell()

    def decide(self, situation):
        self.tell()

    def tell(self):
        print("the key is", KEY)
        warnings.warn(f"careful with {KEY}")
        thread = threading.Thread(target=self.fail)
        thread.start()
        thread.join()
        try:
            self.fail()
        except KeyError as error:
            raise RuntimeError(f"failed with {KEY!r} " + "x" * 1980 + KEY) from error

    def fail(self):
        raise KeyError(KEY)
"""


@pytest.fixture
def own(tmp_path: Path) -> str:
    file = tmp_path / "own.py"
    file.write_text(OWN, encoding="utf-8")
    return f"{file}:Own"


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("more", [[], ["--json"], ["--debug"]], ids=str)
@pytest.mark.parametrize("option", ["--model", "--method"])
def test_a_key_in_an_exception_of_ones_own_code(option, more, own, tmp_path, capsys, key):
    first, rest = (more, []) if more == ["--debug"] else ([], more)
    argv = [*first, "run", "tabletop/visual_manipulation", option, own, "--out", str(tmp_path / "out"), *rest]
    assert run(argv) == (3 if option == "--model" else 1)
    captured = capsys.readouterr()
    assert "RuntimeError" in captured.out + captured.err
    assert "[redacted]" in captured.out + captured.err
    assert told(captured.out + captured.err, key) == []
    assert told_below(tmp_path / "out", key) == {}


LATE = """
import atexit, os, threading
KEY = os.environ["WONDERFUL_TEAM_SERVER_KEY"]

def late():
    threading.main_thread().join()
    raise KeyError(KEY)

class Own:
    name = "own"
    def decide(self, situation):
        atexit.register(print, "the last word is", KEY)
        threading.Thread(target=late).start()
        raise RuntimeError("failed")
"""


def test_a_key_that_is_told_after_the_command_has_ended(tmp_path, key):
    (tmp_path / "own.py").write_text(LATE, encoding="utf-8")
    argv = [
        "run",
        "tabletop/visual_manipulation",
        "--method",
        f"{tmp_path / 'own.py'}:Own",
        "--out",
        str(tmp_path / "out"),
    ]
    ended = subprocess.run(
        [sys.executable, "-m", "wonderful_team", *argv], capture_output=True, text=True, check=False, timeout=120
    )
    assert ended.returncode == 1
    assert "the last word is [redacted]" in ended.stdout
    assert "KeyError: '[redacted]'" in ended.stderr
    assert told(ended.stdout + ended.stderr, key) == []


@pytest.mark.filterwarnings("ignore")
def test_a_key_in_a_study(own, tmp_path, capfd, key):
    out = tmp_path / "out"
    argv = ["bench", "tabletop/visual_manipulation", "--seeds", "0:2", "--method", own, "--store", str(out / "s.db")]
    run([*argv, "--no-control", "all", "--out", str(out / "runs"), "--jobs", "2"])
    assert run(["report", str(out / "s.db"), "--out", str(out / "report" / "r.html"), "--csv", str(out / "t.csv")]) == 0
    captured = capfd.readouterr()
    assert "RuntimeError" in (out / "t.csv").read_text(encoding="utf-8")
    assert told(captured.out + captured.err, key) == []
    assert told_below(out, key) == {}


def test_a_key_in_a_notebook(key):
    world = wt.make_world("tabletop/visual_manipulation", seed=3)
    try:
        observation = world.observe()
    finally:
        world.close()
    plan = wt.Team().plan(observation, f"put the {key} into the bowl")
    assert told(plan._repr_html_(), key) == []
    assert "[redacted]" in plan._repr_html_()


def test_runs_stores_and_kept_answers_are_their_owners_alone(session, photo, tmp_path):
    given = tmp_path / "given"
    given.mkdir(mode=0o755)
    folder = given / "deep" / "out"
    with echoing(session, "x") as server:
        assert run(command(photo, WIRE.spec(server), folder)) == 0
    run(["run", "tabletop/visual_manipulation", "--out", str(folder), "--video", str(folder / "a.webp")])
    bench = ["bench", "tabletop/visual_manipulation", "--seeds", "0:1", "--store", str(folder / "studies" / "s.db")]
    run([*bench, "--no-control", "all", "--jobs", "1", "--record", "none"])
    run(["report", str(folder / "studies" / "s.db"), "--out", str(folder / "report" / "r.html")])
    made = [path for path in given.rglob("*") if not path.is_symlink()]
    assert {path.name for path in made} >= {"kept.sqlite", "record.json", "page.html", "s.db", "r.html", "a.webp"}
    modes = {str(path): oct(path.stat().st_mode & 0o777) for path in made}
    assert modes == {str(path): oct(0o700 if path.is_dir() else 0o600) for path in made}
    # What was there before stays as it was.
    assert given.stat().st_mode & 0o777 == 0o755
