"""How results are stored is measured once on a machine; the bits do not depend on it."""

from __future__ import annotations

import json
import threading

import numpy as np
import pytest

import dualpin as dp
from dualpin.engine.jit import compiler, fast_call, stores
from dualpin.engine.jit.host import this_host

N = 4096


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setenv("DUALPIN_CACHE_DIR", str(tmp_path))
    before = list(compiler.stores)
    compiler.stores[1] = 0
    yield tmp_path / "stores.json"
    compiler.stores[:] = before


@pytest.fixture
def measured(monkeypatch):
    times = []
    monkeypatch.setattr(stores, "_measured", lambda: times.append(1) or 3 << 20)
    return times


@pytest.mark.parametrize("name", ["ur5", "panda"])
@pytest.mark.parametrize("term", ["fk", "crba", "jacobian"])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_both_ways_give_the_same_bits(place, name, term, dtype):
    robot = dp.load(name)
    options = {"frame": robot.frames[-1]} if term == "jacobian" else {}
    kernel = robot.kernel(term, dtype=dtype, **options)
    q = robot.sample(301, seed=0)[0].astype(dtype)
    shape = kernel(q).shape
    found = []
    for threshold in (0, 1 << 62):
        compiler.stores[:] = threshold, 1
        for shift in (0, 1, 3, 7):  # of the first row, in numbers
            room = np.full(np.prod(shape, dtype=int) + 16, np.nan, dtype)
            out = room[shift : shift - 16].reshape(shape)
            kernel(q, out=out)
            assert np.isnan(room[:shift]).all() and np.isnan(room[shift - 16 :]).all()
            found.append(out.copy())
    assert all(np.array_equal(x, found[0]) for x in found)


def test_it_is_measured_once_and_kept(place, measured):
    stores.settle()
    stores.settle()
    assert list(compiler.stores) == [3 << 20, 1] and len(measured) == 1
    compiler.stores[:] = 5, 0
    stores.settle()
    assert list(compiler.stores) == [3 << 20, 1] and len(measured) == 1


@pytest.mark.parametrize(
    "content",
    [
        "",
        "{",
        "[]",
        '"x"',
        '{"machine": 1}',
        '{"past the caches from": 5}',
        "NEGATIVE",
        "TRUE",
        "TEXT",
        "OTHER",
        "\udcff",
    ],
)
def test_a_file_that_says_something_else_is_not_believed(place, measured, content):
    about = {"machine": this_host().key, "past the caches from": 3 << 20}
    wrong = {"NEGATIVE": -1, "TRUE": True, "TEXT": "4194304"}
    if content in wrong:
        content = json.dumps(about | {"past the caches from": wrong[content]})
    elif content == "OTHER":
        content = json.dumps(about | {"machine": "another"})
    place.write_bytes(content.encode("utf-8", "surrogateescape"))
    stores.settle()
    assert len(measured) == 1 and stores._read(this_host().key) == 3 << 20


def test_where_nothing_can_be_written_it_is_measured_anyway(monkeypatch, tmp_path, measured, place):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("DUALPIN_CACHE_DIR", str(tmp_path / "file" / "folder"))
    stores.settle()
    assert compiler.stores[0] == 3 << 20 and len(measured) == 1


def test_threads_measure_once(place, measured):
    threads = [threading.Thread(target=stores.settle) for _ in range(8)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert len(measured) == 1


@pytest.mark.skipif(not fast_call.supported(), reason="needs CPython 3.11 or later on 64 bits")
@pytest.mark.parametrize("given", [False, True])
def test_the_first_large_result_settles_it(place, measured, given):
    robot = dp.load("panda")
    q = robot.sample(N, seed=0)[0]
    out = np.empty((N, 9, 4, 4))
    for n in (1, 64, 256):
        dp.fk(robot, q[:n], out=out[:n])
    assert not measured
    for _ in range(2):
        dp.fk(robot, q, out=out if given else None)
    assert len(measured) == 1


@pytest.mark.skipif(this_host().width < 64, reason="whole lines are stored by AVX-512")
def test_the_measurement_itself(place):
    found = stores._measured()
    assert found in (*stores.SIZES, 1 << 62)
    assert compiler.stores[0] != 0
