"""The page of one run: whole, self-contained, safe, and readable after a crash."""

from __future__ import annotations

import html.parser
import json
import re
import shutil

import pytest

from tests.runtime.runtime_fake_run import TalkingPolicy, world_with_pictures
from tests.runtime.runtime_fakes import MovesPolicy, SquaresTruth, SquaresWorld
from wonderful_team.errors import ConfigError
from wonderful_team.pages import write_page
from wonderful_team.record import Recorder
from wonderful_team.runtime import rollout

VOID = {"meta", "br", "img", "link", "input", "hr"}


class Reader(html.parser.HTMLParser):
    """Collects ids, tags and visible text; checks that tags are closed in order."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.tags, self.words, self.attributes = [], [], [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        self.ids += [value for name, value in attrs if name == "id"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        self.ids += [value for name, value in attrs if name == "id"]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, text):
        self.words.append(text)


def read(path):
    reader = Reader()
    reader.feed(path.read_text(encoding="utf-8"))
    assert reader.open == []
    return reader, re.sub(r"\s+", " ", " ".join(reader.words))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A whole run with a replan."""
    path = tmp_path_factory.mktemp("run")
    world = world_with_pictures()
    with Recorder(path, command="wonderful-team run tabletop/squares --seed 3") as recorder:
        policy = TalkingPolicy([recorder])
        truth = SquaresTruth(world, {"red": (200.0, 30.0), "blue": (60.0, 60.0)})
        rollout(policy, world, replans=3, scorer=truth, subscribers=[recorder], seed=3, scene="tabletop/squares")
    write_page(path)
    return path


def test_all_sections_stand_on_the_page(folder):
    reader, text = read(folder / "page.html")
    sections = ["picture", "story", "plan", "targets", "actions", "execution", "replans", "cost", "warnings"]
    assert [name for name in reader.ids if name in [*sections, "requests", "reproduce"]] == [
        *sections,
        "requests",
        "reproduce",
    ]
    for words in (
        "both squares stand where they should",  # reason
        "no vision-language model took part",  # badge in words
        "Is the place free before G1?",  # Verification's question
        "No, so G2 comes after G1.",
        "three samples",  # grounding story
        "accept: tight on the target",
        "T1 point, on the table",  # source of a number
        "(0.484, -0.266, 0.000)",
        "workspace x",
        "[0.250, 0.750] m",
        "+0.117 m",
        "it was put 20 px too far right",  # replan: seen
        "weak depth near T3",  # warnings
        "box clamped",
        "bound of 5 reached",
        "price of this model is not known",
        "Plan the task.",  # a request's words
        "wonderful-team run tabletop/squares --seed 3",
    ):
        assert words in text, words


def test_the_page_is_one_file_without_a_network_or_scripts(folder):
    reader, _ = read(folder / "page.html")
    assert not {"script", "link", "iframe", "img", "object"} & set(reader.tags)
    outside = [
        item for item in reader.attributes if item[1] in ("src", "href") and not item[2].startswith(("#", "data:"))
    ]
    assert outside == []
    assert (folder / "page.html").stat().st_size < 5_000_000
    links = {value[1:] for _, name, value in reader.attributes if name == "href" and value.startswith("#")}
    assert links <= set(reader.ids)
    assert len(reader.ids) == len(set(reader.ids))


def test_every_drawing_says_what_it_shows(folder):
    reader, _ = read(folder / "page.html")
    described = [value for tag, name, value in reader.attributes if tag == "svg" and name == "aria-label"]
    assert len(described) == reader.tags.count("svg") - 1  # the store of pictures is hidden
    assert all(described)


def test_it_can_be_rebuilt_from_the_folder_alone(folder, tmp_path):
    copy = tmp_path / "moved"
    shutil.copytree(folder, copy)
    (copy / "page.html").unlink()
    assert write_page(copy).read_bytes() == (folder / "page.html").read_bytes()


def test_what_was_injected_or_simulated_is_badged(folder, tmp_path):
    copy = tmp_path / "run"
    shutil.copytree(folder, copy)
    record = json.loads((copy / "record.json").read_text(encoding="utf-8"))
    record["planner"]["requests"][-1]["answer"]["provenance"] = "simulated"
    record["planner"]["plans"][-1]["plan"]["grounded"]["T1"]["history"][0]["provenance"] = "injected"
    (copy / "record.json").write_text(json.dumps(record), encoding="utf-8")
    _, text = read(write_page(copy))
    assert "a simulated model with access to the truth answered" in text
    assert "an answer was replaced from outside" in text


def test_text_of_instruction_and_model_stays_text(tmp_path):
    attack = "</pre></svg><script>alert('x')</script><img src=x onerror=alert(1)>"
    world = world_with_pictures(f'put it away {attack} " onload="x')
    with Recorder(tmp_path, command=attack) as recorder:
        rollout(TalkingPolicy([recorder], words=attack), world, subscribers=[recorder], scene=attack)
    reader, text = read(write_page(tmp_path))
    assert "script" not in reader.tags
    assert "img" not in reader.tags
    assert not [name for _, name, _ in reader.attributes if name.startswith("on")]
    assert text.count(attack) >= 3


def test_characters_that_hide_are_escapes_on_the_page_and_in_the_log(tmp_path):
    hidden = "\x1b[2K\u202etxt\u200b"
    world = world_with_pictures(f"put it away {hidden}")
    with Recorder(tmp_path, command=hidden) as recorder:
        rollout(TalkingPolicy([recorder], words=hidden), world, subscribers=[recorder], scene=hidden)
    page = write_page(tmp_path).read_text(encoding="utf-8")
    log = (tmp_path / "log.txt").read_text(encoding="utf-8")
    assert not set(page + log) & set("\x1b\u202e\u200b")
    assert page.count("\\x1b[2K\\u202etxt\\u200b") >= 3


def test_a_half_finished_run_has_a_page(tmp_path):
    recorder = Recorder(tmp_path)
    _, text = read(write_page(tmp_path))
    assert "it was still running when this page was made" in text
    world = SquaresWorld(trouble={1: RuntimeError("cable out")})
    moves = [((60.0, 60.0), (200.0, 30.0))]
    with recorder:
        rollout(MovesPolicy([moves]), world, subscribers=[recorder])
    _, text = read(write_page(tmp_path))
    assert "RuntimeError: cable out" in text
    # The traceback of the user's own code is there to be read.
    assert "Traceback (most recent call last)" in text


def test_a_refusal_shows_its_reasons(tmp_path):
    with Recorder(tmp_path) as recorder:
        rollout(MovesPolicy([[((60.0, 60.0), (400.0, 60.0))]]), SquaresWorld(), subscribers=[recorder])
    _, text = read(write_page(tmp_path))
    assert "refused by the safety gate: action 1: workspace y: -0.266 to 1.062 m" in text


def test_missing_pictures_do_not_stop_the_page(folder, tmp_path):
    copy = tmp_path / "run"
    shutil.copytree(folder, copy)
    shutil.rmtree(copy / "pictures")
    _, text = read(write_page(copy))
    assert "picture missing" in text


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "record.json.* cannot be read: No such file"),
        ("{", "not JSON"),
        ('{"schema_version": 9}', "schema version 9; this release reads 1"),
    ],
)
def test_folders_that_are_not_runs_are_refused(tmp_path, content, message):
    if content is not None:
        (tmp_path / "record.json").write_text(content, encoding="utf-8")
    with pytest.raises(ConfigError, match=message):
        write_page(tmp_path)
