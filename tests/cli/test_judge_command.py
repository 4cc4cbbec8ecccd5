"""`dualpin judge` and `dualpin ask`: what is printed, and the exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.program import run as dualpin

EXAMPLES = Path(__file__).parents[1] / "crosscheck" / "subject_examples.py"


def test_a_difference_is_named_and_fails(tmp_path):
    done = dualpin("judge", "ur5", f"{EXAMPLES}:Light", "-n", 4, "--out", tmp_path, "--json")
    assert done.returncode == 1, done.stderr
    data = json.loads(done.stdout)
    (robot,) = data["robots"]
    assert robot["subject"] == "light" and robot["terms"]["crba"]["status"] == "agrees"
    assert robot["terms"]["rnea"]["findings"][0]["key"] == "gravity" and data["passed"] is False
    assert {p.name for p in tmp_path.iterdir()} >= {"report.json", "report.md", "junit.xml", "report.sarif"}
    again = dualpin("report", tmp_path / "report.json")
    assert again.returncode == 1 and "differs because: gravity" in again.stdout


def test_what_agrees_passes_and_what_crashes_is_said():
    done = dualpin("judge", "ur5", "pinocchio", f"{EXAMPLES}:Crashes", "-n", 4, "--terms", "crba,gravity")
    assert done.returncode == 1
    assert "not answered: light gravity" in done.stdout and "crashed (SIGABRT)" in done.stdout
    assert dualpin("judge", "ur5", "pinocchio", "-n", 2, "--terms", "crba").returncode == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("judge", "ur5"), "name a subject"), (("judge", "ur5", "pinochio"), "did you mean 'pinocchio'"),
        (("judge", "ur5", "pinocchio", "--terms", "rnae"), "did you mean 'rnea'"),
        (("ask", "ur5", "x", "--language", "fortran"), "languages: c, cpp, python, matlab, julia"),
        (("judge", "no_such_robot", "pinocchio"), "no_such_robot"),
    ],
)  # fmt: skip
def test_bad_words_are_answered_with_the_nearest(words, message, tmp_path):
    done = dualpin(*words, cwd=tmp_path)
    assert done.returncode == 2 and message in done.stderr, done.stdout + done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_program_that_is_there_is_not_overwritten(tmp_path):
    assert dualpin("ask", "ur5", tmp_path, "--language", "python").returncode == 0
    (tmp_path / "answer.py").write_text("mine")
    assert dualpin("ask", "ur5", tmp_path, "--language", "python").returncode == 2
    assert (tmp_path / "answer.py").read_text() == "mine"
