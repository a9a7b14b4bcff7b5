"""The file of kept answers: shared by processes, broken, foreign, locked, or on a network file system."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sqlite3
import time

import pytest

from tests.models.cache_helpers import Paid, ask, fill, fill_for_ever, hold, request
from wonderful_team.errors import ConfigError
from wonderful_team.models.cache import Cached
from wonderful_team.models.cache_store import CacheStore, Stored

PATIENCE_S = 120
"""On a loaded machine a process alone may take long to start [s]."""


@pytest.fixture
def store(tmp_path):
    return CacheStore(tmp_path / "answers.sqlite")


def _foreign(file):
    with sqlite3.connect(file) as connection:
        connection.execute("CREATE TABLE diary (words)")
    connection.close()


def _of_version(version):
    def make(file):
        CacheStore(file).close()
        connection = sqlite3.connect(file)
        connection.execute(f"PRAGMA user_version = {version}")
        connection.close()

    return make


def _cut(file):
    store = CacheStore(file)
    for number in range(50):
        store.put(str(number), Stored({"words": "x" * 4000}, "", "m", "c"))
    store.close()
    file.write_bytes(file.read_bytes()[:100] + os.urandom(60000))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda file: file.write_bytes(b"these are my notes\n" * 400), "broken or no cache"),
        (_foreign, "a database of another program"),
        (_of_version(0), "schema version 0"),
        (_of_version(9), "schema version 9; this release reads 1"),
        (_cut, "broken or no cache"),
    ],
    ids=["text", "foreign", "old", "newer", "corrupt"],
)
def test_a_file_that_is_not_ours_is_refused_and_left_as_it_is(make, says, tmp_path):
    file = tmp_path / "answers.sqlite"
    make(file)
    before = file.read_bytes()
    with pytest.raises(ConfigError, match=says) as refusal:
        CacheStore(file).get("0")
    assert "--cache-file" in str(refusal.value)
    assert str(file) in str(refusal.value)
    assert file.read_bytes() == before


def test_a_folder_and_a_place_that_cannot_be_written_are_told(tmp_path):
    with pytest.raises(ConfigError, match="is a folder"):
        CacheStore(tmp_path)
    (tmp_path / "file").write_text("x")
    with pytest.raises(ConfigError, match="cannot be written: Not a directory"):
        CacheStore(tmp_path / "file" / "answers.sqlite")


def test_a_broken_answer_is_told_and_kept(store):
    store.put("k", Stored({}, "", "m", "c"))
    connection = sqlite3.connect(store.path)
    connection.execute("UPDATE answers SET answer = '{'")
    connection.commit()
    connection.close()
    with pytest.raises(ConfigError, match="the answer under k is broken"):
        store.get("k")
    assert store.size().answers == 1


def test_size_and_clear(store):
    for number in range(3):
        store.put(str(number), Stored({"n": number}, "", "one" if number else "two", "c"))
    size = store.size()
    assert (size.answers, dict(size.by_model)) == (3, {"one": 2, "two": 1})
    assert size.bytes > 0
    assert store.clear() == 3
    assert store.size().answers == 0
    assert store.get("0") is None


def test_the_first_answer_stands(store):
    first, second = Stored({"n": 1}, "", "m", "c"), Stored({"n": 2}, "", "m", "c")
    assert store.put("k", first) == first
    assert store.put("k", second) == first


def test_on_a_network_file_system_it_warns_and_does_without_wal(tmp_path, monkeypatch):
    monkeypatch.setattr("wonderful_team.models.cache_store.network_file_system", lambda path: "nfs4")
    store = CacheStore(tmp_path / "answers.sqlite")
    assert "network file system (nfs4)" in store.warnings[0]
    store.put("k", Stored({}, "", "m", "c"))
    assert not (tmp_path / "answers.sqlite-wal").exists()


def test_locally_it_uses_wal(store):
    store.put("k", Stored({}, "", "m", "c"))
    assert store.path.with_name("answers.sqlite-wal").exists()


# -- several processes ----------------------------------------------------------------------------------------------

SPAWN = multiprocessing.get_context("spawn")


def test_two_processes_may_share_a_file(tmp_path):
    file = tmp_path / "answers.sqlite"
    workers = [SPAWN.Process(target=fill, args=(file, first, 60)) for first in (0, 30)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join(60)
    assert [worker.exitcode for worker in workers] == [0, 0]
    assert CacheStore(file).size().answers == 90


def test_a_process_that_is_killed_while_it_writes_breaks_nothing(tmp_path):
    file = tmp_path / "answers.sqlite"
    worker = SPAWN.Process(target=fill_for_ever, args=(file,))
    worker.start()
    until = time.monotonic() + PATIENCE_S
    while worker.is_alive() and time.monotonic() < until and not (file.exists() and _count(file) > 20):
        time.sleep(0.02)
    os.kill(worker.pid, signal.SIGKILL)
    worker.join(PATIENCE_S)
    assert worker.exitcode == -signal.SIGKILL
    store = CacheStore(file)
    kept = store.size().answers
    assert kept > 20
    model = Paid()
    for number in range(kept):
        assert ask(Cached(model, store), request(words=f"{number} " + "x" * 20000)).provenance == "cached"
    assert model.calls == 0


def _count(file):
    try:
        return CacheStore(file).size().answers
    except ConfigError:
        return 0


def test_a_file_that_is_locked_is_waited_for(tmp_path):
    file = tmp_path / "answers.sqlite"
    store = CacheStore(file)
    worker = SPAWN.Process(target=hold, args=(file, 0.5))
    worker.start()
    for number in range(40):
        store.put(str(number), Stored({}, "", "m", "c"))
        time.sleep(0.05)
        if not worker.is_alive():
            break
    worker.join(10)
    assert worker.exitcode == 0
    assert store.size().answers >= 1
