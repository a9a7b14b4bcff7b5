"""The cache: what counts as the same request, what is kept, and what it costs."""

from __future__ import annotations

import asyncio
from dataclasses import replace

import pytest

from tests.models.cache_helpers import CONTRADICTION, GOOD, Paid, ask, picture, request
from wonderful_team.contracts import PlanReview
from wonderful_team.core.caps import Caps, Estimate
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark
from wonderful_team.errors import BudgetReached, CacheMissError, ConfigError, ModelOutputError, ModelUnavailableError
from wonderful_team.images import Ticks
from wonderful_team.models.budget import Budget
from wonderful_team.models.cache import Cached, cached_models
from wonderful_team.models.cache_key import model_identity, request_key
from wonderful_team.models.cache_store import CacheStore, Stored, default_cache_file
from wonderful_team.models.client import ModelClient
from wonderful_team.offline import OfflineModel


@pytest.fixture
def store(tmp_path):
    return CacheStore(tmp_path / "answers.sqlite")


def test_the_second_time_costs_nothing_and_says_so(store):
    model = Paid()
    cached = Cached(model, store)
    budget = Budget()
    first, second = (ask(cached, request(), budget=budget) for _ in range(2))
    assert model.calls == 1
    assert (first.provenance, second.provenance) == ("model", "cached")
    assert second.value == first.value
    assert (second.raw, second.model_id) == ("as it came", "model-2026")
    assert (second.usage.calls, second.usage.tokens, second.usage.pictures, second.usage.usd) == (0, 0, 0, 0.0)
    assert (budget.spent.calls, budget.spent.usd) == (1, 0.01)


def test_it_outlives_the_process_that_filled_it(tmp_path):
    file = tmp_path / "folder" / "answers.sqlite"
    ask(Cached(Paid(), CacheStore(file)))
    later = Paid()
    assert ask(Cached(later, CacheStore(file), "only")).provenance == "cached"
    assert later.calls == 0


def _changed():
    shown = picture()
    return {
        "picture": request(picture(1)),
        "marks": request(picture(0, (BoxMark(Box(5, 5, 30, 30)),))),
        "words": request(words="look"),
        "system": request(system="You check."),
        "sample": request(sample=1),
        "attempt": request(attempt=1),
        "feedback": request(attempt=1, feedback="x is missing"),
        "previous": request(attempt=1, previous={"a": 1}),
        "schema": request(output=PlanReview),
        "order of parts": replace(request(shown), parts=tuple(reversed(request(shown).parts))),
    }


@pytest.mark.parametrize("what", list(_changed()))
def test_whatever_can_change_the_answer_changes_the_key(what):
    assert request_key(_changed()[what], Paid()) != request_key(request(), Paid())


def test_feedback_and_last_answer_count_each_on_their_own():
    keys = {request_key(request(attempt=1, **more), Paid()) for more in ({}, {"feedback": "f"}, {"previous": {"a": 1}})}
    assert len(keys) == 3


def test_repetitions_models_servers_and_settings_do_not_share():
    identity = Paid().identity
    keys = {
        request_key(request(), Paid()),
        request_key(request(), Paid(), repeat=1),
        *(request_key(request(), Paid(identity={**identity, name: "other"})) for name in identity),
    }
    assert len(keys) == 2 + len(identity)


def test_where_a_request_stands_does_not_count(store):
    """Request ids, time-outs, concurrency and the number of tries that are allowed: no answer depends on them."""
    model = Paid()
    ask(Cached(model, store), request(id="0/act/main/ReviewPath/1"), deadline_s=5, concurrency=1)
    found = ask(Cached(model, store), request(id="3/act/T2/ReviewPath/9"), deadline_s=60, concurrency=4, attempts=1)
    assert (model.calls, found.provenance) == (1, "cached")


def test_axes_are_drawn_in_the_models_own_ticks():
    model = Paid()
    model.ticks = Ticks.THOUSANDTHS
    large = replace(picture(), rgb=picture().rgb)
    assert request_key(request(large), model) != request_key(request(large), Paid())


def test_depth_counts_for_models_that_read_data_and_not_for_those_that_look():
    near, far = request(picture(depth=0.5)), request(picture(depth=0.6))
    assert request_key(near, OfflineModel()) != request_key(far, OfflineModel())
    assert request_key(near, Paid()) == request_key(far, Paid())


def test_a_model_without_identity_is_told_by_its_name_and_its_code():
    said = model_identity(OfflineModel())
    assert said["name"] == "offline"
    assert len(said["code"]) == 16
    with pytest.raises(ConfigError, match="identity must be made of JSON values"):
        model_identity(Paid(identity=object()))


def test_invalid_and_refused_answers_are_asked_for_anew(store):
    refusing = Paid([ModelOutputError("it refused"), GOOD])
    with pytest.raises(ModelOutputError):
        ask(Cached(refusing, store))
    assert ask(Cached(refusing, store)).provenance == "model"
    wrong = Paid([CONTRADICTION, GOOD], identity="wrong")
    assert ask(Cached(wrong, store)).tries == 2
    again = Paid([CONTRADICTION, GOOD], identity="wrong")
    answer = ask(Cached(again, store))
    # The invalid first try was never kept, the valid second one was.
    assert (again.calls, answer.tries, answer.provenance) == (1, 2, "cached")


