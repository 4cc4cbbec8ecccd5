"""Subjects of all sorts are asked, and whatever they do is a result."""

from __future__ import annotations

import contextlib
import json
import re
from pathlib import Path

import numpy as np
import pytest

import dualpin as dp
from dualpin.crosscheck.results import Report
from dualpin.crosscheck.subjects import Command, Convention, asking, exchange
from dualpin.crosscheck.subjects.questions import wanted

HERE = Path(__file__).parent
EXAMPLES = HERE / "subject_examples.py"


def apart(name: str, **options) -> Report:
    return dp.judge("ur5", f"{EXAMPLES}:{name}", 6, **options)


def test_pinocchio_agrees_in_every_term_on_a_fixed_and_a_floating_base():
    for robot, floating in (("ur5", False), ("solo8", True)):
        report = dp.judge(robot, "pinocchio", 6, floating=floating)
        assert {t.status for t in report.terms.values()} == {"agrees"}
        assert report.passed and not report.findings
        assert max(t.max_scaled_error for t in report.terms.values()) < 1e-11


def test_a_mapping_of_one_lambda_is_judged():
    arm = dp.load("ur5")
    light = arm.with_gravity((0, 0, -9.8))
    report = dp.judge(arm, {"rnea": lambda q, v, a: dp.rnea(light, q, v, a)}, 6)
    term = report.terms["rnea"]
    assert term.status == "differs" and term.nearer == "dualpin" and not report.passed
    assert [f.key for f in report.findings] == ["gravity"] and "9.8 " in report.findings[0].says
    assert report.findings[0].before > 1e-4 and report.findings[0].after < 1e-12
    assert report.terms["crba"].status == "not compared" and report.terms["crba"].reason == "not offered"
    exact = term.worst["against_50_digits"]
    assert exact["dualpin"] < 1e-14 and exact["pinocchio"] < 1e-14 and exact["oracle"] > 1e-4


def test_the_reproducer_shows_the_difference():
    arm = dp.load("ur5")
    light = arm.with_gravity((0, 0, -9.8))
    report = dp.judge(arm, {"gravity": lambda q: dp.gravity(light, q)}, 6, diagnose=False)
    program = report.terms["gravity"].worst["reproduce"]
    assert len(program.splitlines()) <= 10
    scope = {"subject": type("S", (), {"gravity": staticmethod(lambda q: dp.gravity(light, q))})}
    exec(program.replace("subject.gravity", "got = subject.gravity"), scope)
    worst = report.terms["gravity"].worst
    apart = np.abs(scope["got"] - dp.gravity(arm, scope["q"])).max()
    assert np.isclose(
        apart / max(1, np.abs(dp.gravity(arm, scope["q"])).max()), report.terms["gravity"].max_scaled_error
    )
    assert scope["q"].tolist() == worst["q"]


def test_a_subject_that_says_how_it_is_asked_is_shown_in_its_own_words():
    class Arm:
        def gravity(self, q):
            return [0.0] * 6

    Arm.calls = {"": "import dualpin as dp\nrobot = dp.load('ur5')", "gravity": "x = dp.gravity(robot, q)"}
    term = dp.judge("ur5", Arm(), 4, terms=["gravity"], diagnose=False).terms["gravity"]
    program, scope = term.worst["reproduce"], {}
    assert len(program.splitlines()) <= 10 and "subject." not in program
    exec(program, scope)
    assert np.allclose(scope["x"], json.loads(program.splitlines()[-1].removeprefix("# expected ")), rtol=1e-8)


def test_accelerations_of_frames_are_asked_and_the_spatial_one_is_named():
    arm = dp.load("ur5")

    def spatial(q, v, a, frame):
        return dp.frame_acceleration(arm, q, v, a, frame=frame, reference="local_world_aligned")

    def classical(q, v, a, frame):
        return dp.frame_acceleration(arm, q, v, a, frame=frame, reference="local_world_aligned", classical=True)

    assert dp.judge(arm, {"frame_acceleration": classical}, 4).terms["frame_acceleration"].status == "agrees"
    report = dp.judge(arm, {"frame_acceleration": spatial}, 4)
    assert [f.key for f in report.findings] == ["spatial_acceleration"]
    assert report.terms["frame_acceleration"].verdict.startswith("agrees under another convention")


