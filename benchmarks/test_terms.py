"""Side by side with Pinocchio:  pytest benchmarks --benchmark-enable --benchmark-group-by=param:name,param:term

Correctness is asserted before anything is timed.
"""

from __future__ import annotations

import pytest

import dualpin as dp

pytest.importorskip("pinocchio")
pytest.importorskip("pytest_benchmark")

from dualpin import bench

ROBOTS = ["ur5", "panda", "talos", "talos+floating", "g1", "g1+floating", "tiago_dual"]
LARGE = ("minv", "joint_torque_regressor", "rnea_derivatives", "aba_derivatives")


def pair(name: str, term: str, batch: int) -> bench.Pair:
    if name == "tiago_dual" and term in LARGE:
        pytest.skip("a result of some ten thousand numbers a sample")
    made = bench.Pair(dp.load(name.removesuffix("+floating"), floating=name.endswith("+floating")), term, batch, 1)
    made.check()
    return made


@pytest.fixture(autouse=True)
def one_thread():
    dp.set_num_threads(1)
    yield
    dp.set_num_threads(None)


@pytest.mark.parametrize("batch", [1, 4096])
@pytest.mark.parametrize("term", bench.TERMS_MEASURED)
@pytest.mark.parametrize("name", ROBOTS)
class TestTerms:
    def test_dualpin(self, benchmark, name, term, batch):
        call, _ = pair(name, term, batch).ours()
        benchmark.extra_info.update(samples=batch)
        benchmark(call, 1)

    def test_pinocchio(self, benchmark, name, term, batch):
        call, samples, reference = pair(name, term, batch).theirs()
        benchmark.extra_info.update(samples=samples, reference=reference)
        benchmark(call, 1)
