"""`dualpin report` as a program, and what a shell completes."""

import json
import os
import subprocess
import sys

import pytest

from dualpin.io.catalogue import catalogue
from tests.program import run
from tests.report import samples


@pytest.fixture
def files(tmp_path):
    def write(name, data):
        (tmp_path / name).write_text(data if isinstance(data, str) else json.dumps(data))

    write("good.json", samples.report(samples.robot("panda"), samples.robot("ur5")).to_json())
    write("bad.json", samples.failed().to_json())
    write("speed.json", samples.speed())
    write("slow.json", samples.speed(2.0))
    return tmp_path


def test_a_failed_robot_says_where():
    one = samples.report(samples.robot("ur5", rnea=1e-3))
    command = [sys.executable, "-m", "dualpin", "report", "/dev/stdin"]
    done = subprocess.run(command, input=one.to_json(), capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 1
    assert "row elbow" in done.stdout


def test_several_files_make_one_page(files):
    pytest.importorskip("jinja2")
    done = run("report", "good.json", "speed.json", "--out", "page", cwd=files)
    assert done.returncode == 0, done.stderr
    assert "wrote page/report.html" in done.stderr
    text = (files / "page" / "report.html").read_text()
    assert "<title>dualpin: validation, speed</title>" in text


@pytest.mark.parametrize(("old", "new", "code", "says"), [
    ("good.json", "good.json", 0, "nothing got worse: 6 figures"),
    ("good.json", "bad.json", 1, "WORSE"),
    ("speed.json", "slow.json", 1, "x Pinocchio's time"),
    ("slow.json", "speed.json", 0, "better"),
])  # fmt: skip
def test_comparing_has_an_exit_code(files, old, new, code, says):
    done = run("report", "--compare", old, new, cwd=files)
    assert done.returncode == code, done.stderr
    assert says in done.stdout


def test_thresholds_decide(files):
    assert run("report", "--compare", "speed.json", "slow.json", "--speed-factor", 3, cwd=files).returncode == 0


def test_json_is_one_document(files):
    found = json.loads(run("report", "--compare", "good.json", "bad.json", "--json", cwd=files).stdout)
    assert found["passed"] is False
    assert json.loads(run("report", "speed.json", "--json", cwd=files).stdout)["rows"]


@pytest.mark.parametrize(("arguments", "message"), [
    (("--compare", "good.json"), "two files expected"),
    (("--compare", "good.json", "speed.json"), "is a validation result"),
    (("none.json",), "cannot read"),
])  # fmt: skip
def test_bad_input_is_one_line(files, arguments, message):
    done = run("report", *arguments, cwd=files)
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_without_jinja_the_rest_is_written_and_said_so(files):
    """A module that refuses to be found stands in for one that is not installed."""
    code = (
        "import sys; from importlib import util; real = util.find_spec\n"
        "util.find_spec = lambda n, *a: None if n == 'jinja2' else real(n, *a)\n"
        "sys.argv = ['dualpin', 'report', 'good.json', '--out', 'out']\n"
        "from dualpin.cli import main; main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=files, check=False)
    assert done.returncode == 0, done.stderr
    assert sorted(p.name for p in (files / "out").iterdir()) == ["report.json", "report.md"]
    assert "pip install 'dualpin[report]'" in done.stderr


def test_a_shell_completes_robots():
    if "ur5_robot" not in catalogue():
        pytest.skip("example-robot-data is not installed")
    asked = {"_DUALPIN_COMPLETE": "complete_bash", "COMP_WORDS": "dualpin info ur5", "COMP_CWORD": "2"}
    code = "from dualpin.cli import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env={**os.environ, **asked}, check=False
    )
    assert "ur5_robot" in done.stdout.split()