def test_what_no_longer_fits_the_question_is_asked_for_anew(store):
    model = Paid()
    store.put(request_key(request(), model), Stored(CONTRADICTION, "", "model", "ReviewPath"))
    assert ask(Cached(model, store)).provenance == "model"
    assert ask(Cached(model, store)).provenance == "cached"


def test_answers_that_depend_on_a_truth_or_a_script_are_never_kept(store):
    class Simulated(Paid):
        async def answer(self, asked):
            return replace(await super().answer(asked), provenance="simulated")

    model = Simulated()
    assert [ask(Cached(model, store)).provenance for _ in range(2)] == ["simulated", "simulated"]
    assert store.size().answers == 0


def test_only_never_asks(store):
    model = Paid()
    with pytest.raises(CacheMissError, match=r"holds no answer of vendor:model to ReviewPath \(0/act/main") as miss:
        ask(Cached(model, store, "only"))
    assert miss.value.exit_code == 3
    assert isinstance(miss.value, ModelUnavailableError)
    assert model.calls == 0


def test_identical_requests_at_once_are_sent_once(store):
    model = Paid(delay_s=0.05)
    one, two = Cached(model, store), Cached(model, store)

    async def all_at_once():
        client = ModelClient({"supervisor": one, "*": two}, concurrency=20)
        other = replace(request(), role="checker")
        return await asyncio.gather(*(client.ask(request() if n % 2 else other) for n in range(12)))

    answers = asyncio.run(all_at_once())
    assert model.calls == 1
    assert sorted({answer.provenance for answer in answers}) == ["cached", "model"]
    assert sum(answer.usage.calls for answer in answers) == 1


def test_who_waits_for_another_goes_on_when_that_one_is_cancelled(store):
    model = Paid(delay_s=0.05)
    cached = Cached(model, store)

    async def one_goes_away():
        first = asyncio.create_task(cached.answer(request()))
        await asyncio.sleep(0.01)
        rest = [asyncio.create_task(cached.answer(request())) for _ in range(3)]
        await asyncio.sleep(0.01)
        first.cancel()
        return await asyncio.gather(*rest)

    assert len(asyncio.run(one_goes_away())) == 3
    assert model.calls == 2


def test_an_outage_is_shared_and_not_kept(store):
    model = Paid([ModelUnavailableError("down"), GOOD], delay_s=0.02)
    cached = Cached(model, store)

    async def all_at_once():
        return await asyncio.gather(*(cached.answer(request()) for _ in range(4)), return_exceptions=True)

    assert [str(error) for error in asyncio.run(all_at_once())] == ["down"] * 4
    assert (model.calls, ask(cached).provenance) == (1, "model")


def test_a_cap_on_calls_does_not_stop_kept_answers(store):
    cached = Cached(Paid(), store)
    for number in range(5):
        ask(cached, request(words=str(number)))
    budget = Budget(Caps(calls=1))
    for number in range(5):
        ask(cached, request(words=str(number)), budget=budget)
    assert budget.spent.calls == 0


def test_no_cap_stands_in_the_way_of_a_kept_answer(store):
    class Dear(Paid):
        def estimate(self, asked):
            return Estimate(1000, 1000, 1.0, 1.0)

    cached = Cached(Dear(), store)
    ask(cached)
    assert ask(cached, budget=Budget(Caps(tokens=10, usd=0.001))).provenance == "cached"
    with pytest.raises(BudgetReached):
        ask(cached, request(words="new"), budget=Budget(Caps(usd=0.001)))


# -- which models are cached ----------------------------------------------------------------------------------------


def test_by_default_only_models_with_an_identity_are_cached_and_no_file_is_touched_for_offline(tmp_path):
    file = tmp_path / "answers.sqlite"
    offline, paid = OfflineModel(), Paid()
    models, store = cached_models({"manager": offline}, None, file)
    assert (models["manager"], store, file.exists()) == (offline, None, False)
    models, store = cached_models({"manager": offline, "checker": paid, "mover": paid}, None, file)
    assert models["manager"] is offline
    assert models["checker"] is models["mover"]
    assert models["checker"].identity == paid.identity
    assert store is not None
    assert cached_models({"checker": paid}, "off", file) == ({"checker": paid}, None)
    with pytest.raises(ConfigError, match="valid are on, off, only"):
        cached_models({"checker": paid}, "yes", file)


def test_offline_can_be_cached_when_asked(tmp_path):
    models, _ = cached_models({"*": OfflineModel()}, "on", tmp_path / "answers.sqlite")
    assert models["*"].name == "offline"


def test_the_default_file_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("WONDERFUL_TEAM_CACHE", str(tmp_path / "here.sqlite"))
    assert default_cache_file() == tmp_path / "here.sqlite"