def test_a_crash_is_a_result_and_the_other_terms_are_asked():
    report = apart("Crashes", diagnose=False)
    assert "crashed (SIGABRT)" in report.terms["gravity"].reason
    assert report.terms["gravity"].status == "not compared"
    assert report.terms["crba"].status == "agrees" and report.terms["rnea"].status == "differs"


def test_a_hang_is_a_result_and_the_other_terms_are_asked():
    report = apart("Hangs", diagnose=False, limit=2.0)
    assert "no answer within 2 s" in report.terms["gravity"].reason
    assert report.terms["crba"].status == "agrees"


def test_objects_are_asked_in_a_process_of_their_own_where_they_can_be_sent_there():
    from subject_examples import Crashes, Hangs

    for kind, said in ((Crashes, "crashed (SIGABRT)"), (Hangs, "no answer within 2 s")):
        subject = kind.__new__(kind)
        subject.robot = dp.load("ur5")
        report = dp.judge("ur5", subject, 6, terms=["crba", "gravity", "rnea"], diagnose=False, limit=2.0)
        assert said in report.terms["gravity"].reason and report.terms["crba"].status == "agrees"
        assert report.robots[0].subject == "light" and not any("this process" in n for n in report.robots[0].notes)
    here = dp.judge("ur5", {"gravity": lambda q: q}, 4, diagnose=False)
    assert any("asked in this process" in n for n in here.robots[0].notes)


def test_a_refusal_is_a_result():
    report = apart("Refuses", diagnose=False)
    assert report.robots[0].reason == "refused: ended with exit code 1: RuntimeError: no such construct"
    assert report.status == "not compared"


def test_a_subject_that_depends_on_its_history_is_named():
    report = apart("Forgets", terms=["gravity"])
    assert [f.key for f in report.findings] == ["history"]


def test_a_slow_subject_is_asked_fewer_states(monkeypatch):
    from subject_examples import Slow

    from dualpin.crosscheck.subjects import running

    monkeypatch.setattr(running, "SECONDS", 0.1)
    arm = dp.load("ur5")
    light = Slow.__new__(Slow)
    light.robot = arm
    report = dp.judge(arm, light, 12, terms=["bias"], diagnose=False)
    assert report.terms["bias"].compared < 12 and "slow" in report.terms["bias"].note


def test_batches_and_single_states_are_the_same():
    arm = dp.load("ur5")
    one = dp.judge(arm, {"crba": lambda q: dp.crba(arm, q)}, 4).terms["crba"]
    many = dp.judge(arm, type("B", (), {"batched": True, "crba": lambda self, q: dp.crba(arm, q)})(), 4).terms["crba"]
    assert one.status == many.status == "agrees" and one.compared == many.compared == 4


def test_joints_a_subject_does_not_know_are_held():
    hand, arm = dp.load("panda"), [f"panda_joint{i}" for i in range(1, 8)]

    def torque(q):
        return dp.gravity(hand, np.r_[q, 0, 0])[:7]

    report = dp.judge(hand, {"gravity": torque, "writes": {"q": arm, "v": arm}}, 6)
    assert report.terms["gravity"].status == "agrees" and report.robots[0].nv == 7
    assert any("held at zero" in note for note in report.robots[0].notes)


@pytest.mark.parametrize(
    ("subject", "message"),
    [
        ("mujco", "shipped"), ({"rnae": len}, "did you mean 'rnea'"), ({"rnea": 3}, "must be a function"),
        (object(), "none of the terms"), ({}, "none of the terms"), (Command("./no_such_program"), "cannot be started"),
        ({"rnea": len, "writes": {"q": ["a"], "v": ["a"]}}, "no column of the robot"),
    ],
)  # fmt: skip
def test_bad_subjects_are_refused_with_the_nearest_choice(subject, message):
    with pytest.raises(dp.ArgumentError, match=message):
        dp.judge("ur5", subject, 4)


@pytest.mark.parametrize("answer", [[1, 2], "x", None, np.full(6, np.nan), np.full((2, 6), 1.0), 1j])
def test_answers_of_no_use_are_said_not_raised(answer):
    term = dp.judge("ur5", {"gravity": lambda q: answer}, 4, diagnose=False).terms["gravity"]
    assert term.status == ("differs" if isinstance(answer, np.ndarray) and answer.shape == (6,) else "not compared")
    assert term.status == "differs" or "expected" in term.reason or "Error" in term.reason


