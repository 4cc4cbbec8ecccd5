"""Campaigns lose nothing: refusals are reported, interruptions resumed."""

import multiprocessing
import os
import time

import pytest

import dualpin as dp
from dualpin.crosscheck.campaign import all_cases, campaign, executors
from dualpin.crosscheck.campaign.run import PARTIAL
from dualpin.crosscheck.run import Case
from dualpin.crosscheck.units import Unit

pytest.importorskip("pinocchio")

CASES = [Case("ur5"), Case("ur3"), Case("panda", mimic=True), Case("double_pendulum")]
FEW = {"samples": 3, "seed": 0, "terms": ["fk", "rnea", "crba"], "engine": "numpy"}


def facts(report):
    return [(r.label, {k: (t.max_scaled_error, t.passed) for k, t in r.terms.items()}) for r in report.robots]


def test_a_file_that_both_libraries_refuse_is_listed_and_fails_nothing():
    report = campaign(CASES, **FEW)
    assert report.passed
    assert [(r.name, r.by_pinocchio) for r in report.refused] == [("ur3", True)]
    assert "no name" in report.refused[0].reason


def test_a_file_that_only_dualpin_refuses_fails_the_run(tmp_path):
    path = tmp_path / "odd.urdf"
    path.write_text('<robot name="odd"><link name="a"><inertial><mass value="nan"/></inertial></link></robot>')
    report = campaign([Case(str(path))], **FEW)
    assert not report.passed
    assert not report.refused[0].by_pinocchio


def test_an_interrupted_campaign_gives_the_same_result_when_run_again(tmp_path):
    whole = campaign(CASES, **FEW)

    def interrupt(result, done, total):
        if done == 2:
            raise KeyboardInterrupt

    part = campaign(CASES, **FEW, folder=tmp_path, progress=interrupt)
    assert part.partial
    assert not part.passed
    assert (tmp_path / PARTIAL).exists()
    seen = []
    again = campaign(CASES, **FEW, folder=tmp_path, progress=lambda result, *_: seen.append(result.name))
    assert seen == ["panda", "double_pendulum"]
    assert facts(again) == facts(whole)
    assert again.passed
    assert not (tmp_path / PARTIAL).exists()


def test_other_settings_do_not_take_up_old_results(tmp_path):
    def interrupt(result, done, total):
        raise KeyboardInterrupt

    campaign(CASES, **FEW, folder=tmp_path, progress=interrupt)
    seen = []
    campaign(CASES, **{**FEW, "seed": 1}, folder=tmp_path, progress=lambda result, *_: seen.append(result.name))
    assert len(seen) == len(CASES)


class Bomb:
    """Ends whatever process unpickles it."""

    def __reduce__(self):
        return os.abort, ()

    def __str__(self):
        return "bomb"


def test_a_crash_is_a_result_and_takes_nothing_with_it():
    report = campaign([Case("ur5"), Case(Bomb()), Case("double_pendulum")], **FEW, jobs=2)
    found = {r.name: (r.status, r.passed) for r in report.robots}
    assert found == {"ur5": ("agrees", True), "bomb": ("not compared", True), "double_pendulum": ("agrees", True)}
    assert "crashed" in report.robots[1].reason


def at_work(unit):
    time.sleep(unit.samples)
    return unit.key


def test_a_run_that_is_stopped_waits_for_no_unit():
    """A unit may take minutes, and a program ends only when its processes have ended."""
    units = [Unit(Case("quick"), 0, 0, 0, "quick"), Unit(Case("slow"), 0, 300, 0, "slow")]
    found = executors.run(units, at_work, jobs=2)
    others = multiprocessing.active_children()
    assert next(found)[1] == "quick"
    processes = [p for p in multiprocessing.active_children() if p not in others]
    assert len(processes) == 2
    found.close()
    until = time.monotonic() + 30  # asked again: the pool's own thread may have reaped one and not said so yet
    while any(p.is_alive() for p in processes) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(p.is_alive() for p in processes)


def test_two_processes_find_what_one_finds():
    assert facts(campaign(CASES, **FEW, jobs=2)) == facts(campaign(CASES, **FEW))


def test_all_means_every_file_fixed_and_floating_and_mimic_where_there_is_any():
    cases = all_cases()
    files = set(dp.io.catalogue())
    assert {c.name for c in cases if not c.floating and not c.mimic} == files
    assert {c.name for c in cases if c.floating} == files
    assert {"panda", "baxter", "pr2", "romeo"} <= {c.name for c in cases if c.mimic}


@pytest.mark.campaign
def test_every_robot_agrees_with_pinocchio():
    report = campaign(all_cases(), samples=20, seed=1, jobs=2)
    assert report.passed, [r.label for r in report.robots if not r.passed]
    assert len(report.robots) >= 150


def test_where_nothing_could_be_read_nothing_passed():
    report = campaign([Case("ur3")], **FEW)
    assert report.refused
    assert not report.passed


def test_a_file_that_only_pinocchio_refuses_is_not_compared(tmp_path, monkeypatch):
    from dualpin.crosscheck.oracles.pinocchio import OracleError, Pinocchio

    def refuse(*_):
        raise OracleError("Pinocchio refuses ur5.urdf: it has had enough")

    monkeypatch.setattr(Pinocchio, "of_file", refuse)
    monkeypatch.setattr(Pinocchio, "of_robot", refuse)
    (robot,) = campaign([Case("ur5")], **FEW).robots
    assert (robot.status, robot.passed) == ("not compared", True)
    assert "had enough" in robot.remark


def test_what_fails_in_dualpin_alone_fails(monkeypatch):
    from dualpin.crosscheck import compare

    def broken(*_):
        raise dp.ArgumentError("out of order")

    monkeypatch.setattr(compare, "states", broken)
    report = campaign([Case("ur5")], **FEW)
    assert report.robots[0].error == "out of order"
    assert not report.passed
