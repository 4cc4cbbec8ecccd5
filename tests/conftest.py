"""Fixed seeds, printed with every run; the helpers of this folder are importable from any test."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

SEED = int(os.environ.get("DUALPIN_TEST_SEED", "20240611"))

try:
    from hypothesis import settings
except ImportError:  # the other tests need no hypothesis
    pass
else:
    # derandomized: the same examples in every run; no deadline: shared machines pause
    settings.register_profile("dualpin", derandomize=True, deadline=None, max_examples=60, print_blob=True)
    settings.load_profile("dualpin")


def pytest_report_header() -> str:
    return f"dualpin: random tests start from seed {SEED} (environment DUALPIN_TEST_SEED); hypothesis is derandomized"


@pytest.fixture(scope="session")
def seed() -> int:
    """The seed all random tests start from."""
    return SEED


@pytest.fixture
def small_heap() -> Iterator[None]:
    """What other tests left behind is no work of the garbage collector, which this test calls often."""
    gc.collect()
    gc.freeze()
    yield
    gc.unfreeze()