def test_a_report_survives_being_written(tmp_path):
    arm = dp.load("ur5")
    report = dp.judge(arm, {"gravity": lambda q: -dp.gravity(arm, q)}, 6, terms=["gravity"])
    paths = report.write(tmp_path, ("json", "md", "html", "junit", "sarif"))
    assert [p.name for p in paths] == ["report.json", "report.md", "report.html", "junit.xml", "report.sarif"]
    again = Report.from_dict(json.loads(paths[0].read_text()))
    assert again.findings == report.findings and not again.passed
    assert again.terms["gravity"].verdict == report.terms["gravity"].verdict
    assert json.loads(paths[4].read_text())["runs"][0]["results"][0]["ruleId"] == report.findings[0].key
    assert 'failures="1"' in paths[3].read_text()


def test_refused_files_and_subjects_are_in_what_machines_read(tmp_path):
    from xml.etree import ElementTree

    from dualpin.crosscheck.results import Refusal

    report = apart("Refuses", diagnose=False)
    report.refused = [Refusal("both.urdf", "no robot", True), Refusal("ours.urdf", "a <link> without a name", False)]
    junit, sarif = report.write(tmp_path, ("junit", "sarif"))
    cases = {c.get("name"): [e.tag for e in c] for c in ElementTree.parse(junit).iter("testcase")}
    assert cases["both.urdf"] == ["skipped"] and cases["ours.urdf"] == ["failure"]
    results = json.loads(sarif.read_text())["runs"][0]["results"]
    assert [(r["ruleId"], r["level"]) for r in results] == [
        ("not-compared", "warning"), ("refused", "warning"), ("refused", "error")
    ]  # fmt: skip
    assert results[2]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "ours.urdf"


# --- exchange folders ----------------------------------------------------------------------------


def test_answers_in_a_folder_are_read_by_name(tmp_path):
    given = asking("solo12", 4, 0, wanted(["rnea", "crba", "jacobian", "fk", "kinetic_energy"]), floating=True)
    exchange.write(given, tmp_path)
    robot, s = given.robot, given.states
    tau = dp.rnea(robot, s["q"], s["v"], s["a"])
    names = list(reversed(Convention.of(robot).v))
    order = [Convention.of(robot).v.index(n) for n in names]
    lines = [f"sample,{','.join(names)}"] + [
        f"{k}," + ",".join(f"{x:.17g}" for x in tau[k, order]) for k in (2, 0, 3, 1)
    ]
    (tmp_path / "answers/rnea.csv").write_text("\n".join(lines) + "\n")
    energy = dp.kinetic_energy(robot, s["q"], s["v"])
    (tmp_path / "answers/kinetic_energy.csv").write_text(
        "sample,value\n" + "".join(f"{k},{e:.17g}\n" for k, e in enumerate(energy[:3])) + "3,"  # cut off
    )
    (tmp_path / "answers/crba.csv").write_text("sample,row\n0,a\n")
    report = dp.judge("solo12", tmp_path, floating=True)
    assert report.terms["rnea"].status == "agrees" and report.terms["rnea"].max_scaled_error < 1e-15
    assert report.terms["kinetic_energy"].status == "agrees" and "3 of 4" in report.terms["kinetic_energy"].note
    assert "has no column" in report.terms["crba"].reason and report.terms["fk"].reason == "not offered"
    with pytest.raises(dp.ArgumentError, match="written for another robot"):
        dp.judge("ur5", tmp_path)


def test_a_program_that_crashes_half_way_counts_for_what_it_wrote(tmp_path):
    program = tmp_path / "half.py"
    program.write_text(
        "import sys, os, csv\nd = sys.argv[1]\nrows = list(csv.DictReader(open(d + '/states.csv')))\n"
        "names = [n[2:] for n in rows[0] if n.startswith('q.')]\n"
        "f = open(d + '/answers/gravity.csv', 'w')\nprint('sample', *names, sep=',', file=f)\n"
        "for k in range(2): print(k, *('0' for n in names), sep=',', file=f)\nf.flush()\nos.abort()\n"
    )
    report = dp.judge("ur5", Command(f"python3 {program} FOLDER"), 6, terms=["gravity", "rnea"], diagnose=False)
    assert report.terms["gravity"].compared == 2 and "2 of 6" in report.terms["gravity"].note
    assert re.match(r"crashed .*not filled in, or was not reached", report.terms["rnea"].reason)


