"""A campaign gives one report, whatever computes it and whatever happens meanwhile."""

import hashlib
import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from concurrent.futures import CancelledError, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck import campaign as room
from dualpin.crosscheck import units
from dualpin.crosscheck.campaign import LostError, Store, campaign
from dualpin.crosscheck.checks import Case, chosen
from dualpin.crosscheck.compare import compare
from dualpin.crosscheck.merge import merged
from dualpin.crosscheck.units import slices

pytest.importorskip("pinocchio")

CASES = [Case("ur5"), Case("ur3"), Case("panda", mimic=True), Case("double_pendulum"), Case("double_pendulum", True)]
FEW = {"samples": 7, "seed": 3, "terms": ["fk", "rnea", "crba", "aba"], "engine": "numpy"}


def digest(report):
    """Of all but times and date."""
    data = report.to_dict()
    del data["versions"]
    for robot in data["robots"]:
        del robot["seconds"]
    return hashlib.sha256(json.dumps(data).encode()).hexdigest()


@pytest.fixture
def small(monkeypatch):
    """Slices of three samples; in this process only."""
    monkeypatch.setattr(units, "SLICE", 3)


@pytest.fixture(scope="module")
def serial():
    return digest(campaign(CASES, **FEW))


def test_slices_put_together_are_all_their_samples(small):
    case, checks = Case("ur5"), chosen(["rnea", "aba"])
    parts = slices(case, 7, 0)
    assert [(u.first, u.samples) for u in parts] == [(0, 3), (3, 3), (6, 1)]
    assert parts[0].seed == 0
    assert len({u.seed for u in parts}) == 3
    found = [compare(case, u.samples, u.seed, checks, "numpy") for u in parts]
    whole = merged(parts, found, 0)
    assert whole.samples == 7
    for name, term in whole.terms.items():
        each = [r.terms[name] for r in found]
        assert term.compared == sum(t.compared for t in each) == 7
        assert term.max_scaled_error == max(t.max_scaled_error for t in each) == term.quantiles[-1]
        k = int(np.argmax([t.worst["ratio"] for t in each]))
        assert term.worst["q"] == each[k].worst["q"]
        assert term.worst["sample"] == parts[k].first + each[k].worst["sample"]


def test_a_difference_in_one_slice_is_the_robots(small):
    parts = slices(Case("ur5"), 7, 0)
    found = [compare(Case("ur5"), u.samples, u.seed, chosen(["rnea"]), "numpy") for u in parts]
    found[1].terms["rnea"].settle("differs", "oracle", "wrong")
    found[1].status = "differs"
    whole = merged(parts, found, 0)
    assert not whole.passed
    assert (whole.status, whole.terms["rnea"].nearer, whole.terms["rnea"].reason) == ("differs", "oracle", "wrong")


@pytest.mark.parametrize("make", [lambda: ThreadPoolExecutor(2), lambda: ProcessPoolExecutor(2, get_context("spawn"))])
def test_any_executor_gives_the_report_of_one_process(make, serial):
    with make() as pool:
        assert digest(campaign(CASES, **FEW, executor=pool)) == serial
        assert pool.submit(len, "left open").result() == 9


def test_slices_in_processes_give_the_report_of_one_process(small):
    one = campaign(CASES, **FEW)
    assert one.robots[0].terms["rnea"].compared == 7
    assert digest(campaign(CASES, **FEW, jobs=2)) == digest(one)


class Flaky(Executor):
    """Does so many units, then loses the rest."""

    def __init__(self, units):
        self.left = units

    def submit(self, work, *args, **kwargs):
        future = Future()
        if self.left:
            self.left -= 1
            future.set_result(work(*args, **kwargs))
        else:
            future.set_exception(CancelledError())
        return future


def test_a_lost_executor_leaves_what_it_found_and_the_next_takes_it_up(tmp_path, serial):
    with pytest.warns(dp.DualpinWarning, match="executor was lost"):
        part = campaign(CASES, **FEW, folder=tmp_path, executor=Flaky(2))
    assert part.partial
    seen = []
    again = campaign(CASES, **FEW, folder=tmp_path, progress=lambda result, *_: seen.append(result.name))
    assert len(seen) == len(CASES) - 2
    assert digest(again) == serial


def test_an_executor_that_can_be_made_again_is_made_again(serial):
    made = []

    @contextmanager
    def connect():
        made.append(1)
        yield Flaky(2)

    assert digest(campaign(CASES, **FEW, executor=connect)) == serial
    assert len(made) == 3


def test_an_executor_that_is_always_lost_is_given_up():
    @contextmanager
    def connect():
        yield Flaky(0)

    with pytest.warns(dp.DualpinWarning, match="executor was lost"):
        assert campaign(CASES, **FEW, executor=connect).partial


