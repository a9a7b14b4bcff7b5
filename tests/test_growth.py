"""Long and large runs stay within 600 MB of memory, in a process of their own; `python -m benchmarks.all --only 600` has their figures."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

MOST_BYTES = 600_000_000
_RUN = """
import sys, warnings
warnings.simplefilter("ignore")
from benchmarks import growth
growth.opening_s = lambda page: None
print(growth.WAYS[sys.argv[1]](False), "| bytes", growth.peak_bytes())
"""


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="only Linux tells how much memory a process held")
@pytest.mark.parametrize("way", ["replans", "looks", "photo"])
def test_memory_is_bounded(way: str) -> None:
    ran = subprocess.run(
        [sys.executable, "-c", _RUN, way], cwd=Path(__file__).parents[1], check=True, capture_output=True, text=True
    )
    assert int(ran.stdout.rpartition("bytes ")[2]) < MOST_BYTES, ran.stdout