def test_a_program_that_hangs_is_stopped(tmp_path):
    report = dp.judge("ur5", Command("sh -c 'sleep 60' FOLDER", limit=0.5), 4, terms=["gravity"])
    assert report.robots[0].reason == "refused: no answer within 0.5 s"


# --- interrupted ----------------------------------------------------------------------------------


def test_an_interrupted_judgement_goes_on_where_it_was(tmp_path):
    """Answers that were kept are not asked again: the subject counts its calls in a file."""
    source = tmp_path / "counting.py"
    source.write_text(
        "import dualpin as dp, pathlib, time\nLOG = pathlib.Path(__file__).with_suffix('.log')\n"
        "class Arm:\n    name, version = 'arm', '1'\n"
        "    def __init__(self, urdf): self.robot = dp.load(urdf)\n"
        "    def gravity(self, q):\n        LOG.open('a').write('g'); return dp.gravity(self.robot, q)\n"
        "    def crba(self, q):\n        LOG.open('a').write('m'); time.sleep(0.1); return dp.crba(self.robot, q)\n"
    )
    calls = {"n": 0}

    def interrupting(what):
        calls["n"] += what.startswith("crba")
        if calls["n"] == 1:
            raise KeyboardInterrupt

    asked = {"terms": ["gravity", "crba"], "folder": tmp_path / "kept", "diagnose": False}
    with pytest.raises(KeyboardInterrupt):
        dp.judge("ur5", f"{source}:Arm", 4, **asked, progress=interrupting)
    assert (tmp_path / "kept/judged.jsonl").exists()
    before = source.with_suffix(".log").read_text()
    report = dp.judge("ur5", f"{source}:Arm", 4, **asked)
    after = source.with_suffix(".log").read_text()[len(before) :]
    assert "g" in before and "g" not in after and "m" in after
    assert {t: x.status for t, x in report.terms.items()} == {"gravity": "agrees", "crba": "agrees"}
    assert not (tmp_path / "kept/judged.jsonl").exists()
    source.write_text(source.read_text().replace("return dp.gravity", "return 2 * dp.gravity"))
    assert not dp.judge("ur5", f"{source}:Arm", 4, **asked).passed  # another text is another subject


def test_a_program_that_has_answered_is_not_run_again_unless_its_files_changed(tmp_path):
    """The command of an interrupted judgement, whose program imports a module that lies beside it."""
    (tmp_path / "factor.py").write_text("FACTOR = 0\n")
    program = tmp_path / "answers.py"
    program.write_text(
        "import sys, csv, pathlib\nfrom factor import FACTOR\nd = pathlib.Path(sys.argv[1])\n"
        "pathlib.Path(__file__).with_suffix('.log').open('a').write('run ')\n"
        "rows = list(csv.DictReader(open(d / 'states.csv')))\n"
        "names = [n[2:] for n in rows[0] if n.startswith('q.')]\n"
        "f = open(d / 'answers/gravity.csv', 'w')\nprint('sample', *names, sep=',', file=f)\n"
        "for k in range(len(rows)): print(k, *(FACTOR for n in names), sep=',', file=f)\n"
    )
    command = Command(f"python3 {program} FOLDER")

    def interrupting(what):
        if what.endswith("compared"):
            raise KeyboardInterrupt

    asked = {"terms": ["gravity"], "folder": tmp_path / "kept", "diagnose": False}

    def runs(progress=None):
        log = program.with_suffix(".log")
        before = log.read_text() if log.exists() else ""
        with contextlib.suppress(KeyboardInterrupt):
            dp.judge("ur5", command, 4, **asked, progress=progress)
        return log.read_text()[len(before) :].count("run")

    assert [runs(interrupting), runs(interrupting), runs()] == [1, 0, 0]
    assert runs(interrupting) == 1  # a finished judgement leaves no answers behind
    (tmp_path / "factor.py").write_text("FACTOR = 1\n")
    assert runs() == 1
