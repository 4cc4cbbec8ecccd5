"""`dualpin selftest`: it runs every command, and tells failures from packages that are missing."""

from __future__ import annotations

import json
import sys

import click
import pytest
import typer

from dualpin.cli import selftest
from dualpin.cli.main import program


def test_every_command_has_its_step():
    group = typer.main.get_command(program())
    assert isinstance(group, click.Group) or hasattr(group, "commands")
    steps = {words[0] for words in (*selftest.STEPS, *selftest.AFTER)}
    assert steps == set(group.commands) - {"selftest"}


def test_outcomes(tmp_path, monkeypatch, capsys):
    """A command that works, one that fails, and one whose package is not there."""
    (tmp_path / "fake").mkdir()
    missing = "import sys\nprint('dualpin: view needs viser: pip install x', file=sys.stderr)\nsys.exit(2)\n"
    (tmp_path / "missing.py").write_text(missing)
    monkeypatch.setattr(selftest, "STEPS", (("cache", "info"), ("fk", "arm.urdf", "--q", "0,1"), ("list", "--missing")))
    monkeypatch.setattr(selftest, "AFTER", (("report", "judged/report.json"),))
    real = selftest.subprocess.Popen

    def popen(command, **options):
        return real([sys.executable, str(tmp_path / "missing.py")] if "--missing" in command else command, **options)

    monkeypatch.setattr(selftest.subprocess, "Popen", popen)
    with pytest.raises(typer.Exit) as ended:
        selftest.selftest(tmp_path / "fake", json=True)
    found = json.loads(capsys.readouterr().out)
    assert [x["outcome"] for x in found["outcomes"]] == ["passed", "FAILED", "skipped", "skipped"]
    assert "6" in found["outcomes"][1]["said"] and "pip install x" in found["outcomes"][2]["said"]
    assert ended.value.exit_code == 1 and found["versions"]["dualpin"]


@pytest.mark.campaign
def test_all_of_it(capsys):
    """In about 20 s on two idle cores."""
    with pytest.raises(typer.Exit) as ended:
        selftest.selftest(None, json=True)
    found = json.loads(capsys.readouterr().out)
    assert ended.value.exit_code == 0 and {x["outcome"] for x in found["outcomes"]} == {"passed"}, found
