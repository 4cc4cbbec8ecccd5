"""The cells of `make bench-peers`:  pytest benchmarks/test_peers.py --benchmark-enable

Equal before and after; a peer that is not installed is skipped by name, as is a cell that it does not offer.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest

import dualpin as dp
from dualpin import peers
from dualpin.peers.measuring import MEASURED, DifferenceError, Ours, _check
from dualpin.peers.process import AbsentError, Process, write_robot

pytest.importorskip("pytest_benchmark")

ROBOTS = ("ur5", "panda", "talos")
BATCH = 4096


@pytest.fixture(scope="module", params=ROBOTS)
def ours(request):
    dp.set_num_threads(1)
    with tempfile.TemporaryDirectory() as folder:
        found = Ours(dp.load(request.param), BATCH)
        found.folder = Path(folder)
        write_robot(found.robot, found.folder, found.states)
        yield found
    dp.set_num_threads(None)


@pytest.fixture(scope="module", params=peers.NAMES)
def peer(request, ours):
    try:
        found = Process(request.param, ours.folder)
    except AbsentError as e:
        pytest.skip(f"{request.param}: {e}")
    yield found
    found.close()


@pytest.mark.parametrize("one", [False, True], ids=["batch", "one"])
@pytest.mark.parametrize("term", MEASURED)
def test_peer(benchmark, ours, peer, term, one):
    if benchmark.disabled:
        pytest.skip("benchmarks are disabled")
    if term not in peer.terms:
        pytest.skip("not offered")
    theirs = Ours(ours.robot.with_gravity(peer.gravity), BATCH) if peer.gravity else ours
    try:
        _check(peer, theirs, term, one)
    except DifferenceError:
        raise  # another result is a failure; only what a peer refuses is skipped
    except dp.DualpinError as e:
        pytest.skip(str(e))
    benchmark.extra_info.update(
        us_per_sample=1e6 * peer.time(term, one, 1), how=peer.terms[term]["one" if one else "many"]
    )
    benchmark(peer.seconds, term, one)
    _check(peer, theirs, term, one)


@pytest.mark.parametrize("one", [False, True], ids=["batch", "one"])
@pytest.mark.parametrize("term", MEASURED)
def test_dualpin(benchmark, ours, term, one):
    if benchmark.disabled:
        pytest.skip("benchmarks are disabled")
    call, samples, _ = ours.call(term, one)
    benchmark.extra_info.update(samples=samples)
    benchmark(call, 1)
