"""The command line, run as a program."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from dualpin.crosscheck.campaign import Store
from tests.program import run

pytest.importorskip("pinocchio")


def test_list_prints_names_and_aliases():
    done = run("list")
    command = [sys.executable, "-m", "dualpin", "list"]
    process = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (process.returncode, process.stdout, process.stderr)
    assert done.returncode == 0
    assert "panda\n" in done.stdout
    assert "ur5_robot  (also ur5)" in done.stdout


def test_info_tells_the_order_of_q_and_what_was_assumed():
    done = run("info", "pr2")
    assert done.returncode == 0
    assert "triangle inequality" in done.stdout
    data = json.loads(run("info", "panda", "--json").stdout)
    assert data["nq"] == 9
    assert data["joints"][0]["name"] == "panda_joint1"


def test_fk_prints_full_precision():
    done = run("fk", "ur5", "--q", "0,0,0,0,0,0", "--json")
    data = json.loads(done.stdout)
    assert data["frame"] == "tool0"
    assert data["pose"][3] == [0, 0, 0, 1]
    assert len(run("fk", "ur5", "--dual-quaternion").stdout.split()) == 8


def test_validate_passes_with_exit_code_0_and_json_alone_on_stdout(tmp_path):
    done = run(
        "validate", "ur5", "--samples", 3, "--engine", "numpy", "--json", "--out", tmp_path / "out", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["passed"] is True
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["report.html", "report.json", "report.md"]
    again = run("report", tmp_path / "out" / "report.json")
    assert again.returncode == 0
    assert "passed: 1 robots" in again.stdout


def test_a_failed_report_has_exit_code_1(tmp_path):
    path = tmp_path / "report.json"
    done = run("validate", "double_pendulum", "--samples", 2, "--terms", "fk", "--engine", "numpy", "--json")
    data = json.loads(done.stdout)
    data["robots"][0]["passed"] = False
    path.write_text(json.dumps(data))
    assert run("report", path).returncode == 1


MASSLESS = """<robot name="m"><link name="a"/><link name="b"/><joint name="j" type="continuous">
<parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>"""


def test_what_was_not_compared_is_never_called_passed_and_fails_only_where_strict(tmp_path):
    path = tmp_path / "massless.urdf"
    path.write_text(MASSLESS)
    done = run("validate", path, "--samples", 2, "--engine", "numpy")
    assert done.returncode == 0, done.stderr
    assert "passed" not in done.stdout
    assert "no moving body has mass" in done.stdout
    done = run("validate", path, "--samples", 2, "--engine", "numpy", "--strict", "--json")
    assert done.returncode == 1
    data = json.loads(done.stdout)
    assert (data["status"], data["passed"]) == ("not compared", True)
    assert data["engine"] == "numpy"
    assert data["processor"]
    terms = data["robots"][0]["terms"]
    assert terms["fk"]["status"] == "agrees"
    assert terms["rnea"]["status"] == "not compared"
    assert "no moving body has mass" in terms["rnea"]["reason"]
    assert terms["rnea"]["max_scaled_error"] == 0.0


@pytest.mark.parametrize(("arguments", "message"), [
    (("info", "pandda"), "did you mean 'panda'"),
    (("validate", "nowhere.urdf"), "no such file"),
    (("validate",), "name robots, or give --all"),
    (("validate", "ur5", "--terms", "rnae"), "did you mean 'rnea'"),
    (("validate", "ur5", "--terms", "rnea", "crba"), "'crba' is a term, not a robot; terms go between commas"),
    (("fk", "ur5", "--q", "1,2"), "6 finite numbers"),
    (("fk", "ur5", "--frame", "tool"), "did you mean 'tool0'"),
    (("report", "nothing.json"), "cannot read"),
    (("nonsense",), "nonsense"),
])  # fmt: skip
def test_bad_input_has_exit_code_2_and_one_clear_line(arguments, message):
    done = run(*arguments)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_a_closed_pipe_is_no_error():
    command = f"{sys.executable} -m dualpin list | head -1"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, timeout=60, check=False)
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_leaves_partial_results_and_says_so(tmp_path):
    command = [sys.executable, "-m", "dualpin", "validate", "ur5", "panda", "talos", "tiago_dual", "--floating",
               "--terms", "rnea,crba,minv,coriolis", "--samples", "400", "--engine", "numpy", "--jobs", "1",
               "--out", str(tmp_path)]  # fmt: skip
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    partial = tmp_path / "partial.sqlite"
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and not (partial.exists() and any(p.done for p in Store(partial).progress())):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert "partial" in out and err.endswith("dualpin: interrupted\n")
    assert json.loads((tmp_path / "report.json").read_text())["partial"] is True
    assert partial.exists()


def test_integrate_and_bench_print_rows():
    done = run("integrate", "ur5", "--frame", "tool0", "--dt", "1", "--turns", "1", "--gain", "0", "--json")
    rows = json.loads(done.stdout)
    assert [r["method"] for r in rows] == ["euler", "trapezoidal", "abm4", "rk4"]
    assert rows[3]["position_peak"] < rows[0]["position_peak"]
    done = run("bench", "ur5", "--terms", "rnea", "--batch", "64", "--json")
    (row,) = json.loads(done.stdout)
    assert {"robot", "term", "batch", "threads", "us_per_sample", "pinocchio_us_per_sample", "ratio"} <= set(row)


def test_integrate_says_what_is_unstable_and_what_a_robot_cannot_do():
    planar = Path(__file__).parents[2] / "urdf" / "planar_2r" / "planar_2r.urdf"
    refused = run("integrate", planar)
    assert refused.returncode == 2
    assert "2 joints cannot follow 6 numbers" in refused.stderr and "--task position" in refused.stderr
    asked = {"task": "position", "dt": 1, "gain": 3, "turns": 1, "start": "0.4,1.2", "methods": "abm4,rk4"}
    how = {"feedback": "held", "startup": "rk4", "rtol": 1e-6}
    done = run("integrate", planar, *(word for k, x in {**asked, **how}.items() for word in (f"--{k}", x)))
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("UNSTABLE") == 2
    assert done.stderr.count("note: unstable: K dt = 3 exceeds 1.412, the limit of abm4 with held feedback") == 1
    assert run("integrate", planar, "--unreachable", "perhaps").returncode == 2


def test_dh_and_screws_print_every_digit_or_as_many_as_asked():
    rows = json.loads(run("dh", "panda", "--tip", "panda_link8", "--convention", "modified", "--json").stdout)
    assert "0.316" in json.dumps(rows)
    assert run("screws", "ur5", "--tip", "tool0", "--digits", "6").returncode == 0
    assert "leaves" in run("dh", "panda").stderr


def test_the_numbers_of_q_may_stand_apart():
    words = ["0", "-0.1", "-.2", "1e-3", "0", "0.5"]
    apart, joined = run("fk", "ur5", "--q", *words, "--json"), run("fk", "ur5", "--q", ",".join(words), "--json")
    assert apart.returncode == 0, apart.stderr
    assert apart.stdout == joined.stdout
    for wrong in (["--q", "0", "x"], ["--frme", "tool0"], ["0", "0"], ["--q", *words, "--frme", "tool0"]):
        done = run("fk", "ur5", *wrong)
        assert done.returncode == 2
        assert "--q" in done.stderr
        assert not done.stdout


def test_validation_against_another_file_says_what_differs(tmp_path):
    done = run("validate", "ur5", "--against", "ur10", "--samples", 2, "--engine", "numpy", "--terms", "fk,crba")
    assert done.returncode == 1
    assert "in ur10_robot.urdf" in done.stdout
    assert run("validate", "ur5", "--against", "ur55").returncode == 2
