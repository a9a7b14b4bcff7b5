"""What travels to a cluster: files under the names that a study has for them, none that holds a key, not too much."""

from __future__ import annotations

import asyncio
import io
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import wonderful_team as wt
from wonderful_team.errors import ConfigError
from wonderful_team.evals import shipment
from wonderful_team.evals.ray_actors import Places
from wonderful_team.evals.shipment import Shipment, all_below, code_beside, unzip, zipped

LOOK = """
import json, os, sys
sys.path.insert(0, sys.argv[1])
import wonderful_team
from wonderful_team.core.text import user_path
from wonderful_team.evals.shipment import Parcel
Parcel(sys.argv[2], sys.argv[3], sys.argv[4], int).unpack()
print(json.dumps([wonderful_team.__file__, os.environ["WONDERFUL_TEAM_CONFIG"], *(str(user_path(name)) for name in sys.argv[5:])]))
"""


def own(folder: Path) -> Path:
    (folder / "package" / "deep").mkdir(parents=True)
    (folder / "plain").mkdir()
    for name in ("mine.py", "beside.py", "package/__init__.py", "package/deep/more.py", "plain/other.py", "notes.txt"):
        (folder / name).write_text("WORD = 1\n", encoding="utf-8")
    return folder / "mine.py"


def test_a_file_travels_with_what_it_can_import_from_beside_it_and_without_keys(tmp_path: Path) -> None:
    mine = own(tmp_path)
    (tmp_path / "keys.py").write_text("KEY = 'sk-abcdefgh12345678'\n", encoding="utf-8")
    found = [str(path.relative_to(tmp_path)) for path in dict.fromkeys(code_beside(mine))]
    assert found == ["mine.py", "beside.py", "package/__init__.py", "package/deep/more.py"]


def test_what_is_named_and_holds_a_key_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOME_API_KEY", "correct-horse-battery")
    file = tmp_path / "mine.py"
    for text in ("KEY = 'correct-horse-battery'", "KEY = 'sk-abcdefgh12345678'"):
        file.write_text(text, encoding="utf-8")
        with pytest.raises(ConfigError, match="mine.py' holds a key and is not sent") as told:
            Shipment((file,)).pack(tmp_path / text[-5:-1])
        assert "correct" not in str(told.value)
    file.write_text("api_key = os.environ['SOME_API_KEY']", encoding="utf-8")
    Shipment((file,)).pack(tmp_path / "fine")


def test_too_much_is_refused_with_the_largest_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shipment, "LIMIT_BYTES", 1_000_000)
    (tmp_path / "small").write_bytes(b"1" * 10)
    (tmp_path / "large").write_bytes(b"1" * 2_000_000)
    with pytest.raises(ConfigError, match=r"come to 2 MB \(2 files, the largest '.*large'\); at most 1 MB"):
        Shipment((tmp_path / "small", tmp_path / "large")).pack(tmp_path / "to")
    with pytest.raises(ConfigError, match="nowhere' cannot be sent to the cluster: No such file"):
        Shipment((tmp_path / "nowhere",)).pack(tmp_path / "to")


def test_every_name_of_a_file_finds_its_copy_and_others_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import json

    here, parcel_folder = tmp_path / "here", tmp_path / "parcel"
    mine = own(here)
    start = here / "plain"
    monkeypatch.chdir(start)
    monkeypatch.setenv("HOME", str(here))
    parcel = Shipment((mine,), here / "config").pack(parcel_folder)
    assert not list(parcel_folder.rglob("*.pyc"))
    mine.unlink()  # as on a machine that never had it
    names = ["../mine.py", str(mine), "~/mine.py", "/etc/hostname", "../beside.py"]
    words = [sys.executable, "-c", LOOK, str(parcel_folder), parcel.cwd, parcel.home, parcel.config, *names]
    done = subprocess.run(words, cwd="/", capture_output=True, text=True, timeout=120, env={"HOME": "/nowhere"})
    assert done.returncode == 0, done.stderr
    package, config, *found = json.loads(done.stdout)
    assert Path(package).is_relative_to(parcel_folder)
    assert config == str(here / "config")
    copies = parcel_folder / "files"
    copy = copies / mine.relative_to("/")
    assert [Path(name).resolve() for name in found[:3]] == [copy.resolve()] * 3
    assert found[3] == "/etc/hostname"
    assert not Path(found[4]).exists()


