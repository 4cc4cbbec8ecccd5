"""Environments of subjects: read without running anything, whole or absent."""

from __future__ import annotations

import json
import sys

import pytest

import dualpin as dp
from dualpin.crosscheck.subjects import QUESTIONS, environments


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.setenv("DUALPIN_SUBJECTS_DIR", str(tmp_path / "subjects"))


def adapter(tmp_path, text):
    path = tmp_path / "mine.py"
    path.write_text(text, encoding="utf-8")
    return path


def test_every_shipped_adapter_names_versions():
    for name in environments.shipped():
        requires = environments.environment(name).requires
        assert requires and "==" in requires[0], name


def test_an_adapter_is_read_not_run(tmp_path):
    path = adapter(tmp_path, "REQUIRES = ('some-library==1.2',)\nraise SystemExit('run')\n")
    assert environments.environment(path).requires == ("some-library==1.2",)


@pytest.mark.parametrize("text", ["REQUIRES = ['a']", "REQUIRES = (1,)", "REQUIRES = tuple(x for x in 'ab')", "def ("])
def test_requirements_that_are_no_texts_are_refused(tmp_path, text):
    with pytest.raises(dp.DualpinError, match=r"REQUIRES|not Python"):
        environments.environment(adapter(tmp_path, text))


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(dp.DualpinError, match="mujoco"):
        environments.environment("mujco")


def test_a_subject_of_another_version_has_an_environment_of_its_own(tmp_path):
    today, old = environments.environment("mujoco"), environments.environment("mujoco==3.12.0")
    assert old.requires == ("mujoco==3.12.0", *today.requires[1:]) and old.folder.name == "mujoco-3.12.0"
    assert old.adapter == today.adapter and old.folder != today.folder
    with pytest.raises(dp.DualpinError, match=r"subjects install mujoco==3\.12\.0"):
        dp.judge("ur5", "mujoco==3.12.0:clean", 2)
    with pytest.raises(dp.DualpinError, match="no REQUIRES"):
        environments.environment(f"{adapter(tmp_path, '')}==1.0")


def test_half_an_environment_is_none(tmp_path):
    path = adapter(tmp_path, "REQUIRES = ('some-library==1.2',)\n")
    found = environments.environment(path)
    found.python.parent.mkdir(parents=True)
    found.python.write_text("")
    assert not found.ready and environments.interpreter(path) is None
    (found.folder / "ready.json").write_text(json.dumps({"requires": ["some-library==1.1"]}))
    assert not found.ready, "it was made for another version"
    (found.folder / "ready.json").write_text(json.dumps({"requires": ["some-library==1.2"]}))
    assert found.ready and environments.interpreter(path) == str(found.python)
    assert environments.remove(path) and not environments.remove(path)


def test_what_pip_cannot_install_leaves_nothing(tmp_path):
    path = adapter(tmp_path, f"REQUIRES = ({str(tmp_path / 'nothing-here')!r},)\n")
    with pytest.raises(dp.DualpinError, match="pip cannot install"):
        environments.install(path)
    assert not environments.environment(path).folder.exists()


def test_a_library_that_is_not_there_is_a_result_that_says_how_to_get_it():
    report = dp.judge("ur5", "drake", samples=2, python=sys.executable)
    assert report.robots[0].reason.startswith("refused") and "subjects install drake" in report.robots[0].reason
    assert all(t.status == "not compared" for t in report.terms.values())


def test_terms_of_an_adapter_are_found_without_running_it(tmp_path):
    path = tmp_path / "odd.py"
    path.write_text(
        "import nothing_like_it\n\nclass Subject:\n    def __init__(self):\n        self.rnea, self.x = 1, 2\n"
        "        self.coriolis(0)\n    def crba(self, q): ...\n\nmore = {'fk': None}\n"
    )
    assert environments.terms(path, tuple(QUESTIONS)) == ["fk", "crba", "rnea"]
