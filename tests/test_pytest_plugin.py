"""The pytest plugin and the badge: what a repository guards itself with."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

import dualpin as dp
from dualpin.crosscheck.results import Refusal, Report, RobotResult, TermResult
from dualpin.pytest_plugin import _baseline
from tests.program import run as command

pytest_plugins = ["pytester"]
ARM = Path(__file__).parents[1] / "urdf" / "planar_2r" / "planar_2r.urdf"
WRONG = """
import dualpin as dp


class Subject:
    name = "light"

    def __init__(self, urdf):
        self.robot = dp.load(urdf).with_gravity((0, 0, -9.8))

    def crba(self, q):
        return dp.crba(self.robot, q, engine="numpy")

    def gravity(self, q):
        return dp.gravity(self.robot, q, engine="numpy")

    def bias(self, q, v):
        raise RuntimeError("not today")
"""


@pytest.fixture
def run(pytester):
    """pytest in a folder that holds arm.urdf, bad.urdf and mine.py."""
    pytester.path.joinpath("arm.urdf").write_bytes(ARM.read_bytes())
    pytester.path.joinpath("bad.urdf").write_text('<robot name="bad"><link name="a"/><link name="a"/></robot>')
    pytester.makepyfile(mine=WRONG)
    return lambda *words: pytester.runpytest_inprocess("-p", "dualpin.pytest_plugin", *words)


def test_a_robot_that_agrees_passes_term_by_term_and_is_written_down(run, pytester):
    pytest.importorskip("pinocchio")
    done = run("--dualpin", "arm.urdf", "--dualpin-samples", "3", "--dualpin-terms", "rnea,crba", "-v",
               "--dualpin-out", "out")  # fmt: skip
    done.assert_outcomes(passed=2)
    done.stdout.fnmatch_lines(["arm.urdf::dualpin::rnea PASSED*", "arm.urdf::dualpin::crba PASSED*"])
    out = pytester.path / "out"
    assert {p.name for p in out.iterdir()} >= {"report.json", "report.sarif", "junit.xml", "badge.svg"}
    assert "dualpin: agrees | 2 terms" in (out / "badge.svg").read_text()
    data = json.loads((out / "report.json").read_text())
    assert data["robots"][0]["name"] == "arm.urdf" and data["robots"][0]["samples"] == 3


def test_a_wrong_subject_is_named_with_its_fix_and_silence_is_no_agreement(run):
    done = run("--dualpin", "arm.urdf", "--dualpin-subject", "mine:Subject", "-rs",
               "--dualpin-terms", "crba,gravity,bias,rnea")  # fmt: skip
    done.assert_outcomes(passed=1, failed=2, skipped=1)
    done.stdout.fnmatch_lines([
        "gravity of arm.urdf: light: differs because: gravity", "*gravity is another: -9.8 along z*",
        "*fix: pass gravity = (0, 0, -9.81)*", "*worst: scaled error 1.0e-03*at joint_1, in sample*",
    ])  # fmt: skip
    done.stdout.fnmatch_lines(["bias was not compared: *not today*"])
    done.stdout.fnmatch_lines(["SKIPPED*rnea was not compared: not offered"])


def test_a_subject_that_answers_nothing_is_one_failure(run):
    done = run("--dualpin", "arm.urdf", "--dualpin-subject", "nowhere:Subject", "--dualpin-terms", "crba,gravity,rnea",
               "-rs")  # fmt: skip
    done.assert_outcomes(failed=1, skipped=2)
    done.stdout.fnmatch_lines(["nothing was compared: *No module named 'nowhere'*"])
    done.stdout.fnmatch_lines(["SKIPPED*was not compared, see gravity"])


def test_strict_fails_what_a_subject_does_not_offer(run):
    words = ("--dualpin", "arm.urdf", "--dualpin-subject", "mine.py:Subject", "--dualpin-terms", "crba,rnea")
    done = run(*words, "--dualpin-strict")
    done.assert_outcomes(passed=1, failed=1)
    done.stdout.fnmatch_lines(["rnea was not compared: not offered"])


def test_a_refused_file_is_one_failure_with_the_reason(run, pytester):
    done = run("--dualpin", "bad.urdf", "--dualpin-out", "out")
    done.assert_outcomes(failed=1)
    with pytest.raises(dp.UrdfError) as refusal:
        dp.loads('<robot name="bad"><link name="a"/><link name="a"/></robot>')
    assert str(refusal.value).split(":")[-1].strip() in done.stdout.str()
    assert "dualpin: refused" in (pytester.path / "out" / "badge.svg").read_text()


def test_collecting_asks_nobody_and_k_chooses(run, pytester):
    pytester.makepyfile(loud="from pathlib import Path\n\n\ndef Subject():\n    Path('asked').touch()\n")
    words = ("--dualpin", "arm.urdf", "--dualpin-subject", "loud:Subject")
    done = run(*words, "--collect-only", "-q", "-k", "rnea or crba")
    done.stdout.fnmatch_lines(["arm.urdf::dualpin loud:Subject::crba", "arm.urdf::dualpin loud:Subject::rnea"])
    done.stdout.fnmatch_lines(["4/22 tests collected (18 deselected)*"])  # with those under external wrenches
    assert "::gravity" not in done.stdout.str() and not (pytester.path / "asked").exists()


def test_workers_of_xdist_hand_over_one_report(run, pytester):
    pytest.importorskip("xdist")
    words = ("--dualpin", "arm.urdf", "--dualpin-subject", "mine:Subject", "--dualpin-terms", "crba,gravity")
    run(*words, "-n", "2", "--dist", "loadgroup", "--dualpin-out", "out").assert_outcomes(passed=1, failed=1)
    (robot,) = json.loads((pytester.path / "out" / "report.json").read_text())["robots"]
    assert robot["terms"]["crba"]["status"] == "agrees" and robot["terms"]["gravity"]["status"] == "differs"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--dualpin", "arm.urdf", "--dualpin-terms", "rnae"), "did you mean 'rnea'"),
        (("--dualpin", "arm.urdf", "--dualpin-subject", "pinochio"), "did you mean 'pinocchio'"),
        (("--dualpin-subject", "pinocchio"), "needs a robot"),
    ],
)
def test_wrong_words_end_the_run(run, words, message):
    done = run(*words)
    assert done.ret == pytest.ExitCode.USAGE_ERROR and message in done.stderr.str() + done.stdout.str()


def test_unused_it_imports_nothing_heavy():
    heavy = ("numpy", "lxml", "dualpin.errors", "dualpin.crosscheck")
    code = f"import sys, dualpin.pytest_plugin; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


# --- the badge ---------------------------------------------------------------------------------------


def report(**terms: TermResult) -> Report:
    return Report([RobotResult("arm", False, False, 2, 3, 0, True, dict(terms))])


AGREED = TermResult(status="agrees", compared=3, tolerance=1e-12)
OFF = TermResult(status="differs", nearer="oracle", compared=3, tolerance=1e-12)
NEARER = TermResult(status="differs", nearer="dualpin", compared=3, tolerance=1e-12)
ABSENT = TermResult(status="not compared", reason="M is singular")
REFUSED = Report(refused=[Refusal("x.urdf", "no <link>", True)])


@pytest.mark.parametrize(
    ("of", "text"),
    [
        (report(fk=AGREED, crba=AGREED), "agrees | 2 terms"),
        (report(fk=AGREED, minv=ABSENT), "agrees | 1 of 2 terms"),
        (report(fk=AGREED, crba=OFF), "differs | 1 term"),
        (report(fk=AGREED, crba=NEARER), "differs, dualpin nearer | 2 terms"),
        (report(minv=ABSENT), "not compared"),
        (REFUSED, "refused"), (Report(), "not compared"), (Report(partial=True), "partial"),
    ],
)  # fmt: skip
def test_a_badge_never_says_more_than_was_found(of, text):
    root = ElementTree.fromstring(of.badge())
    assert root.get("aria-label") == f"dualpin: {text}"
    assert ("#2e7d32" in of.badge()) == (text == "agrees | 2 terms")


def test_a_badge_escapes_its_label():
    label = "<script>&\x1b[31m"
    root = ElementTree.fromstring(report(fk=AGREED).badge(label))
    assert len(list(root.iter())) == 10 and "\x1b" not in ElementTree.tostring(root, "unicode")


def test_the_command_writes_a_badge(tmp_path):
    (tmp_path / "r.json").write_text(report(fk=AGREED).to_json())
    (tmp_path / "speed.json").write_text('[{"robot": "a", "term": "fk", "us_per_sample": 1.0}]')
    assert command("report", "r.json", "--badge", "b.svg", cwd=tmp_path).returncode == 0
    assert (tmp_path / "b.svg").read_text() == report(fk=AGREED).badge()
    done = command("report", "speed.json", "--badge", "c.svg", cwd=tmp_path)
    assert done.returncode == 2 and "needs the JSON" in done.stderr and not (tmp_path / "c.svg").exists()


def test_the_page_shows_the_action_as_it_is():
    docs = Path(__file__).parents[1] / "docs"
    assert (docs / "action.yml").read_text(encoding="utf-8") in (docs / "guard.md").read_text(encoding="utf-8")


def test_a_model_that_changed_fails_beside_its_baseline(run, pytester):
    """The subject reads the file that changed too, so that its terms agree: only the baseline knows."""
    words = ("--dualpin", "arm.urdf", "--dualpin-subject", "mine:Subject", "--dualpin-terms", "crba",
             "--dualpin-samples", "2")  # fmt: skip
    run(*words, "--dualpin-out", "before").assert_outcomes(passed=1)
    arm = pytester.path / "arm.urdf"
    arm.write_text(arm.read_text().replace('<mass value="2.5"/>', '<mass value="2.75"/>'))
    done = run(*words, "--dualpin-baseline", "before/report.json")
    done.assert_outcomes(passed=1, failed=1)
    done.stdout.fnmatch_lines(["*arm.urdf*link link_1: mass*2.5 -> 2.75*"])
    for wrong in ("absent.json", "arm.urdf"):
        with pytest.raises(pytest.UsageError, match=f"--dualpin-baseline: .*{wrong}"):
            _baseline(pytester.path / wrong)