def test_a_folder_of_files_travels_without_what_is_hidden(tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()
    for name in ("a.txt", ".env", ".git/config"):
        (tmp_path / name).touch()
    assert all_below(tmp_path) == [tmp_path / "a.txt"]
    with pytest.raises(ConfigError, match="no such file or folder"):
        all_below(tmp_path / "nowhere")


def test_run_folders_come_back_whole_and_never_lie_outside(tmp_path: Path) -> None:
    run = tmp_path / "there" / "trials" / "run"
    run.mkdir(parents=True)
    (run / "page.html").write_text("page", encoding="utf-8")
    (run.parent / "latest").symlink_to("run")
    unzip(zipped(tmp_path / "there"), tmp_path / "here")
    assert [path.name for path in (tmp_path / "here").rglob("*") if path.is_file()] == ["page.html"]
    modes = {path.stat().st_mode & 0o777 for path in (tmp_path / "here").rglob("*") if path.is_dir()}
    assert modes == {0o700}
    assert next((tmp_path / "here").rglob("page.html")).stat().st_mode & 0o777 == 0o600
    assert zipped(tmp_path / "nothing") == b""


def test_what_is_unpacked_stays_in_its_folder(tmp_path: Path) -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("../../outside.txt", "x")
    unzip(packed.getvalue(), tmp_path / "deep" / "here")
    assert [path.relative_to(tmp_path) for path in tmp_path.rglob("*.txt")] == [Path("deep/here/outside.txt")]


def test_a_study_names_what_travels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, runs_folder: Path) -> None:
    from tests.evals.own_files import METHOD

    mine = own(tmp_path)
    mine.write_text(METHOD, encoding="utf-8")
    profiles = Path(runs_folder.with_name(f"{runs_folder.name}-config")) / "profiles"
    monkeypatch.chdir(tmp_path)
    study = wt.Study(
        "rotate",
        methods=["mine.py:Pusher"],
        ray="local",
        ship=["notes.txt"],
        store=tmp_path / "s.db",
        cache_file="a.sqlite",
    )
    sent = study._shipment()
    names = [str(path.relative_to(tmp_path)) for path in sent.files]
    assert names == ["mine.py", "beside.py", "package/__init__.py", "package/deep/more.py", "notes.txt"]
    assert sent.config == profiles.parent
    sent.ready()
    assert study._settings().extra["cache_file"] == tmp_path / "a.sqlite"
    with pytest.raises(ConfigError, match="with --ray"):
        wt.Study("rotate", ship=["notes.txt"])


def test_places_of_a_worker_that_is_gone_go_to_those_that_wait() -> None:
    async def course() -> None:
        places = Places(2)
        await places.acquire("a", "a1")
        await places.acquire("b", "b1")
        waiting = [asyncio.create_task(places.acquire(worker, f"{worker}2")) for worker in ("a", "b", "c")]
        await asyncio.sleep(0)
        await places.release("b2")  # b no longer wants it
        await asyncio.wait_for(waiting[1], 5)
        assert not waiting[2].done()
        await places.lost("a")  # frees a1, and a2 is not handed out
        await asyncio.wait_for(waiting[2], 5)
        await places.release("b1", "b1", "c2")
        await asyncio.wait_for(places.acquire("b", "b3"), 5)
        await asyncio.wait_for(places.acquire("b", "b4"), 5)
        late = asyncio.create_task(places.acquire("b", "b5"))
        await places.acquire("a", "a3")  # gone already: it holds nothing
        await asyncio.sleep(0)
        assert not late.done()
        assert await places.most() == 2
        late.cancel()

    asyncio.run(course())
