"""Probing servers with odd conventions over real sockets: behind each stands a model that looks at the pixels it received."""

from __future__ import annotations

import asyncio
from dataclasses import replace

import numpy as np
import pytest

from tests.lab.probing_helpers import LOCAL, bench_of, closing, probed, subject_of
from tests.servers.odd import OddEyes
from tests.servers.server import WireServer
from tests.servers.speech import SPEECHES, Speech, longest_side, qwen25_resize
from wonderful_team.core.caps import Caps
from wonderful_team.errors import BudgetReached, ModelUnavailableError
from wonderful_team.lab.asking import Bench, look
from wonderful_team.lab.limits import picture_limit, schema_kept, thinking_kind
from wonderful_team.lab.marks import marked_scene
from wonderful_team.lab.probe import Options, Subject, probe
from wonderful_team.models.profiles import Profile
from wonderful_team.offline import OfflineModel

ODD = {
    "plain pixels": Speech(),
    "y first, 0 to 1000": SPEECHES["gemini"],
    "its own resize to multiples of 28": Speech("xy", None, qwen25_resize, digits=0),
    "longest side 768, y first": Speech("yx", None, longest_side(768), digits=0),
    "constant offset": Speech("xy", 1000.0, offset=(30.0, -20.0), digits=0),
    "wrong scale": Speech("xy", None, stretch=(0.9, 0.9), digits=0),
    "offset and clamped": Speech("xy", 1000.0, offset=(60.0, 60.0), clamp=True, digits=0),
}


QUICK = ("its own resize to multiples of 28", "longest side 768, y first", "offset and clamped")


@pytest.mark.parametrize("name", [n if n in QUICK else pytest.param(n, marks=pytest.mark.slow) for n in ODD])
def test_an_odd_convention_is_found_and_holds_on_fresh_pictures(name: str) -> None:
    found, _ = probed(OddEyes(ODD[name]))
    profile = found.profile
    assert profile.native_points, found.notes
    assert profile.convention.order == ODD[name].order
    assert profile.native_boxes
    assert not profile.axes
    assert profile.fit.median_px is not None
    assert profile.fit.median_px < 1.5
    assert profile.fit.checked_median_px is not None
    assert profile.fit.checked_median_px < 1.5
    assert (profile.fit.clamped is not None) == ODD[name].clamp


def test_nonsense_means_do_not_use_native_boxes() -> None:
    found, _ = probed(OddEyes(nonsense=True))
    profile = found.profile
    assert not profile.native_points
    assert not profile.native_boxes
    assert profile.axes
    assert all(not fit.good for _, fit in found.fits)
    assert any("do not use native boxes" in note for note in found.notes)
    assert "labelled axes are drawn instead" in profile.warnings[0]


@pytest.mark.slow
def test_boxes_in_another_habit_are_not_used() -> None:
    """Points fit, but boxes come as corner, width and height."""

    def twisted(box: dict[str, float]) -> dict[str, float]:
        return {**box, "x1": box["x1"] - box["x0"], "y1": box["y1"] - box["y0"]}

    profile = probed(OddEyes(twist_box=twisted))[0].profile
    assert profile.native_points
    assert not profile.native_boxes
    assert profile.axes


@pytest.mark.slow
def test_noise_and_wild_answers_are_measured_not_hidden() -> None:
    profile = probed(OddEyes(SPEECHES["gemini"], noise=0.004, wild=0.1))[0].profile
    assert profile.native_points
    assert profile.fit.median_px is not None
    assert 2 < profile.fit.median_px < 14
    assert profile.fit.outliers >= 1


def test_one_picture_per_request_is_found_and_sheets_are_read_from_then_on() -> None:
    found, server = probed(OddEyes(), replace(LOCAL, max_pictures=1), options=Options(most_pictures=4))
    profile = found.profile
    assert (profile.max_pictures, profile.max_pictures_reached, profile.one_picture) == (1, True, True)
    assert any(note.startswith("on a sheet of several pictures: 16 of 16 marks found") for note in found.notes)
    assert len(server.heard[-1].pictures) == 1
    assert "1 picture per request" in profile.line


@pytest.mark.parametrize(
    ("most", "sees", "expected"),
    [(None, "all", (8, False)), (3, "all", (3, True)), (5, "all", (5, True)), (None, "first", (1, True)), (None, "last", (1, True))],
)  # fmt: skip
def test_the_picture_limit_is_found_also_when_pictures_are_dropped_in_silence(
    most: int | None, sees: str, expected: tuple[int, bool]
) -> None:
    with WireServer(OddEyes(sees=sees), replace(LOCAL, max_pictures=most)) as server:
        profile = Profile("mine", f"{server.url}/v1#x")
        bench = bench_of(server)
        found = asyncio.run(closing(bench, picture_limit(bench, profile, 8, 0, lambda line: None)))
    assert found == expected