class Broken(Executor):
    """Its processes lack the package."""

    def submit(self, work, *args, **kwargs):
        future = Future()
        future.set_exception(ModuleNotFoundError("No module named 'dualpin'"))
        return future


def test_an_executor_that_cannot_compute_is_an_error_with_its_reason():
    with pytest.raises(dp.ArgumentError, match=r"cannot compute panda .*No module named"):
        campaign(CASES, **FEW, executor=Broken())


# --- the store -----------------------------------------------------------------------------------


def test_a_store_computes_nothing_twice_but_what_changed(tmp_path, serial):
    path, seen = tmp_path / "all.sqlite", []

    def again(cases=CASES, **settings):
        seen.clear()
        report = campaign(
            cases, **{**FEW, **settings}, store=path, progress=lambda result, *_: seen.append(result.name)
        )
        return digest(report), len(seen)

    assert again() == (serial, 5)
    assert again() == (serial, 0)
    assert again(seed=4)[1] == 5
    robot = tmp_path / "a.urdf"
    for mass in "1", "2":
        robot.write_text(
            f'<robot name="a"><link name="b"/><link name="c"><inertial><mass value="{mass}"/>'
            '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="j" '
            'type="continuous"><parent link="b"/><child link="c"/></joint></robot>'
        )
        assert again([Case(str(robot))])[1] == 1
    arm = dp.load("ur5")
    assert again([Case(arm)])[1] == 1
    assert again([Case(arm)])[1] == 0
    assert again([Case(arm.with_gravity((0, 0, -1)))])[1] == 1


def test_a_unit_that_is_entered_twice_counts_once(tmp_path):
    store = Store(tmp_path / "s.sqlite")
    (unit,) = slices(Case("ur5"), 3, 0)
    name = store.campaign(json.dumps({}), 1, [unit.key])
    first = compare(Case("ur5"), 3, 0, chosen(["fk"]), "numpy")
    store.add(name, unit, first)
    second = compare(Case("ur5"), 3, 1, chosen(["fk"]), "numpy")
    store.add(name, unit, second)
    assert store.result(name, unit).seed == first.seed
    (progress,) = store.progress()
    assert (progress.done, progress.units, progress.verdicts) == (1, 1, {"agrees": 1})


@pytest.mark.campaign
def test_two_campaigns_share_a_store_at_the_same_time(tmp_path):
    path = tmp_path / "s.sqlite"
    program = (
        "import sys; sys.path.insert(0, '.')\n"
        "from tests.crosscheck.test_scale import CASES, FEW, campaign, digest\n"
        "print(digest(campaign(CASES, **{**FEW, 'seed': int(sys.argv[2])}, store=sys.argv[1])))"
    )
    seeds = ["3", "5", "3"]
    running = [
        subprocess.Popen([sys.executable, "-c", program, path, seed], stdout=subprocess.PIPE, text=True)
        for seed in seeds
    ]
    found = [p.communicate(timeout=300)[0].strip() for p in running]
    assert found == [digest(campaign(CASES, **{**FEW, "seed": int(seed)})) for seed in seeds]
    assert [(p.done, p.units) for p in Store(path).progress()] == [(5, 5), (5, 5)]


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_a_killed_process_loses_nothing_that_was_found(tmp_path, serial):
    path = tmp_path / "s.sqlite"
    program = (
        "import sys; sys.path.insert(0, '.')\nimport os, signal\n"
        "from tests.crosscheck.test_scale import CASES, FEW, campaign\n"
        "campaign(CASES, **FEW, store=sys.argv[1], progress=lambda r, done, n: done == 3 and os.kill(os.getpid(), 9))"
    )
    done = subprocess.run([sys.executable, "-c", program, path], timeout=300, check=False)
    assert done.returncode == -signal.SIGKILL
    seen = []
    assert digest(campaign(CASES, **FEW, store=path, progress=lambda r, *_: seen.append(r.name))) == serial
    assert len(seen) == 2


def test_a_full_disk_is_said_and_loses_nothing(tmp_path, monkeypatch, serial):
    path, plain = tmp_path / "s.sqlite", Store.__init__

    def short(self, path=None):
        plain(self, path)
        self._file.execute(f"PRAGMA max_page_count = {pages}")

    pages = 6
    monkeypatch.setattr(Store, "__init__", short)
    with pytest.raises(dp.ArgumentError, match=r"s\.sqlite: database or disk is full; what was written before is kept"):
        campaign(CASES, **FEW, store=path)
    pages, seen = 1000, []
    assert digest(campaign(CASES, **FEW, store=path, progress=lambda r, *_: seen.append(r.name))) == serial
    assert 0 < len(seen) < 5


