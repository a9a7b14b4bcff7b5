"""Whatever is handed in, the answer is a named error or a result: never a crash. `benchmarks/fuzz_inputs.py` tries for longer."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.fuzzing import KINDS, AgentSession, attempt

EXAMPLES = 4


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    return AgentSession(tmp_path_factory.mktemp("fuzz"))


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_bad_input_is_named(kind, desk):
    @settings(
        max_examples=EXAMPLES, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck)
    )
    @given(st.data())
    def tried(data):
        argv, wrong = attempt(desk, kind, data.draw)
        assert not wrong, f"{argv}: {wrong}"

    tried()