@pytest.mark.parametrize("seed", range(4))
def test_a_model_that_errs_now_and_then_is_not_a_service_with_a_limit(seed: int) -> None:
    with WireServer(OddEyes(misses=0.15, wild=0.1, seed=seed), LOCAL) as server:
        bench = bench_of(server)
        profile = Profile("mine", f"{server.url}/v1#x")
        found = asyncio.run(closing(bench, picture_limit(bench, profile, 8, 0, lambda line: None)))
    assert found == (8, False)


@pytest.mark.parametrize(
    ("brain", "rule", "expected"),
    [(OddEyes(), "enforced", "enforced"), (OddEyes(obeys=True), "enforced", "ignored"),
     (OddEyes(), "ignored", "ignored"), (OddEyes(), "refused", "refused")],
)  # fmt: skip
def test_whether_schemas_are_enforced(brain: OddEyes, rule: str, expected: str) -> None:
    with WireServer(brain, replace(LOCAL, schemas=rule)) as server:  # type: ignore[arg-type]
        bench = bench_of(server)
        found = asyncio.run(closing(bench, schema_kept(bench, Profile("mine", "x"), 0)))
    assert found == expected


@pytest.mark.parametrize(
    ("thinks", "expected"), [("never", "never"), ("inline", "always"), ("field", "always"), ("switch", "switchable")]
)
def test_whether_thinking_can_be_switched_off(thinks: str, expected: str) -> None:
    async def talk(bench: Bench) -> str:
        await look(bench, bench.model(None), marked_scene(0, (320, 240)))
        return await thinking_kind(bench, Profile("mine", "x"), 0)

    with WireServer(OddEyes(), replace(LOCAL, thinks=thinks)) as server:  # type: ignore[arg-type]
        bench = bench_of(server)
        assert asyncio.run(closing(bench, talk(bench))) == expected


@pytest.mark.slow
def test_a_model_that_never_points_is_no_convention() -> None:
    found, _ = probed(OddEyes(misses=1.0))
    assert not found.profile.native_points
    assert "only 0 of 24 marks were answered" in found.profile.warnings[0]


def test_a_family_s_convention_is_asked_for_first() -> None:
    found, server = probed(OddEyes(SPEECHES["gemini"]), model="gemini-look-alike")
    assert len(found.fits) == 1
    assert "in thousandths" in server.heard[0].words
    assert found.profile.convention.shape.box == "box_2d"


def test_offline_is_probed_as_an_object() -> None:
    model = OfflineModel()
    subject = Subject("offline", lambda profile, thinking: model, provider=False)
    profile = asyncio.run(probe(subject, Options(most_pictures=2))).profile
    assert profile.native_boxes
    assert profile.fit.median_px is not None
    assert profile.fit.median_px < 1.0
    assert profile.convention.order == "xy"


def test_a_cap_before_the_convention_is_an_error_and_after_it_keeps_what_was_found() -> None:
    with WireServer(OddEyes(), LOCAL) as server:
        with pytest.raises(BudgetReached, match="2 calls"):
            asyncio.run(probe(subject_of(server), Options(caps=Caps(calls=2))))
        found = asyncio.run(probe(subject_of(server), Options(caps=Caps(calls=7))))
    assert "7 calls" in found.stopped
    assert found.profile.native_boxes
    assert any("stopped early" in warning for warning in found.profile.warnings)
    assert found.usage.calls == 7
    assert len(server.log) <= 9


def test_a_server_that_fails_is_unavailable_not_badly_fitted() -> None:
    with WireServer(OddEyes(), LOCAL) as server:
        server.always("error_500")
        with pytest.raises(ModelUnavailableError):
            asyncio.run(probe(subject_of(server), Options()))


def test_full_measures_errors_with_counts_and_intervals() -> None:
    eyes = OddEyes(SPEECHES["thousandths"], noise=0.004, misses=0.15, seed=2)
    found, _ = probed(eyes, options=Options(most_pictures=1, full=True, synthetic=5))
    errors = found.profile.errors
    assert errors is not None
    assert replace(found.profile, name="mine").line.endswith("; its errors: simulated:mine)")
    assert errors.scenes[0].kind == "synthetic"
    assert errors.scenes[0].seeds == [1000, 1001, 1002, 1003, 1004]
    assert errors.detection.missed.n == 30
    assert 0 < errors.detection.missed.count < 15
    assert errors.detection.imagined.count == 0
    median = errors.pointing.radial.quantiles[3]
    # Rayleigh: the median distance of noise with this deviation along x and y.
    assert median == pytest.approx(0.004 * np.sqrt(2 * np.log(2)), rel=0.5)
    assert errors.pointing.radial.median_low is not None
    assert errors.pointing.radial.median_low <= median
    # The eyes know nothing of JudgeBox: requests without an answer are counted, not turned into verdicts.
    assert errors.judgement.wrongly_accepted.n == 0
    assert sum(row["no answer"] for row in errors.judgement.counts.values()) > 0
    assert errors.failed_requests.count > 0