@pytest.mark.parametrize("content", [b"no database at all, but long enough for a header" * 9, None])
def test_a_file_that_is_no_store_is_refused(tmp_path, content):
    path = tmp_path / "s.sqlite"
    path.write_bytes(content) if content else path.mkdir()
    with pytest.raises(dp.ArgumentError, match=r"campaign: .*s\.sqlite"):
        Store(path)


def test_progress_has_a_rate(tmp_path):
    path = tmp_path / "s.sqlite"
    campaign(CASES[:2], **FEW, store=path)
    (progress,) = Store(path).progress()
    assert progress.rate > 0
    assert progress.remaining == 0
    assert progress.settings["samples"] == 7


@pytest.mark.campaign
@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory is read from /proc")
def test_memory_is_flat_over_a_million_samples(tmp_path):
    """In one process; the first tenth fills caches and the pool of results."""
    page = os.sysconf("SC_PAGE_SIZE")
    curve = []

    def remember(result, done, of):
        curve.append((done, int(Path("/proc/self/statm").read_text().split()[1]) * page))

    report = campaign(
        [Case("ur5")], 1_000_000, 0, ["rnea", "crba", "aba"], store=tmp_path / "s.sqlite", progress=remember
    )
    assert report.robots[0].samples == 1_000_000
    assert len(curve) == 100
    settled = [size for done, size in curve if done > 10]
    print("resident MB:", {done: size >> 20 for done, size in curve if done % 10 == 0})
    assert max(settled) - settled[0] < 32 << 20


# --- Dask ----------------------------------------------------------------------------------------


@contextmanager
def dask_cluster(folder, workers):
    """A scheduler and workers as programs of their own, so that they can be killed."""
    pytest.importorskip("distributed")
    place = folder / "scheduler.json"
    env = os.environ | {"PYTHONPATH": str(Path.cwd()), "DASK_DISTRIBUTED__LOGGING__DISTRIBUTED": "critical"}

    def start(*arguments):
        return subprocess.Popen(
            [sys.executable, "-m", *arguments], env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )

    programs = [
        start("distributed.cli.dask_scheduler", "--scheduler-file", str(place), "--port", "0", "--no-dashboard")
    ]
    try:
        until = time.monotonic() + 60
        while not place.exists() and time.monotonic() < until:
            time.sleep(0.1)
        worker = (
            "distributed.cli.dask_worker", "--scheduler-file", str(place), "--nthreads", "1", "--no-dashboard",
            "--local-directory", str(folder), "--death-timeout", "60", "--no-nanny",
        )  # fmt: skip
        programs += [start(*worker) for _ in range(workers)]
        yield json.loads(place.read_text())["address"], programs, lambda: programs.append(start(*worker))
    finally:
        for p in programs:
            p.kill()
            p.wait()


@pytest.mark.campaign
def test_dask_with_a_killed_worker_gives_the_report_of_one_process(tmp_path, serial):
    with dask_cluster(tmp_path, 2) as (address, programs, more):
        killed = []

        def kill(result, done, n):
            if not killed:
                programs[1].kill()
                killed.append(done)
                more()

        report = campaign(CASES, **FEW, executor=room.executors.scheduler(address), progress=kill)
    assert killed
    assert digest(report) == serial


@pytest.mark.campaign
def test_dask_with_a_killed_scheduler_loses_nothing(tmp_path, serial):
    folder = tmp_path / "out"
    with dask_cluster(tmp_path, 1) as (address, programs, _):
        client = room.executors.scheduler(address)

        @contextmanager
        def once():
            with client() as pool:
                yield pool

        with once() as pool, pytest.warns(dp.DualpinWarning, match="executor was lost"):
            part = campaign(
                CASES, **FEW, folder=folder, executor=pool, progress=lambda r, done, n: done == 2 and programs[0].kill()
            )
    assert part.partial
    assert 0 < len(part.robots) + len(part.refused) < 5
    assert digest(campaign(CASES, **FEW, folder=folder)) == serial


def test_a_scheduler_that_is_none_is_refused():
    with pytest.raises(dp.ArgumentError, match="tcp://host:port"):
        room.executors.scheduler("localhost")


def test_the_lost_are_dualpins_errors():
    assert issubclass(LostError, dp.DualpinError)


def test_the_store_is_plain_sqlite(tmp_path):
    campaign(CASES[:1], **FEW, store=tmp_path / "s.sqlite")
    rows = sqlite3.connect(tmp_path / "s.sqlite").execute("SELECT verdict FROM results").fetchall()
    assert rows == [("agrees",)]
